// SPDX-License-Identifier: MIT
// Eigen's incomplete Cholesky factorisation as preconditioner: A ≈ L Lᵀ with no more entries than A
// (Lin and Moré 1999). Fewer iterations than with the diagonal; they also grow with the number of
// unknowns.
#pragma once

#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/jacobi.hpp>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace silt {

/// The full matrix of a system as an Eigen sparse matrix.
inline Eigen::SparseMatrix<double, Eigen::RowMajor> eigen_matrix(const LinearSystem& system) {
  const auto n = static_cast<Eigen::Index>(system.size());
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  std::vector<std::pair<Eigen::Index, double>> entries;
  for (Index i = 0; i < system.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    entries.assign(1, {row, system.diagonal[i]});
    system.off_diagonal.for_each_entry(i, [&](Index column, double value) {
      entries.emplace_back(static_cast<Eigen::Index>(column), value);
    });
    std::sort(entries.begin(), entries.end());
    A.startVec(row);
    for (const auto& [column, value] : entries) A.insertBack(row, column) = value;
  }
  A.finalize();
  return A;
}

/// A Preconditioner for ConjugateGradient: A ≈ L Lᵀ (Lin and Moré 1999).
class IncompleteCholesky {
 public:
  void prepare(const LinearSystem& system) {
    auto A = eigen_matrix(system);
    // The matrix of a closed body is singular: for the factorisation, the diagonal of one of its
    // unknowns is doubled. The caller removes the constants from the result.
    std::vector<bool> pinned(system.closed_bodies + 1, false);
    for (Index i = 0; i < system.closed_body.size(); ++i) {
      const Index body = system.closed_body[i];
      if (body == 0 || pinned[body]) continue;
      A.coeffRef(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) *= 2;
      pinned[body] = true;
    }
    factors_ = std::make_shared<const Factors>(A);  // copyable, unlike Eigen's factorisation
    diagonal_.prepare(system);
  }

  /// Uses the diagonal if the factorisation failed because A is not positive definite.
  void apply(std::span<const double> r, std::span<double> z) const {
    if (factors_->info() != Eigen::Success) {
      diagonal_.apply(r, z);
      return;
    }
    const auto n = static_cast<Eigen::Index>(r.size());
    Eigen::Map<Eigen::VectorXd>(z.data(), n) =
        factors_->solve(Eigen::Map<const Eigen::VectorXd>(r.data(), n));
  }

 private:
  // In the order of the particles: there is no fill-in to be reduced by another order, which would
  // only lose accuracy.
  using Factors = Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>>;
  std::shared_ptr<const Factors> factors_;
  Jacobi diagonal_;
};

}  // namespace silt
