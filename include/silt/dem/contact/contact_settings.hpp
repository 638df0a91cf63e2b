// SPDX-License-Identifier: MIT
// Settings of contacts other than their law.
#pragma once

#include <silt/core/error.hpp>

#include <cmath>
#include <string_view>

namespace silt::dem {

/// Lever arm of the contact force.
enum class LeverArm {
  contact_point,  ///< to the middle of the overlap: conserves angular momentum to round-off
  radius,         ///< R, as in [SahChoi2004] (14); too long by δ/2
};

/// Independent of these settings, a step throws if a moving wall vibrates with fewer than ten steps
/// per period, or if a position is so large that its digits resolve less than 1 % of a radius.
struct ContactSettings {
  LeverArm lever_arm = LeverArm::contact_point;
  double steps_per_contact = 50;  ///< contact duration over the default time step [-]
  bool check_stability = true;    ///< throw if Δt exceeds the stability limit of the contacts
  /// A step throws if an overlap exceeds this share of the radius, of the smaller one of two grains
  /// [-]. With 1 and more, the centre of a grain may pass through a thin wall. Infinity: no limit.
  double max_overlap = 0.5;
  /// A step throws if a grain moves, or a moving wall, by more than this share of the radius, which
  /// may take it through a grain or a thin wall without a contact [-]. Infinity: no limit.
  double max_displacement = 0.5;
  /// A step throws if the kinetic energy exceeds this times the sum of that before the step, the
  /// energy in the springs of the contacts and the work of moving walls and of all other forces
  /// [-]. The energy is that of all grains together. Only for laws that tell it by components, see
  /// ContactLaw. Infinity: no limit.
  double max_energy_gain = 10;

  /// Throws if a setting is out of range.
  void check() const {
    require_positive("ContactSettings: steps_per_contact", steps_per_contact);
    check_limit("ContactSettings: max_overlap", max_overlap);
    check_limit("ContactSettings: max_displacement", max_displacement);
    if (!(max_energy_gain > 1)) {  // also NaN
      fail({"ContactSettings: max_energy_gain = ", max_energy_gain,
            " must be above 1; give a ratio of energies, or infinity"});
    }
  }

 private:
  static void check_limit(std::string_view name, double limit) {
    if (limit > 0) return;  // false for NaN
    fail({name, " = ", limit, " must be positive; give a share of the radius, or infinity"});
  }
};

}  // namespace silt::dem
