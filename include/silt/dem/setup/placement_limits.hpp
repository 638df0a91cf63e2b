// SPDX-License-Identifier: MIT
// Refuses placements that would take all memory or never end, and positions beyond the box.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/dem/setup/size_distribution.hpp>

#include <cstddef>
#include <cstdint>
#include <string>

namespace silt::dem::detail {

/// Number of grains placed at once, which take about 100 GB.
inline constexpr double max_placed = 1e8;
/// Number of positions tried for one grain, which takes some seconds.
inline constexpr Index max_tries = 10'000'000;

/// `name` is that of the function or observer.
inline void check_tries(const std::string& name, Index tries) {
  if (tries >= 1 && tries <= max_tries) return;
  fail({name, ": tries = ", tries,
        " must be at least 1 and at most 1e7; give a value in that range"});
}

/// Throws unless the corners of the region are finite.
template <int Dim, class Real>
void check_bounds(const Box<Dim, Real>& bounds) {
  require_finite("dem: lower corner of the region", bounds.lower);
  require_finite("dem: upper corner of the region", bounds.upper);
}

/// Throws if a grain of this radius [m] is larger than the bounds of the region.
template <int Dim, class Real>
void check_fits(const std::string& name, const Box<Dim, Real>& bounds, double radius) {
  for (int k = 0; k < Dim; ++k) {
    if (bounds.periodic[static_cast<std::size_t>(k)]) continue;
    const double length = double(bounds.upper[k]) - double(bounds.lower[k]);
    if (2 * radius <= length * (1 + 1e-6)) continue;
    fail({name, ": a grain of radius ", radius, " m has no room in the region, which is ", length,
          " m long along axis ", k, "; enlarge the region, or use smaller grains"});
  }
}

/// Number of positions at which a grain has room, or it has none in the region.
inline constexpr Index tries_for_room = 100'000;

/// Throws because a grain of this radius [m] has room at none of them, whatever the other grains
/// do.
[[noreturn]] inline void fail_for_room(const std::string& name, double radius) {
  fail({name, ": a grain of radius ", radius, " m has no room in the region: none of ",
        tries_for_room,
        " random positions in its bounds, wrapped into a periodic box, is that far within it; "
        "enlarge the region, move it into the box, or use smaller grains"});
}
/// The same, because of the walls at a time [s].
[[noreturn]] inline void fail_for_walls(const std::string& name, double radius, double time) {
  fail({name, ": a grain of radius ", radius, " m has no room in the region: at none of ",
        tries_for_room,
        " random positions it is clear of the walls, and before them, at t = ", time,
        " s; move the region, use smaller grains, or begin later, when walls have moved (from)"});
}

/// Throws if x [m] is beyond a side of the box that is not periodic: the first step would throw, or
/// remove the grain.
template <int Dim, class Real>
void check_in_box(const Box<Dim, Real>& box, const Vec<Dim, Real>& x) {
  for (int k = 0; k < Dim; ++k) {
    if (box.periodic[static_cast<std::size_t>(k)]) continue;
    if (box.lower[k] <= x[k] && x[k] <= box.upper[k]) continue;
    const Real side = x[k] < box.lower[k] ? box.lower[k] : box.upper[k];
    fail({"dem: the region has a free position x = ", to_text(x),
          " m beyond the side of the box at ", side, " m along axis ", k,
          "; keep the region within the box, or enlarge the box"});
  }
}

/// About how many grains fill this volume [m³] without voids.
template <int Dim, DrawsGrains B>
double number_in(double volume, const B& blend, std::uint64_t seed) {
  constexpr Index samples = 256;
  double filled = 0;
  for (Index k = 0; k < samples; ++k) {
    Random random{.seed = seed, .id = k};
    filled += volume_of<Dim>(blend.draw(random).radius);
  }
  return volume / (filled / double(samples));
}

}  // namespace silt::dem::detail
