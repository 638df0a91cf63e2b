// SPDX-License-Identifier: MIT
// Algebraic multigrid of the hypre library (BoomerAMG) as preconditioner, for comparison with
// CellMultigrid. No other header of Silt includes this one; a program that does needs hypre and
// MPI, and must call MPI_Init before the first solve. One process, with the threads of the hypre
// build.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/hypre_multigrid.hpp>
#include <silt/solve/jacobi.hpp>

#include <vector>

namespace silt {

/// A Preconditioner for comparisons.
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

  void prepare(const LinearSystem& system) {
    matrix_.clear();
    for (Index i = 0; i < system.size(); ++i) {
      matrix_.add_row();
      matrix_.add(HYPRE_BigInt(i), system.diagonal[i]);
      system.off_diagonal.for_each_entry(
          i, [&](Index column, double value) { matrix_.add(HYPRE_BigInt(column), value); });
    }
    multigrid_.set_rows(matrix_);
    multigrid_.prepare(MPI_COMM_SELF, matrix_, {.strong_threshold = settings_.strong_threshold});
  }

  void apply(const std::vector<double>& r, std::vector<double>& z) {
    z.resize(r.size());
    multigrid_.cycle(r, z);
  }

 private:
  Settings settings_;
  detail::HypreMatrix matrix_;
  detail::HypreMultigrid multigrid_;  // a copy needs its own prepare()
};

}  // namespace silt
