// SPDX-License-Identifier: MIT
// Two motions of rigid bodies at once, such as those of a screw, or of a drum on a vibrating table.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/rigid_motion.hpp>

#include <algorithm>
#include <limits>

namespace silt {

/// A motion in a frame that moves: CombinedMotion{Rotation<3>{…}, Translation<3>{…}} turns about an
/// axis that travels, as a screw does. Both are RigidMotions of the same dimension and precision;
/// `first` is that in the frame, `second` that of the frame. Of more than two, combine a combined
/// one.
template <class First, class Second>
struct CombinedMotion {
  First first;
  Second second;

  /// Throws if a parameter of one of them is out of range.
  void check() const {
    if constexpr (requires { first.check(); }) first.check();
    if constexpr (requires { second.check(); }) second.check();
  }
  /// See RigidMotion.
  auto pose_at(double t) const { return second.pose_at(t).after(first.pose_at(t)); }
  /// See RigidMotion.
  auto velocity_at(double t) const {
    const auto frame = second.pose_at(t);
    const auto of_frame = second.velocity_at(t);
    auto v = first.velocity_at(t);
    v.about = frame.x_of(v.about);
    v.linear = multiply(frame.rotation, v.linear) + of_frame.at(v.about);
    if constexpr (requires { v.spin[0]; }) {
      v.spin = multiply(frame.rotation, v.spin) + of_frame.spin;
    } else {
      v.spin += of_frame.spin;
    }
    return v;
  }
  /// The shorter one [s]; infinite if neither vibrates.
  double period() const {
    double shorter = std::numeric_limits<double>::infinity();
    if constexpr (requires { first.period(); }) shorter = first.period();
    if constexpr (requires { second.period(); }) shorter = std::min(shorter, second.period());
    return shorter;
  }
};
template <class First, class Second>
CombinedMotion(First, Second) -> CombinedMotion<First, Second>;

}  // namespace silt
