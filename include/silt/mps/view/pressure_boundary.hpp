// SPDX-License-Identifier: MIT
// Where a flow has a pressure, and the boundary of this region: P = 0 on the free surface. Dummies
// have no pressure; nor have the particles of walls to which their model gives none.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/policy/free_surface.hpp>
#include <silt/mps/policy/outer_surface.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/view/flow_operators.hpp>
#include <silt/mps/view/neighbour_view.hpp>
#include <silt/mps/wall/walls.hpp>

#include <cstdint>

namespace silt::mps {

/// Finds the free surface and the particles with a pressure, with the criterion and the walls of a
/// Scheme.
template <class Scheme>
class PressureBoundary {
 public:
  /// Finds n_i (5), the free surface (13), (17), and the particles with a pressure.
  template <FluidParticles P, int Dim, class Real>
  void find(P& particles, const FlowOperators<Scheme, Dim, Real>& operators,
            const SurfaceOf<Scheme>& criterion) {
    const auto n = particles[number_density];
    const auto on_surface = particles[surface];
    has_pressure_.resize(particles.local());
    near_boundary_.assign(particles.size(), Answer::unknown);
    if constexpr (HasOuterSurface<SurfaceOf<Scheme>>) weight_of_surface_.resize(particles.size());
    for_each_inlined(particles.size(), [&](Index i) {
      const NeighbourView at(particles, operators, i);
      n[i] = operators.density(i);
      const LocalDensity local = operators.local_density(i, n[i]);
      on_surface[i] = is_on_surface(criterion, at, local) || operators.walls().is_dry(at);
      has_pressure_[i] = operators.walls().has_pressure(at.kind(), on_surface[i] != 0);
      if constexpr (HasOuterSurface<SurfaceOf<Scheme>>) {
        const bool is_of_fluid = on_surface[i] && at.kind() == Kind::fluid;
        weight_of_surface_[i] = is_of_fluid ? double(criterion.weight_of_surface(at)) : 0;
      }
    });
    particles.refresh_ghosts(surface);
    if constexpr (!all_have_pressure) silt::detail::share(particles, has_pressure_);
  }

  /// Whether a particle, owned or of the halo, has a pressure: an unknown one, or P = 0 on the free surface.
  bool has_pressure(Index i) const noexcept { return all_have_pressure || has_pressure_[i] != 0; }

  /// Weight of the free surface in the pressure equation of an owned particle [-], if the pressure
  /// of particles on it is unknown, see OuterSurface; otherwise 0.
  double weight_of_surface(Index i) const noexcept {
    return weight_of_surface_.empty() ? 0 : weight_of_surface_[i];
  }

  /// Whether the particle of a view or a neighbour lies on the free surface, or a neighbour has no
  /// pressure. Found when it is asked for, as most schemes do not ask; the answer is kept. Throws
  /// before the free surface was found.
  template <class View>
  [[gnu::always_inline]] bool near_boundary(const View& at) const {
    if (at.index() >= near_boundary_.size()) {
      fail("mps: near_boundary() is not known before the free surface was found; do not use it in "
           "begin()");
    }
    Answer& answer = near_boundary_[at.index()];
    if (answer == Answer::unknown) {
      const auto on_surface = at.particles().with_ghosts(surface);
      const auto is_boundary = [&](const auto& j) {
        return on_surface[j.index] || !has_pressure(at.owner(j));
      };
      answer = on_surface[at.index()] || at.any(is_boundary) ? Answer::yes : Answer::no;
    }
    return answer == Answer::yes;
  }

 private:
  static constexpr bool all_have_pressure = AllHavePressure<WallsOf<Scheme>>;
  enum class Answer : std::uint8_t { unknown, no, yes };

  template <class Operators, class P>
  static bool is_on_surface(const SurfaceOf<Scheme>& criterion,
                            const NeighbourView<Operators, P>& at, const LocalDensity& local) {
    const auto kinds = at.kinds();
    const auto for_each_neighbour = [&](auto&& f) {
      at.for_each([&](const auto& j) {
        f(j.r_ij, j.weight, at.kind() != Kind::fluid || j.kind(kinds) == Kind::fluid);
      });
    };
    using Real = typename P::Real;
    using View = SurfaceView<P::dimension, Real, decltype(for_each_neighbour)>;
    return criterion.is_on_surface(
        View{local, at.stencil().spacing, at.stencil().n0, for_each_neighbour});
  }

  Buffer<std::uint8_t> has_pressure_;
  Buffer<double> weight_of_surface_;
  mutable Buffer<Answer> near_boundary_;  // each written by the evaluation of its particle
};

}  // namespace silt::mps
