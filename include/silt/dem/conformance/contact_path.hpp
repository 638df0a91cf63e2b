// SPDX-License-Identifier: MIT
// Prescribed paths of a contact for the checks of a law.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/conformance/prescribed_contact.hpp>

#include <cmath>
#include <numbers>

namespace silt::dem {

/// 1 between `from` and `to`, 0 outside, with smooth ramps of length `ramp` at both ends.
struct Plateau {
  double from;
  double to;
  double ramp;
};
inline double plateau(double u, const Plateau& p) {
  const auto smooth = [](double x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x); };
  return smooth((u - p.from) / p.ramp) * smooth((p.to - u) / p.ramp);
}

/// Amplitudes of a path: a contact is loaded, unloaded partially, sheared and rotated in cycles,
/// and unloaded.
struct ContactPath {
  double depth = 0;              ///< maximum overlap [m]
  double unloading = 0;          ///< fraction of the depth that is unloaded in each cycle [-]
  double slip = 0;               ///< amplitude of the cyclic slip [m]
  double rotation = 0;           ///< amplitude of the cyclic rolling and twisting [rad]
  double phase = 0;              ///< of the slip relative to the unloading [rad]
  double pace = 1;               ///< cycles of slip and rotation per cycle of unloading [-]
  bool circular = false;         ///< 3D: the slip moves on a circle instead of back and forth
  bool shifted_release = false;  ///< the contact ends with a slip, not at its initial position
};

template <int Dim>
ContactPose<Dim> pose_on(const ContactPath& path, double u) {
  constexpr double cycles = 3;
  const double angle = 2 * std::numbers::pi * cycles * (u - 0.2) / 0.6;
  const double envelope =
      plateau(u, {.from = 0.15, .to = path.shifted_release ? 2 : 0.85, .ramp = 0.1});
  ContactPose<Dim> pose;
  pose.overlap = path.depth * plateau(u, {.from = 0, .to = 1, .ramp = 0.15}) *
                 (1 - path.unloading * envelope * (1 - std::cos(angle)) / 2);
  const double slip_angle = path.pace * angle + path.phase;
  const double swing = std::sin(slip_angle) * envelope;
  pose.slip[1] = path.slip * swing;
  if constexpr (Dim == 2) {
    pose.rotation = path.rotation * swing;
  } else {
    pose.slip[2] = path.slip * (path.circular ? std::cos(slip_angle) * envelope : 0.3 * swing);
    pose.rotation =
        path.rotation * Vec<3>(0.5 * swing, swing, 0.4 * std::cos(slip_angle) * envelope);
  }
  return pose;
}

}  // namespace silt::dem
