// SPDX-License-Identifier: MIT
// A free surface beyond the outermost particles instead of through their centres.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/policy/any_particle_view.hpp>
#include <silt/mps/policy/free_surface.hpp>

#include <algorithm>
#include <concepts>

namespace silt::mps {

/// P = 0 outside of the particles that the criterion finds on the free surface, by half of their cell.
/// Their pressures are unknowns. The space beyond, where neighbours are missing, contributes to (6)
/// with the pressure that falls linearly through zero at the surface:
///
///   Σ_j w_ij (P_i − P_j) + a_i P_i = 0,   a_i = max(|Σ_j w_ij r_ij|, 0.8 h̄ (n0 − n_i)) / δ_i
///   δ_i = l0 (½ + (n_i − n_s)/n_r)
///
/// With the first, a linear pressure is met exactly; the second, on the lattice 0.8 times the first, is
/// for sheets and drops, which are open on more than one side. (With a factor of 1, a particle that
/// rises out of a surface at rest would get too small a pressure, and rise on.) δ_i is the
/// height of the surface above the particle: a cell keeps its volume, so that it is higher where the
/// surface contracts, and n_i is then above the value n_s of a flat surface; n_r is the weight of a
/// plane of particles with the particle itself, h̄ the mean height of the neighbours on one side of
/// it. Such a particle has no source, as its divergence is that of an incomplete neighbourhood.
/// Similar to the conceptual particles of [ChenXiSun2014]. Without it, P = 0 at the centres, half a
/// spacing too low.
template <FreeSurface Criterion>
struct OuterSurface {
  Criterion criterion{};
  /// N/N0 [-] below which a particle is on the surface, whatever the criterion says: a drop in a
  /// corner has a high n from its own images, and would get the pressure of a closed tank.
  double min_neighbours = 0.5;

  void check() const {
    criterion.check();
    require_between("OuterSurface: min_neighbours", min_neighbours, {0, 1});
  }
  template <class View>
  bool is_on_surface(const View& at) const {
    return at.neighbours < min_neighbours || criterion.is_on_surface(at);
  }
  /// a_i [-], from a NeighbourView.
  template <class View>
  typename View::Real weight_of_surface(const View& at) const {
    using Real = typename View::Real;
    const auto& stencil = at.laplacian_stencil();
    typename View::Vec moment = View::Vec::Zero();
    Real n = 0;
    at.for_each_in_laplacian([&](const auto& j) {
      moment += j.weight * j.r_ij;
      n += j.weight;
    });
    n += at.own_density_in_laplacian();
    const Real missing = Real(0.8) * stencil.mean_height * (stencil.n0 - n);
    const Real flat = stencil.n0 - stencil.above;  // n_s
    const Real plane = stencil.n0 - 2 * stencil.above + stencil.kernel.weight(Real(0));  // n_r
    constexpr Real lowest = Real(0.2), highest = 1;  // spacings; of spray, and in disorder
    const Real height = std::clamp(Real(0.5) + (n - flat) / plane, lowest, highest);
    return std::max(moment.norm(), missing) / (height * stencil.spacing);
  }
};

/// Criteria of a free surface on which the pressure of particles is unknown: weight_of_surface(at)
/// is the weight of P = 0 in the pressure equation of a particle [-], from its NeighbourView; a
/// particle for which it is not positive has P = 0.
template <class S>
concept HasOuterSurface = FreeSurface<S> && requires(const S criterion,
                                                     const detail::AnyParticleView<2>& in_2d,
                                                     const detail::AnyParticleView<3>& in_3d) {
  { criterion.weight_of_surface(in_2d) } -> std::convertible_to<double>;
  { criterion.weight_of_surface(in_3d) } -> std::convertible_to<double>;
};

}  // namespace silt::mps
