// SPDX-License-Identifier: MIT
// The load of a flow on faces that move together.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/fluid_load.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/mps/fluid/momentum_change.hpp>

#include <cstdint>

namespace silt::mps {

/// What all particles of a flow have in common.
using FlowOfLoad = FluidOfLoad;

/// See FluidLoad: the change of momentum and of angular momentum of the fluid that sees the faces.
template <int Dim>
class LoadOnGroup {
 public:
  using Vec = silt::Vec<Dim>;

  /// The torque is about a point [m].
  template <class Real>
  LoadOnGroup(const Faces<Dim>& faces, std::uint32_t group, const Box<Dim, Real>& box,
              const Vec& about, const FlowOfLoad& flow)
      : load_(faces, box, flow), group_(group), about_(about) {
    for (const auto& element : faces.elements()) {
      if (element.group == group) bounds_.enclose(element.face);
    }
  }

  /// By the particles with these changes; sum_of_all(numbers) are the sums over all processes.
  template <class SumOfAll>
  BodyLoad<Dim> sum(const Buffer<MomentumChange<Dim>>& changes, SumOfAll&& sum_of_all) const {
    const auto is_of_group = [&](std::uint32_t k) { return load_.walls()[k].group == group_; };
    const BodyLoad<Dim> own = load_.sum(
        changes, bounds_, about_,
        [&](const Vec&, const typename FluidLoad<Dim>::SeenWall& seen) {
          return is_finite(seen.face.distance) && is_of_group(seen.face.element) ? 1.0 : 0.0;
        },
        [&](const typename FluidLoad<Dim>::NearestWall& wall) {
          return is_of_group(wall.element);
        });
    silt::Vec<6> numbers = silt::Vec<6>::Zero();
    for (int k = 0; k < Dim; ++k) numbers[k] = own.force[k];
    for (int k = 0; k < angular_size<Dim>; ++k) numbers[Dim + k] = component(own.torque, k);
    numbers = sum_of_all(numbers);
    BodyLoad<Dim> load;
    for (int k = 0; k < Dim; ++k) load.force[k] = numbers[k];
    for (int k = 0; k < angular_size<Dim>; ++k) component(load.torque, k) = numbers[Dim + k];
    return load;
  }

 private:
  FluidLoad<Dim> load_;
  std::uint32_t group_;
  Vec about_;
  BoundsOfFaces<Dim> bounds_;
};

}  // namespace silt::mps
