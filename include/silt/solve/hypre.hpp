// SPDX-License-Identifier: MIT
// Algebraic multigrid of the hypre library (BoomerAMG) as preconditioner, for comparison with
// CellMultigrid. No other header of Silt includes this one; a program that does needs hypre and
// MPI, and must call MPI_Init before the first solve. One process, with the threads of the hypre
// build.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/jacobi.hpp>

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>

#include <numeric>
#include <vector>

namespace silt {

class BoomerAmg {
 public:
  struct Settings {
    double strong_threshold = 0.25;  ///< of strong couplings, over the largest entry of a row [-]
  };

  BoomerAmg() = default;
  /// Throws if the setting is out of range.
  explicit BoomerAmg(const Settings& settings) : settings_(settings) {
    require_between("BoomerAmg: strong_threshold", settings.strong_threshold, {0, 1});
  }
  // Copies only the settings; the copy needs its own prepare().
  BoomerAmg(const BoomerAmg& other) : settings_(other.settings_) {}
  BoomerAmg& operator=(const BoomerAmg& other) {
    release();
    settings_ = other.settings_;
    return *this;
  }
  ~BoomerAmg() { release(); }

  void prepare(const LinearSystem& system) {
    release();
    const auto n = static_cast<HYPRE_Int>(system.size());
    rows_.resize(system.size());
    std::iota(rows_.begin(), rows_.end(), 0);
    HYPRE_IJMatrixCreate(MPI_COMM_SELF, 0, n - 1, 0, n - 1, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(matrix_);
    for (Index i = 0; i < system.size(); ++i) fill_row(system, i);
    HYPRE_IJMatrixAssemble(matrix_);
    for (HYPRE_IJVector* vector : {&r_, &z_}) {
      HYPRE_IJVectorCreate(MPI_COMM_SELF, 0, n - 1, vector);
      HYPRE_IJVectorSetObjectType(*vector, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*vector);
    }
    HYPRE_BoomerAMGCreate(&multigrid_);
    HYPRE_BoomerAMGSetStrongThreshold(multigrid_, settings_.strong_threshold);
    HYPRE_BoomerAMGSetRelaxType(multigrid_, 6);  // symmetric Gauss–Seidel
    HYPRE_BoomerAMGSetTol(multigrid_, 0);
    HYPRE_BoomerAMGSetMaxIter(multigrid_, 1);
    HYPRE_BoomerAMGSetup(multigrid_, parcsr(matrix_), parcsr(r_), parcsr(z_));
  }

  void apply(const std::vector<double>& r, std::vector<double>& z) {
    const auto n = static_cast<HYPRE_Int>(r.size());
    z.assign(r.size(), 0);
    HYPRE_IJVectorSetValues(r_, n, rows_.data(), r.data());
    HYPRE_IJVectorSetValues(z_, n, rows_.data(), z.data());
    HYPRE_BoomerAMGSolve(multigrid_, parcsr(matrix_), parcsr(r_), parcsr(z_));
    HYPRE_IJVectorGetValues(z_, n, rows_.data(), z.data());
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

  void fill_row(const LinearSystem& system, Index i) {
    columns_.assign(1, static_cast<HYPRE_BigInt>(i));
    values_.assign(1, system.diagonal[i]);
    system.off_diagonal.for_each_entry(i, [&](Index column, double value) {
      columns_.push_back(static_cast<HYPRE_BigInt>(column));
      values_.push_back(value);
    });
    auto entries = static_cast<HYPRE_Int>(columns_.size());
    HYPRE_IJMatrixSetValues(matrix_, 1, &entries, &rows_[i], columns_.data(), values_.data());
  }

  void release() {
    if (multigrid_) HYPRE_BoomerAMGDestroy(multigrid_);
    if (matrix_) HYPRE_IJMatrixDestroy(matrix_);
    for (HYPRE_IJVector vector : {r_, z_}) {
      if (vector) HYPRE_IJVectorDestroy(vector);
    }
    multigrid_ = nullptr;
    matrix_ = nullptr;
    r_ = z_ = nullptr;
  }

  Settings settings_;
  HYPRE_Solver multigrid_ = nullptr;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector r_ = nullptr;
  HYPRE_IJVector z_ = nullptr;
  std::vector<HYPRE_BigInt> rows_;
  std::vector<HYPRE_BigInt> columns_;
  std::vector<double> values_;
};

}  // namespace silt
