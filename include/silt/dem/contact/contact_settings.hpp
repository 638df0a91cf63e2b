// SPDX-License-Identifier: MIT
// Settings of contacts other than their law.
#pragma once

#include <silt/core/error.hpp>

namespace silt::dem {

/// Lever arm of the contact force.
enum class LeverArm {
  contact_point,  ///< to the middle of the overlap: conserves angular momentum to round-off
  radius,         ///< R, as in [SahChoi2004] (14); too long by δ/2
};

struct ContactSettings {
  LeverArm lever_arm = LeverArm::contact_point;
  double steps_per_contact = 50;  ///< contact duration over the default time step [-]
  bool check_stability = true;    ///< throw if Δt exceeds the stability limit of the contacts

  /// Throws if a setting is out of range.
  void check() const { require_positive("ContactSettings: steps_per_contact", steps_per_contact); }
};

}  // namespace silt::dem
