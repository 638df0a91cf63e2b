// SPDX-License-Identifier: MIT
// The ways through contact that a law is tried on.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/prescribed_contact.hpp>

#include <cmath>
#include <numbers>

namespace silt::dem {

/// 0 outside of (from, to), 1 in between but for smooth ramps of that length.
struct Plateau {
  double from;
  double to;
  double ramp;
};
inline double plateau(double u, const Plateau& p) {
  const auto smooth = [](double x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x); };
  return smooth((u - p.from) / p.ramp) * smooth((p.to - u) / p.ramp);
}

/// Sizes of a way through contact; the contact is pressed, led about, and released.
struct ContactPath {
  double depth = 0;  ///< of the overlap [m]
  double dip = 0;    ///< share of the depth by which it comes and goes while led about [-]
  double slip = 0;   ///< along the plane, to and fro [m]
  double turn = 0;   ///< of rolling and twisting, to and fro [rad]
  double phase = 0;  ///< of the slip against the dip [rad]
  double pace = 1;   ///< cycles of slip and turn to one of the dip [-]
  bool round = false;  ///< 3D: the slip goes round in the plane, not to and fro
  bool aside = false;  ///< it is released where it was led to, not where it began
};

template <int Dim>
ContactPose<Dim> pose_on(const ContactPath& way, double u) {
  constexpr double cycles = 3;
  const double angle = 2 * std::numbers::pi * cycles * (u - 0.2) / 0.6;
  const double led = plateau(u, {.from = 0.15, .to = way.aside ? 2 : 0.85, .ramp = 0.1});
  ContactPose<Dim> pose;
  pose.overlap = way.depth * plateau(u, {.from = 0, .to = 1, .ramp = 0.15}) *
                 (1 - way.dip * led * (1 - std::cos(angle)) / 2);
  const double led_by = way.pace * angle + way.phase;
  const double swing = std::sin(led_by) * led;
  pose.slip[1] = way.slip * swing;
  if constexpr (Dim == 2) {
    pose.turn = way.turn * swing;
  } else {
    pose.slip[2] = way.slip * (way.round ? std::cos(led_by) * led : 0.3 * swing);
    pose.turn = way.turn * Vec<3>(0.5 * swing, swing, 0.4 * std::cos(led_by) * led);
  }
  return pose;
}

}  // namespace silt::dem
