// SPDX-License-Identifier: MIT
// Motions of rigid bodies that are given by a table, or by any function.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/rigid_motion.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace silt {

/// Through given positions at given times: a cubic between two of them, with the slope of the
/// parabola through each and its neighbours, so that the velocity is continuous. At rest before the
/// first and after the last one.
template <int Dim>
struct TabulatedMotion {
  std::vector<double> times;          ///< [s], increasing
  std::vector<Vec<Dim>> shifts = {};  ///< [m], one for each time; or empty
  /// Rotation vectors, in 2D angles [rad], one for each time; or empty. In 3D they are best along
  /// one axis: between times each component is interpolated.
  std::vector<AngularVec<Dim>> turns = {};
  Vec<Dim> about = Vec<Dim>::Zero();  ///< the point about which it turns, before the shift [m]

  /// Throws if the table is invalid.
  void check() const {
    if (times.size() < 2) {
      fail({"TabulatedMotion: times = ", times.size(), " values; give at least 2"});
    }
    for (std::size_t k = 0; k < times.size(); ++k) {
      require_finite("TabulatedMotion: times", times[k]);
      if (k == 0 || times[k] > times[k - 1]) continue;
      fail({"TabulatedMotion: times[", k, "] = ", times[k], " s is not after ", times[k - 1],
            " s; give increasing times"});
    }
    if (shifts.empty() && turns.empty()) {
      fail("TabulatedMotion: there are neither shifts nor turns; give one of them");
    }
    require_size("shifts", shifts.size());
    require_size("turns", turns.size());
    for (const Vec<Dim>& shift : shifts) require_finite("TabulatedMotion: shifts", shift);
    for (const auto& turn : turns) require_finite("TabulatedMotion: turns", turn);
    require_finite("TabulatedMotion: about", about);
  }
  Pose<Dim> pose_at(double t) const {
    const Place place = place_of(t);
    Pose<Dim> pose;
    if (!turns.empty()) pose.rotation = rotation_of(value(turns, place));
    pose.shift = about - multiply<Dim, double>(pose.rotation, about);
    if (!shifts.empty()) pose.shift += value(shifts, place);
    return pose;
  }
  /// In 3D for turns along one axis.
  RigidVelocity<Dim> velocity_at(double t) const {
    const Place place = place_of(t);
    RigidVelocity<Dim> velocity_now{.about = about};
    if (!shifts.empty()) {
      velocity_now.about += value(shifts, place);
      velocity_now.linear = rate(shifts, place);
    }
    if (!turns.empty()) velocity_now.spin = rate(turns, place);
    return velocity_now;
  }

 private:
  // An interval, and the share of it that has passed.
  struct Place {
    std::size_t first;
    double share;
    double length;  // [s]; 0 beyond the table
  };

  void require_size(const char* name, std::size_t size) const {
    if (size == 0 || size == times.size()) return;
    fail({"TabulatedMotion: ", name, " = ", size, " values for ", times.size(),
          " times; give one for each"});
  }
  static Eigen::Matrix<double, Dim, Dim> rotation_of(const AngularVec<Dim>& turn) {
    if constexpr (Dim == 2) {
      return rotation_by(turn);
    } else {
      const double full = turn.norm();
      if (!(full > 0)) return Eigen::Matrix<double, 3, 3>::Identity();
      return rotation_about(Vec<3>(turn / full), full);
    }
  }
  Place place_of(double t) const {
    if (t <= times.front()) return {0, 0, 0};
    if (t >= times.back()) return {times.size() - 2, 1, 0};
    const auto next = std::upper_bound(times.begin(), times.end(), t);
    const auto first = std::size_t(next - times.begin()) - 1;
    const double length = times[first + 1] - times[first];
    return {first, (t - times[first]) / length, length};
  }
  // Of the parabola through the neighbours; 0 at both ends of the table.
  template <class V>
  V slope(const std::vector<V>& values, std::size_t k) const {
    if (k == 0 || k + 1 == times.size()) return zero_of<V>();
    const double before = times[k] - times[k - 1], after = times[k + 1] - times[k];
    return V((values[k + 1] - values[k]) * (before / (after * (before + after))) +
             (values[k] - values[k - 1]) * (after / (before * (before + after))));
  }
  template <class V>
  V value(const std::vector<V>& values, const Place& place) const {
    const double s = place.share;
    const double of_second = s * s * (3 - 2 * s);
    return V((1 - of_second) * values[place.first] + of_second * values[place.first + 1] +
             place.length * s * (1 - s) *
                 ((1 - s) * slope(values, place.first) - s * slope(values, place.first + 1)));
  }
  template <class V>
  V rate(const std::vector<V>& values, const Place& place) const {
    if (!(place.length > 0)) return zero_of<V>();
    const double s = place.share;
    return V(6 * s * (1 - s) / place.length * (values[place.first + 1] - values[place.first]) +
             (1 - s) * (1 - 3 * s) * slope(values, place.first) -
             s * (2 - 3 * s) * slope(values, place.first + 1));
  }
};

/// A pose [m] that is any function of the time [s], which should have a continuous second
/// derivative.
template <int Dim>
struct MotionFunction {
  std::function<Pose<Dim>(double)> pose{};

  /// Throws if there is no function.
  void check() const {
    if (pose) return;
    fail({"MotionFunction: pose is empty; give a function of the time"});
  }
  Pose<Dim> pose_at(double t) const { return pose(t); }
  /// By a difference over 0.2 ms, at the time 0 over 0.1 ms after it.
  RigidVelocity<Dim> velocity_at(double t) const {
    constexpr double h = 1e-4;
    const double first = std::max(t - h, std::min(t, 0.0)), duration = t + h - first;
    const Pose<Dim> before = pose(first), now = pose(t), after = pose(t + h);
    const Pose<Dim> change = after.after(before.inverse());
    return {.linear = (after.shift - before.shift) / duration,
            .spin = turn_of(change.rotation) / duration,
            .about = now.shift};
  }
};

}  // namespace silt
