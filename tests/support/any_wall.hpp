// SPDX-License-Identifier: MIT
// Type erasure for walls and for motions, so that a test file instantiates one simulation for all
// of them.
#pragma once

#include <silt/dem/wall/walls.hpp>

#include <cstdint>
#include <functional>
#include <limits>

namespace silt::test {

template <int Dim>
struct AnyWall {
  using V = Vec<Dim>;
  std::uint32_t material = 0;
  Index count = 1;
  std::function<dem::NearestPoint<Dim, double>(Index, const V&)> nearest_to_element;
  std::function<void(const V&, double, const std::function<void(Index)>&)> elements_near;

  template <class W>
  explicit AnyWall(W wall) {
    wall.check();
    material = wall.material;
    if constexpr (dem::CompositeWall<W, Dim, double>) {
      count = wall.element_count();
      nearest_to_element = [wall](Index element, const V& x) { return wall.nearest(element, x); };
      elements_near = [wall](const V& x, double distance, const auto& f) {
        wall.for_each_element_near(x, distance, f);
      };
    } else {
      nearest_to_element = [wall](Index, const V& x) { return wall.nearest(x); };
      elements_near = [wall](const V& x, double distance, const auto& f) {
        if (wall.nearest(x).distance < distance) f(0);
      };
    }
  }

  void check() const {}
  Index element_count() const { return count; }
  dem::NearestPoint<Dim, double> nearest(Index element, const V& x) const {
    return nearest_to_element(element, x);
  }
  template <class F>
  void for_each_element_near(const V& x, double distance, F&& f) const {
    elements_near(x, distance, f);
  }
};

template <int Dim>
struct AnyMotion {
  std::function<dem::Pose<Dim, double>(double)> pose = [](double) {
    return dem::Pose<Dim, double>{};
  };
  std::function<dem::RigidVelocity<Dim, double>(double)> velocity = [](double) {
    return dem::RigidVelocity<Dim, double>{};
  };

  AnyMotion() = default;
  template <class M>
    requires dem::RigidMotion<M, Dim, double>
  explicit AnyMotion(const M& motion)
      : pose([motion](double t) { return motion.pose_at(t); }),
        velocity([motion](double t) { return motion.velocity_at(t); }) {}

  dem::Pose<Dim, double> pose_at(double t) const { return pose(t); }
  dem::RigidVelocity<Dim, double> velocity_at(double t) const { return velocity(t); }
};

template <int Dim>
using AnyMoving = dem::Moving<AnyWall<Dim>, AnyMotion<Dim>>;

/// A wall at rest, with the type of a moving one.
template <int Dim, class W>
AnyMoving<Dim> at_rest(const W& wall) {
  return {AnyWall<Dim>(wall), AnyMotion<Dim>()};
}
template <int Dim, class W, class M>
AnyMoving<Dim> moving(const W& wall, const M& motion) {
  return {AnyWall<Dim>(wall), AnyMotion<Dim>(motion)};
}

}  // namespace silt::test
