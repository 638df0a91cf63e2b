// SPDX-License-Identifier: MIT
// What walls and bodies that move have to know of a flow.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/momentum_change.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace silt::mps {

/// What bodies have to know of a flow at the end of a step.
template <int Dim>
struct FlowOfStep {
  const FacesNearParticles<Dim>& near;         ///< with the faces
  const Buffer<MomentumChange<Dim>>& changes;  ///< of the particles, in the step
  Box<Dim> box;                                ///< of the particles
  double density;                              ///< [kg/m³]
  /// Gravity and body force at a point [m/s²].
  FunctionRef<Vec<Dim>(const Vec<Dim>&)> acceleration;
  double spacing;    ///< l0 [m]
  double time;       ///< when the step began [s]
  double time_step;  ///< [s]
  /// Sums of numbers over all processes.
  FunctionRef<Vec<6>(const Vec<6>&)> sum;
  /// Largest numbers of all processes.
  FunctionRef<std::array<double, 2>(const std::array<double, 2>&)> maximum;
};

namespace detail {

/// When a step began [s], and its length [s].
struct Duration {
  double time = 0;
  double time_step;
};

/// f(flow) with the flow of these particles, changes of momentum and settings in a step. Spacing l0
/// in [m].
template <FluidParticles P, class Settings, class F>
[[gnu::cold]] void with_flow_of_step(const P& particles,
                                     const FacesNearParticles<P::dimension>& near,
                                     const Buffer<MomentumChange<P::dimension>>& changes,
                                     const Settings& settings, double spacing, const Duration& step,
                                     F&& f) {
  constexpr int Dim = P::dimension;
  const auto& box = particles.box();
  const auto acceleration = [&](const Vec<Dim>& x) -> Vec<Dim> {
    if (!settings.body_force) return settings.gravity;
    return settings.gravity + settings.body_force(x, step.time);
  };
  const auto sum = [&](const Vec<6>& own) { return silt::detail::sum_of_all(particles, own); };
  const auto maximum = [&](const std::array<double, 2>& own) {
    return silt::detail::largest_of_all(particles, own);
  };
  f(FlowOfStep<Dim>{.near = near,
                    .changes = changes,
                    .box = {.lower = box.lower.template cast<double>(),
                            .upper = box.upper.template cast<double>(),
                            .periodic = box.periodic},
                    .density = settings.density,
                    .acceleration = acceleration,
                    .spacing = spacing,
                    .time = step.time,
                    .time_step = step.time_step,
                    .sum = sum,
                    .maximum = maximum});
}

/// Marks the groups of faces that move as dry if no particle is near them.
template <FluidParticles P>
[[gnu::cold]] void find_dry_groups(const P& particles, FacesNearParticles<P::dimension>& near) {
  auto& faces = near.moving_faces();
  for (std::uint32_t group = 1; group <= faces.groups(); ++group) {
    const Index wet = first_where(near.size(), [&](Index i) {
      if (!near.has_faces(i)) return false;
      const auto around = near[i].faces();
      return std::any_of(around.begin(), around.end(),
                         [&](std::uint32_t k) { return faces[k].group == group; });
    });
    faces.set_dry(group, !silt::detail::any_of_all(particles, wet != no_index));
  }
}

}  // namespace detail

}  // namespace silt::mps
