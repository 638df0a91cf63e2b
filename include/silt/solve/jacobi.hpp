// SPDX-License-Identifier: MIT
// The diagonal as preconditioner.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>

#include <concepts>
#include <span>
#include <vector>

namespace silt {

/// prepare(system) is called once per solve, apply(r, z) computes z ≈ A⁻¹ r. If there is
/// apply_and_multiply(r, z), it does the same and returns r·z. One for unknowns that processes
/// share, see LinearSystem::shared, has `static constexpr bool shares_unknowns = true`. Model:
/// Jacobi.
template <class M>
concept Preconditioner = requires(M m, const LinearSystem& system, const std::vector<double>& r,
                                  std::vector<double>& z) {
  m.prepare(system);
  m.apply(r, z);
};

/// z = D⁻¹ r.
class Jacobi {
 public:
  static constexpr bool shares_unknowns = true;

  void prepare(const LinearSystem& system) {
    inverse_.resize(system.size());
    for_each(system.size(), [&](Index i) { inverse_[i] = 1 / system.diagonal[i]; });
  }
  void apply(std::span<const double> r, std::span<double> z) const {
    for_each(r.size(), [&](Index i) { z[i] = inverse_[i] * r[i]; });
  }

 private:
  std::vector<double> inverse_;
};

}  // namespace silt
