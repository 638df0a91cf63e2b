// SPDX-License-Identifier: MIT
// What a step keeps of a contact that touches, as numbers in a row.
#pragma once

#include <silt/core/types.hpp>

namespace silt::dem {

/// What is kept of a contact that touches, besides what the law remembers: n, δ, F on its first
/// grain, by how much its lever arms are shorter than R, and the couple on its first grain if the
/// law gives one.
template <bool has_couple>
struct ContactRow {
  static constexpr int n = 0;
  static constexpr int overlap = 3;
  static constexpr int F = 4;
  static constexpr int shorter = 7;
  static constexpr int couple = 8;
  static constexpr int words = has_couple ? 12 : 8;

  /// F of a row [N].
  template <int Dim, class Real>
  static Vec<Dim, Real> force_in(const Real* row) {
    Vec<Dim, Real> force;
    for (int k = 0; k < Dim; ++k) force[k] = row[F + k];
    return force;
  }
  /// The couple of a row [N m]; 0 if none is kept.
  template <int Dim, class Real>
  static AngularVec<Dim, Real> couple_in([[maybe_unused]] const Real* row) {
    auto all = zero_of<AngularVec<Dim, Real>>();
    if constexpr (has_couple) {
      for (int k = 0; k < angular_size<Dim>; ++k) component(all, k) = row[couple + k];
    }
    return all;
  }
};

}  // namespace silt::dem
