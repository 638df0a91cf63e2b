// SPDX-License-Identifier: MIT
// Random placement of non-overlapping grains in a region: random sequential addition, largest
// grains first. The solid fraction reaches at most 0.38 for equal spheres and 0.54 for equal discs.
// For denser packings let grains fall (inflow.hpp) and settle (settling.hpp).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/setup/occupancy.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/dem/setup/region.hpp>
#include <silt/dem/setup/size_distribution.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace silt::dem {

/// Finds free positions for grains in a region.
template <class Region, int Dim, class Real>
class Placement {
 public:
  using Ball = dem::Ball<Dim, Real>;

  /// Existing grains that may overlap the region are taken into account. `largest` is the radius of
  /// the largest grain to be placed [m].
  template <class P>
  Placement(const P& grains, const Region& region, double largest)
      : region_(region), bounds_(region.bounds()), box_(grains.box()), occupancy_(grains.box()) {
    require_finite("dem: lower corner of the region", bounds_.lower);
    require_finite("dem: upper corner of the region", bounds_.upper);
    const auto x = grains[position];
    const auto R = grains[radius];
    for (Index i = 0; i < grains.size(); ++i) {
      const bool near = box_.any_periodic() || bounds_.clearance(x[i]) > -R[i] - Real(largest);
      if (near) occupancy_.add({x[i], R[i]});
    }
  }

  /// A position in the region where a grain of this radius touches no other, found in at most
  /// `tries` draws; it then counts as occupied.
  std::optional<Ball> find(Random& random, Real radius, Index tries) {
    for (Index k = 0; k < tries; ++k) {
      const Ball ball{box_.wrap(random.point_in(bounds_)), radius};
      if (region_.clearance(ball.centre) < radius || !occupancy_.has_room_for(ball)) continue;
      occupancy_.add(ball);
      return ball;
    }
    return {};
  }

 private:
  const Region& region_;
  Box<Dim, Real> bounds_;
  Box<Dim, Real> box_;
  Occupancy<Dim, Real> occupancy_;
};

/// How many grains scatter() adds: a given number, or up to a given solid fraction.
struct Scatter {
  std::optional<Index> number = {};
  std::optional<double> solid_fraction = {};  ///< volume of the added grains over the region's [-]
  std::uint64_t seed = 0;
  Index tries = 2000;  ///< positions to try for each grain
};

namespace detail {
template <int Dim, class Sizes>
std::vector<Grain> draw_grains(const Blend<Sizes>& blend, const Scatter& scatter, double volume) {
  if (scatter.number.has_value() == scatter.solid_fraction.has_value()) {
    fail("dem::scatter: give either number or solid_fraction");
  }
  const double share = scatter.solid_fraction.value_or(0);
  require_between("dem::scatter: solid_fraction", share, {0, 1});
  std::vector<Grain> drawn;
  for (double filled = 0; scatter.number ? drawn.size() < *scatter.number : filled < share * volume;
       filled += volume_of<Dim>(drawn.back().radius)) {
    Random random{.seed = scatter.seed, .id = drawn.size()};
    drawn.push_back(blend.draw(random));
  }
  std::stable_sort(drawn.begin(), drawn.end(),
                   [](const Grain& a, const Grain& b) { return a.radius > b.radius; });
  return drawn;
}
}  // namespace detail

/// Adds grains at rest that lie entirely inside the region and touch neither each other nor
/// existing grains. If there is no free position for a grain, throws silt::Error and adds none;
/// the message contains the number of grains placed until then.
template <class P, class Sizes, Region<P::dimension, typename P::Real> R>
void scatter(P& grains, const Blend<Sizes>& blend, const R& region, const Scatter& scatter) {
  using Real = typename P::Real;
  blend.check();
  region.check();
  const double volume = region.volume();
  if (scatter.solid_fraction) require_finite("dem::scatter: volume of the region", volume);
  const auto drawn = detail::draw_grains<P::dimension>(blend, scatter, volume);
  Placement<R, P::dimension, Real> placement(grains, region, blend.sizes.largest());
  std::vector<Ball<P::dimension, Real>> placed;
  double filled = 0;
  for (const Grain& grain : drawn) {
    // The first numbers of each stream were used for the radii.
    Random random{.seed = scatter.seed, .id = placed.size(), .counter = std::uint64_t{1} << 32};
    const auto ball = placement.find(random, Real(grain.radius), scatter.tries);
    if (!ball) {
      fail("dem::scatter: placed " + std::to_string(placed.size()) + " of " +
           std::to_string(drawn.size()) + " grains, " + to_text(filled / volume) +
           " of the region, and found no free position for a grain of radius " +
           to_text(grain.radius) + " m in " + std::to_string(scatter.tries) +
           " tries; place fewer grains, or let grains fall and settle");
    }
    placed.push_back(*ball);
    filled += volume_of<P::dimension>(grain.radius);
  }
  grains.reserve(grains.size() + placed.size());
  for (Index k = 0; k < placed.size(); ++k) add_grain(grains, placed[k].centre, drawn[k]);
}

}  // namespace silt::dem
