// SPDX-License-Identifier: MIT
// Algebraic multigrid of the hypre library (BoomerAMG): one V-cycle for a matrix of any number of
// processes. Included only by headers that need hypre and MPI.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace silt::detail {

/// The rows of one process, which follow those of the processes before it.
struct HypreMatrix {
  HYPRE_BigInt first_row = 0;
  std::vector<HYPRE_Int> entries;  ///< number in each row
  std::vector<HYPRE_BigInt> columns;
  std::vector<double> values;

  void clear() {
    entries.clear();
    columns.clear();
    values.clear();
  }
  /// Begins a row.
  void add_row() { entries.push_back(0); }
  /// To the last row.
  void add(HYPRE_BigInt column, double value) {
    columns.push_back(column);
    values.push_back(value);
    ++entries.back();
  }
};

struct HypreCoarsening {
  double strong_threshold = 0.25;  // in [0, 1]
  int aggressive_levels = 0;       // from the finest: few unknowns are left, and iterations are more
};

class HypreMultigrid {
 public:
  HypreMultigrid() = default;
  // Copies are empty.
  HypreMultigrid(const HypreMultigrid&) {}
  HypreMultigrid& operator=(const HypreMultigrid&) {
    release();
    return *this;
  }
  ~HypreMultigrid() { release(); }

  /// Memory for the rows of this process.
  void set_rows(const HypreMatrix& matrix) {
    rows_.resize(matrix.entries.size());
    std::iota(rows_.begin(), rows_.end(), matrix.first_row);
    zeros_.assign(rows_.size(), 0);
  }
  /// To be called by all processes, after set_rows(). Throws in all if hypre fails.
  void prepare(MPI_Comm processes, HypreMatrix& matrix, const HypreCoarsening& coarsening) {
    release();
    const auto n = HYPRE_Int(matrix.entries.size());
    const HYPRE_BigInt first = matrix.first_row, last = first + HYPRE_BigInt(n) - 1;
    HYPRE_IJMatrixCreate(processes, first, last, first, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(matrix_);
    HYPRE_IJMatrixSetValues(matrix_, n, matrix.entries.data(), rows_.data(), matrix.columns.data(),
                            matrix.values.data());
    HYPRE_IJMatrixAssemble(matrix_);
    for (HYPRE_IJVector* vector : {&b_, &x_}) {
      HYPRE_IJVectorCreate(processes, first, last, vector);
      HYPRE_IJVectorSetObjectType(*vector, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*vector);
      HYPRE_IJVectorSetValues(*vector, n, rows_.data(), zeros_.data());
      HYPRE_IJVectorAssemble(*vector);
    }
    HYPRE_BoomerAMGCreate(&multigrid_);
    HYPRE_BoomerAMGSetStrongThreshold(multigrid_, coarsening.strong_threshold);
    HYPRE_BoomerAMGSetAggNumLevels(multigrid_, coarsening.aggressive_levels);
    HYPRE_BoomerAMGSetRelaxType(multigrid_, 6);  // symmetric Gauss–Seidel
    HYPRE_BoomerAMGSetTol(multigrid_, 0);
    HYPRE_BoomerAMGSetMaxIter(multigrid_, 1);
    HYPRE_BoomerAMGSetup(multigrid_, parcsr(matrix_), parcsr(b_), parcsr(x_));
    const HYPRE_Int code = HYPRE_GetError();
    if (code == 0) return;
    HYPRE_ClearAllErrors();
    fail({"hypre: BoomerAMG failed with the error flags ", code,
          "; use another solver, or fewer unknowns"});
  }

  /// x = V b, for the rows of this process. Does not throw.
  void cycle(const std::vector<double>& b, std::vector<double>& x) {
    const auto n = HYPRE_Int(rows_.size());
    HYPRE_IJVectorSetValues(b_, n, rows_.data(), b.data());
    HYPRE_IJVectorSetValues(x_, n, rows_.data(), zeros_.data());
    HYPRE_BoomerAMGSolve(multigrid_, parcsr(matrix_), parcsr(b_), parcsr(x_));
    HYPRE_ClearAllErrors();  // that one cycle does not converge
    HYPRE_IJVectorGetValues(x_, n, rows_.data(), x.data());
  }

 private:
  static HYPRE_ParCSRMatrix parcsr(HYPRE_IJMatrix matrix) {
    void* object = nullptr;
    HYPRE_IJMatrixGetObject(matrix, &object);
    return static_cast<HYPRE_ParCSRMatrix>(object);
  }
  static HYPRE_ParVector parcsr(HYPRE_IJVector vector) {
    void* object = nullptr;
    HYPRE_IJVectorGetObject(vector, &object);
    return static_cast<HYPRE_ParVector>(object);
  }
  void release() {
    if (multigrid_) HYPRE_BoomerAMGDestroy(multigrid_);
    if (matrix_) HYPRE_IJMatrixDestroy(matrix_);
    for (HYPRE_IJVector vector : {b_, x_}) {
      if (vector) HYPRE_IJVectorDestroy(vector);
    }
    multigrid_ = nullptr;
    matrix_ = nullptr;
    b_ = x_ = nullptr;
  }

  HYPRE_Solver multigrid_ = nullptr;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector b_ = nullptr;
  HYPRE_IJVector x_ = nullptr;
  std::vector<HYPRE_BigInt> rows_;
  std::vector<double> zeros_;
};

}  // namespace silt::detail
