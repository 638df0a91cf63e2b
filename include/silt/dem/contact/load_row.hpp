// SPDX-License-Identifier: MIT
// What a contact adds to the forces and torques of its two grains.
#pragma once

namespace silt::dem::detail {

/// The row of a contact: F on the first grain, R minus the lever arm, F × n, and the couple on the
/// first grain if the law has one. The torque on a grain is (R − arm_reduction) F × n, for both the
/// same.
template <int Dim, bool has_couple>
struct LoadRow {
  static constexpr int F = 0;
  static constexpr int arm_reduction = 3;
  static constexpr int F_x_n = Dim == 2 ? 2 : 4;
  static constexpr int couple = Dim == 2 ? 4 : 8;
  static constexpr int words = (Dim == 2 ? 4 : 8) + (has_couple ? 4 : 0);
};

}  // namespace silt::dem::detail
