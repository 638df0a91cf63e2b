// SPDX-License-Identifier: MIT
// Where a flow has a pressure, and the boundary of this region: P = 0 on the free surface. Dummies
// have no pressure; nor have the particles of smooth walls that are dry or on the free surface.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/flow_operators.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/free_surface.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/source.hpp>

#include <cstdint>
#include <vector>

namespace silt::mps {

template <class Scheme>
class PressureBoundary {
 public:
  /// Finds n_i (5), the free surface (13), (17), and the particles with a pressure.
  template <FluidParticles P, int Dim, class Real>
  void find(P& particles, const FlowOperators<Scheme, Dim, Real>& operators,
            const typename Scheme::Surface& criterion) {
    using Vec = silt::Vec<Dim, Real>;
    const auto& neighbourhood = operators.neighbourhood();
    const auto& stencil = operators.stencil();
    const auto n = particles[number_density];
    const auto on_surface = particles[surface];
    const auto kinds = particles.with_ghosts(kind);
    has_pressure_.resize(particles.size());
    for_each(particles.size(), [&](Index i) {
      n[i] = neighbourhood.density(i);
      const LocalDensity local_density{
          .density = double(n[i] / stencil.n0),
          .neighbours = double(neighbourhood[i].size()) / double(stencil.neighbours)};
      has_pressure_[i] = kinds[i] != Kind::dummy;
      if constexpr (SurfaceByDensity<typename Scheme::Surface>) {
        on_surface[i] = criterion.is_on_surface(local_density);
      } else {
        const SurfaceScale<Real> scale{.spacing = stencil.spacing, .n0 = stencil.n0};
        const auto for_each_around = [&](auto&& f) {
          for_each_weighted(neighbourhood, i, stencil, [&](Index j, const Vec& r_ij, Real w, Real) {
            f(r_ij, w, kinds[i] != Kind::fluid || kinds[j] == Kind::fluid);
          });
        };
        on_surface[i] = kinds[i] != Kind::dummy && criterion.template is_on_surface<Dim, Real>(
                                                       local_density, scale, for_each_around);
      }
      if (!Scheme::Walls::smooth || kinds[i] != Kind::wall) return;
      const bool is_wet = any_weighted(neighbourhood, i, stencil,
                                       [&](Index j, Real) { return kinds[j] == Kind::fluid; });
      on_surface[i] |= !is_wet;
      has_pressure_[i] = !on_surface[i];
    });
    if constexpr (balances_forces<typename Scheme::Source>() || Scheme::Shifting::shifts) {
      is_near_.resize(particles.size());
      for_each(particles.size(), [&](Index i) {
        if (kinds[i] == Kind::dummy) return;
        const auto is_boundary = [&](Index j, Real) {
          const Index owner = particles.owner(j);
          return on_surface[owner] || !has_pressure_[owner];
        };
        is_near_[i] = on_surface[i] || any_weighted(neighbourhood, i, stencil, is_boundary);
      });
    }
  }

  /// Whether an owned particle has a pressure: an unknown one, or P = 0 on the free surface.
  bool has_pressure(Index i) const noexcept { return has_pressure_[i] != 0; }
  /// Whether an owned particle or a neighbour lies on the free surface, or a neighbour has no
  /// pressure; known only to schemes that balance forces or shift particles.
  bool is_near(Index i) const noexcept { return is_near_[i] != 0; }

  /// <∇P>_i over the neighbours with pressure.
  template <class Gradient, FluidParticles P, int Dim, class Real>
  Vec<Dim, Real> pressure_gradient(const P& particles,
                                   const FlowOperators<Scheme, Dim, Real>& operators,
                                   Index i) const {
    const auto p = particles.with_ghosts(pressure);
    const auto& stencil = operators.stencil();
    return Gradient::evaluate(stencil, p[i], [&](auto&& f) {
      for_each_weighted(operators.neighbourhood(), i, stencil,
                        [&](Index j, const Vec<Dim, Real>& r_ij, Real w, Real w_r2) {
                          if (has_pressure_[particles.owner(j)]) f(p[j], r_ij, w, w_r2);
                        });
    });
  }

 private:
  std::vector<std::uint8_t> has_pressure_;
  std::vector<std::uint8_t> is_near_;
};

}  // namespace silt::mps
