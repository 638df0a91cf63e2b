// SPDX-License-Identifier: MIT
// What can be chosen about contacts beside their law.
#pragma once

#include <silt/core/error.hpp>

namespace silt::dem {

/// Where the contact force takes hold.
enum class LeverArm {
  contact_point,  ///< in the middle of the overlap: keeps angular momentum to round-off
  radius,         ///< at R, as [SahChoi2004] (14) has it: off by δ/2
};

struct ContactSettings {
  LeverArm lever_arm = LeverArm::contact_point;
  double steps_per_contact = 50;  ///< of the default time step [-]
  bool check_stability = true;    ///< throw when Δt is beyond what the existing contacts allow

  /// Throws if a setting is out of range.
  void check() const {
    require_positive("ContactSettings: steps_per_contact", steps_per_contact);
  }
};

}  // namespace silt::dem
