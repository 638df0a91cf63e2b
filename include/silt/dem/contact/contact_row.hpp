// SPDX-License-Identifier: MIT
// The data that a step stores for each contact, as an array of numbers.
#pragma once

#include <silt/core/types.hpp>

namespace silt::dem::detail {

/// The input and the results of the law for a contact except its velocities and its history: n, δ,
/// F on the first grain, R minus the lever arm, effective mass and radius, and the couple on the
/// first grain if the law has one.
template <bool couples>
struct ContactRow {
  static constexpr bool has_couple = couples;
  static constexpr int n = 0;
  static constexpr int overlap = 3;
  static constexpr int F = 4;
  static constexpr int arm_reduction = 7;
  static constexpr int mass = 8;
  static constexpr int radius = 9;
  static constexpr int couple = 10;
  static constexpr int words = couples ? 16 : 12;

  /// F of a row [N].
  template <int Dim, class Real>
  static Vec<Dim, Real> force_in(const Real* row) {
    Vec<Dim, Real> force;
    for (int k = 0; k < Dim; ++k) force[k] = row[F + k];
    return force;
  }
  /// The couple of a row [N m]; 0 if the law has none.
  template <int Dim, class Real>
  static AngularVec<Dim, Real> couple_in([[maybe_unused]] const Real* row) {
    auto all = zero_of<AngularVec<Dim, Real>>();
    if constexpr (couples) {
      for (int k = 0; k < angular_size<Dim>; ++k) component(all, k) = row[couple + k];
    }
    return all;
  }
};

}  // namespace silt::dem::detail
