// SPDX-License-Identifier: MIT
// Checks of the particles before a step of a flow, for mistakes that would only show as wrong
// results: positions with too few digits; before the first step, also particles and flow of
// different spacings, a lattice that does not fit into a periodic box, and what the walls require
// of a start. Random and disordered arrangements, such as those of a flow in motion, pass.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/step_checks.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/neighbourhood.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace silt::mps {

namespace detail {

/// Number of fluid particles i for which belongs(i).
template <FluidParticles P, class F>
Index count_fluid(const P& particles, F&& belongs) {
  return ordered_sum(particles.size(), Index(0), [&, kinds = particles[kind]](Index i) {
    return Index(kinds[i] == Kind::fluid && belongs(i));
  });
}

}  // namespace detail

/// Throws if a particle is so far from the origin that its position is not known to a hundredth of
/// the spacing of the stencil.
template <FluidParticles P, class T>
void check_positions(const P& particles, const T& stencil) {
  silt::detail::check_digits_of_positions("mps::Flow", particles, "spacing",
                                          [&](Index) { return stencil.spacing; });
}

/// Throws if most fluid particles have far more neighbours than at the spacing l0 of the stencil,
/// or several, but none near l0; with the volumes of BulkVolumes.
template <FluidParticles P, class N, class T, class Volumes>
[[gnu::cold]] void check_spacing(const P& particles, const N& neighbourhood, const T& stencil,
                                 const Volumes& volumes) {
  const double l0 = double(stencil.spacing);
  const double q = double(stencil.re) / l0;
  // Number of neighbours in a random arrangement: the volume of the neighbourhood in l0^Dim.
  const double at_random = std::numbers::pi * q * q * (P::dimension == 2 ? 1 : 4 * q / 3);
  const double too_many = 1.5 * std::max(double(stencil.neighbours), at_random);
  const auto nearest = [&](Index i) {
    const auto row = neighbourhood[i];
    auto r2 = std::numeric_limits<typename P::Real>::infinity();
    for (Index k = 0; k < row.size(); ++k) {
      const auto x_j = neighbourhood.position_of(row.index[k]);
      r2 = std::min(r2, (x_j - neighbourhood.position_of(i)).squaredNorm());
    }
    // As if its volume was l0^Dim.
    return std::sqrt(double(r2)) / std::pow(double(volumes[i]), 1.0 / P::dimension);
  };
  const Index own_crowded = detail::count_fluid(
      particles, [&](Index i) { return double(neighbourhood[i].size()) > too_many; });
  const Index own_sparse = detail::count_fluid(particles, [&](Index i) {
    return neighbourhood[i].size() >= 4 && nearest(i) > 1.4 * l0;
  });
  const auto [fluid, crowded, sparse] = silt::detail::sum_of_all(
      particles, std::array{double(count(particles, Kind::fluid)), double(own_crowded),
                            double(own_sparse)});
  if (2 * std::max(crowded, sparse) <= fluid) return;

  std::vector<double> distances;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[kind][i] == Kind::fluid) distances.push_back(nearest(i));
  }
  if (distances.empty()) return;  // another process may have some
  const auto median = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), median, distances.end());
  fail({"mps::Flow: the fluid particles are ", *median,
        " m apart (median distance of the nearest neighbour), but FlowSettings: spacing = ", l0,
        " m; use the same spacing for both"});
}

/// Throws if the fluid is a lattice of the spacing of the stencil along a periodic axis, interacts
/// across the periodic side, and the box is not an integer number of spacings long.
template <FluidParticles P, class N, class T>
[[gnu::cold]] void check_periodic_lattice(const P& particles, const N& neighbourhood,
                                          const T& stencil) {
  const double l0 = double(stencil.spacing);
  const auto& box = particles.box();
  // Whether some neighbour j of i has has(j, x_j − x_i).
  const auto any_neighbour = [&](Index i, auto&& has) {
    const auto row = neighbourhood[i];
    for (Index k = 0; k < row.size(); ++k) {
      const Index j = row.index[k];
      const typename P::Vec r_ij = neighbourhood.position_of(j) - neighbourhood.position_of(i);
      if (has(j, r_ij)) return true;
    }
    return false;
  };
  for (int k = 0; k < P::dimension; ++k) {
    if (!box.periodic[static_cast<std::size_t>(k)]) continue;
    const double side = double(box.upper[k]) - double(box.lower[k]);
    if (std::abs(side / l0 - std::round(side / l0)) <= 0.01) continue;
    const Index own_aligned = detail::count_fluid(particles, [&](Index i) {
      return any_neighbour(i, [&](Index, const auto& r_ij) {
        const double along = std::abs(double(r_ij[k]));
        return along > 0.999 * l0 && double(r_ij.norm()) < 1.001 * l0;
      });
    });
    const Index own_across = detail::count_fluid(particles, [&](Index i) {
      return any_neighbour(i, [&](Index j, const auto& /*r_ij*/) {
        const double x = double(neighbourhood.position_of(j)[k]);
        return j >= particles.local() && !(x >= double(box.lower[k]) && x < double(box.upper[k]));
      });
    });
    const auto [fluid, aligned, across] = silt::detail::sum_of_all(
        particles, std::array{double(count(particles, Kind::fluid)), double(own_aligned),
                              double(own_across)});
    if (2 * aligned <= fluid || across == 0) continue;
    fail({"mps::Flow: the periodic side ", side, " m along axis ", k, " is ", side / l0,
          " spacings of ", l0, " m; give the box an integer number of spacings"});
  }
}

/// The checks of the first step, with the neighbours, stencil and walls of FlowOperators, and
/// gravity [m/s²]. Throws as check_spacing(), check_periodic_lattice() and check_start() of the
/// walls do.
template <FluidParticles P, class Operators>
[[gnu::cold]] void check_arrangement(const P& particles, const Operators& operators,
                                     [[maybe_unused]] const Vec<P::dimension>& gravity) {
  check_spacing(particles, operators.neighbourhood(), operators.stencil(),
                operators.bulk_volumes());
  check_periodic_lattice(particles, operators.neighbourhood(), operators.stencil());
  if constexpr (requires { operators.walls().check_start(particles, operators, gravity); }) {
    operators.walls().check_start(particles, operators, gravity);
  }
}

}  // namespace silt::mps
