// SPDX-License-Identifier: MIT
// Algebraic multigrid of the hypre library (BoomerAMG) as preconditioner of a system that processes
// share.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mpi/world.hpp>

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>

#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace silt::mpi {

/// One V-cycle for the system, whose SharedUnknowns are those of particles of mpi::distribute().
class BoomerAmg {
 public:
  BoomerAmg() = default;
  // Copies need their own prepare().
  BoomerAmg(const BoomerAmg&) {}
  BoomerAmg& operator=(const BoomerAmg&) {
    release();
    return *this;
  }
  ~BoomerAmg() { release(); }

  /// Throws in all processes if one has failed.
  void prepare(const LinearSystem& system) {
    release();
    const World& world = *static_cast<const World*>(system.shared->processes());
    const Index n = system.size();
    number(system, world);
    entries_.assign(n, 1);
    columns_.clear();
    values_.clear();
    for (Index i = 0; i < n; ++i) {
      columns_.push_back(rows_[i]);
      values_.push_back(system.diagonal[i]);
      system.off_diagonal.for_each_entry(i, [&](Index column, double value) {
        columns_.push_back(number_of(column));
        values_.push_back(value);
        ++entries_[i];
      });
    }
    zeros_.assign(n, 0);
    system.sum_of_all(0);  // all have come so far
    const HYPRE_BigInt first = first_, last = first_ + HYPRE_BigInt(n) - 1;
    HYPRE_IJMatrixCreate(world.communicator(), first, last, first, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(matrix_);
    HYPRE_IJMatrixSetValues(matrix_, HYPRE_Int(n), entries_.data(), rows_.data(), columns_.data(),
                            values_.data());
    HYPRE_IJMatrixAssemble(matrix_);
    for (HYPRE_IJVector* vector : {&r_, &z_}) {
      HYPRE_IJVectorCreate(world.communicator(), first, last, vector);
      HYPRE_IJVectorSetObjectType(*vector, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*vector);
      HYPRE_IJVectorSetValues(*vector, HYPRE_Int(n), rows_.data(), zeros_.data());
      HYPRE_IJVectorAssemble(*vector);
    }
    HYPRE_BoomerAMGCreate(&multigrid_);
    HYPRE_BoomerAMGSetStrongThreshold(multigrid_, strong_threshold);
    HYPRE_BoomerAMGSetRelaxType(multigrid_, 6);  // symmetric Gauss–Seidel
    HYPRE_BoomerAMGSetTol(multigrid_, 0);
    HYPRE_BoomerAMGSetMaxIter(multigrid_, 1);
    HYPRE_BoomerAMGSetup(multigrid_, parcsr(matrix_), parcsr(r_), parcsr(z_));
  }

  void apply(const std::vector<double>& r, std::vector<double>& z) {
    const auto n = HYPRE_Int(r.size());
    HYPRE_IJVectorSetValues(r_, n, rows_.data(), r.data());
    HYPRE_IJVectorSetValues(z_, n, rows_.data(), zeros_.data());
    HYPRE_BoomerAMGSolve(multigrid_, parcsr(matrix_), parcsr(r_), parcsr(z_));
    HYPRE_ClearAllErrors();  // that one iteration does not converge
    HYPRE_IJVectorGetValues(z_, n, rows_.data(), z.data());
  }

 private:
  static constexpr double strong_threshold = 0.25;

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

  // The unknowns of all processes, one process after the other.
  void number(const LinearSystem& system, const World& world) {
    const double all = system.sum_of_all(double(system.size()));
    if (all > double(std::numeric_limits<HYPRE_BigInt>::max())) {
      fail("mpi: " + to_text(all) + " unknown pressures are more than this hypre can number; build "
           "hypre with 64-bit integers");
    }
    double own = double(system.size()), before = 0;
    detail::check(MPI_Exscan(&own, &before, 1, MPI_DOUBLE, MPI_SUM, world.communicator()),
                  "MPI_Exscan");
    first_ = world.is_first() ? 0 : HYPRE_BigInt(before);
    numbers_.assign(system.columns(), 0);
    rows_.resize(system.size());
    for (Index i = 0; i < system.size(); ++i) {
      rows_[i] = first_ + HYPRE_BigInt(i);
      numbers_[i] = double(rows_[i]);
    }
    system.refresh(numbers_);
  }
  HYPRE_BigInt number_of(Index column) const { return HYPRE_BigInt(numbers_[column]); }

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

  HYPRE_Solver multigrid_ = nullptr;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector r_ = nullptr;
  HYPRE_IJVector z_ = nullptr;
  HYPRE_BigInt first_ = 0;
  std::vector<double> numbers_;  // of the columns
  std::vector<HYPRE_BigInt> rows_, columns_;
  std::vector<HYPRE_Int> entries_;
  std::vector<double> values_, zeros_;
};

}  // namespace silt::mpi
