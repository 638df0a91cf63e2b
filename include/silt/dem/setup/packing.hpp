// SPDX-License-Identifier: MIT
// Random placement of non-overlapping grains in a region: random sequential addition, largest
// grains first. The solid fraction reaches at most 0.38 for equal spheres and 0.54 for equal discs.
// For denser packings let grains fall (inflow.hpp) and settle (settling.hpp).
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/setup/grains_near.hpp>
#include <silt/dem/setup/placement_limits.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/dem/setup/region.hpp>
#include <silt/dem/setup/size_distribution.hpp>
#include <silt/geometry/ball.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace silt::dem {

/// How many grains scatter() adds: a given number, or as many as reach a given solid fraction,
/// which the last of them exceeds; at most 1e8.
struct Scatter {
  std::optional<Index> number = {};
  std::optional<double> solid_fraction = {};  ///< volume of the added grains over the region's [-]
  std::uint64_t seed = 0;                     ///< of the random numbers
  Index tries = 2000;  ///< positions to try for each grain; 1 to 1e7
};

namespace detail {

/// Finds overlaps with grains that are added one by one. There is one grid per size class, and the
/// cell size doubles from class to class; each grain is stored in a cell of the grid of its class.
/// A query visits the few cells around it in every grid, or all grains of a grid with more cells
/// than grains there.
template <int Dim, class Real>
class Occupancy {
 public:
  using Vec = silt::Vec<Dim, Real>;
  using Ball = silt::Ball<Dim, Real>;

  /// Only the periodic sides of the box matter.
  explicit Occupancy(const Box<Dim, Real>& box) : box_(box) {}

  void add(Ball ball) {
    ball.centre = box_.wrap(ball.centre);
    const int level = std::ilogb(ball.radius);
    levels_[level][key_of(cell_of(ball.centre, edge_of(level)))].push_back(ball);
  }

  /// Whether the ball overlaps none of the added grains.
  bool has_room_for(const Ball& ball) const {
    if (levels_.empty()) return true;
    const Real reach = ball.radius + edge_of(levels_.rbegin()->first) / 2;
    bool free = true;
    for_each_image(box_, box_.wrap(ball.centre), reach, [&](const Vec& image) {
      free = free && !overlaps({image, ball.radius});
    });
    return free;
  }

 private:
  using Cell = std::array<std::int64_t, Dim>;
  using Grid = std::unordered_map<std::uint64_t, std::vector<Ball>>;

  // Larger than the diameters of the level, in which 2^level ≤ R < 2^(level + 1).
  static Real edge_of(int level) { return std::ldexp(Real(4), level); }

  static Cell cell_of(const Vec& x, Real edge) {
    Cell cell;
    for (std::size_t k = 0; k < Dim; ++k) {
      const double x_k = double(x[static_cast<int>(k)]);
      // Integers end at 2⁶³.
      cell[k] =
          static_cast<std::int64_t>(std::floor(std::clamp(x_k / double(edge), -0x1p62, 0x1p62)));
    }
    return cell;
  }
  // Distant cells may share a key: this costs distance tests but does not change the result.
  static std::uint64_t key_of(const Cell& cell) {
    std::uint64_t key = 0;
    for (const std::int64_t part : cell) {
      key = (key ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
    }
    return key;
  }

  bool overlaps(const Ball& ball) const {
    for (const auto& [level, grid] : levels_) {
      const Real edge = edge_of(level);
      const Vec reach = Vec::Constant(ball.radius + edge / 2);
      const Cell low = cell_of(ball.centre - reach, edge);
      const Cell high = cell_of(ball.centre + reach, edge);
      if (overlaps_in(grid, low, high, ball)) return true;
    }
    return false;
  }

  static bool overlaps_one(const std::vector<Ball>& others, const Ball& ball) {
    return std::any_of(others.begin(), others.end(), [&](const Ball& other) {
      const Real apart = ball.radius + other.radius;
      return (other.centre - ball.centre).squaredNorm() < apart * apart;
    });
  }

  static bool overlaps_in(const Grid& grid, const Cell& low, const Cell& high, const Ball& ball) {
    double cells = 1;
    for (std::size_t k = 0; k < Dim; ++k) cells *= double(high[k]) - double(low[k]) + 1;
    if (cells > double(grid.size())) {
      return std::any_of(grid.begin(), grid.end(),
                         [&](const auto& cell) { return overlaps_one(cell.second, ball); });
    }
    for (Cell cell = low; cell[Dim - 1] <= high[Dim - 1];) {
      if (const auto found = grid.find(key_of(cell)); found != grid.end()) {
        if (overlaps_one(found->second, ball)) return true;
      }
      ++cell[0];
      for (std::size_t k = 0; k + 1 < Dim && cell[k] > high[k]; ++k) {
        cell[k] = low[k];
        ++cell[k + 1];
      }
    }
    return false;
  }

  Box<Dim, Real> box_;
  std::map<int, Grid> levels_;  // key: the power of 2 of the radius
};

/// Finds free positions for grains in a region.
template <class Region, int Dim, class Real>
class Placement {
 public:
  using Ball = silt::Ball<Dim, Real>;

  /// Existing grains that may overlap the region are taken into account. `largest` is the radius of
  /// the largest grain to be placed [m].
  template <class P>
  Placement(const P& grains, const Region& region, double largest)
      : Placement(grains, region, GrainsNear<Dim, Real>(region.bounds(), largest).find(grains)) {}
  /// With these grains near the region, see GrainsNear.
  template <class P>
  Placement(const P& grains, const Region& region, std::span<const Index> near)
      : region_(region), bounds_(region.bounds()), box_(grains.box()), occupancy_(grains.box()) {
    check_bounds(bounds_);
    for (const Index i : near) {
      const typename P::Vec x = grains[position][i];
      const Real R = grains[radius][i];
      require_finite("dem: position of an existing grain", x);
      require_positive("dem: radius of an existing grain", double(R));
      occupancy_.add({x, R});
    }
  }

  /// A position in the region where a grain of this radius touches no other and no wall,
  /// touches_wall(x, R), found in at most `tries` draws; it then counts as occupied. Throws if it
  /// is beyond the box.
  template <class TouchesWall>
  std::optional<Ball> find(Random& random, Real radius, Index tries, TouchesWall&& touches_wall) {
    for (Index k = 0; k < tries; ++k) {
      const Ball ball{box_.wrap(random.point_in(bounds_)), radius};
      if (clearance(ball.centre) < radius || !occupancy_.has_room_for(ball)) continue;
      if (touches_wall(ball.centre, radius)) continue;
      check_in_box(box_, ball.centre);
      occupancy_.add(ball);
      return ball;
    }
    return {};
  }

  /// Whether a grain of this radius has room in the region at one of so many positions, if there
  /// were no other grains and, unless touches_wall(x, R), no walls.
  template <class TouchesWall>
  bool has_room(Random random, Real radius, Index tries, TouchesWall&& touches_wall) const {
    for (Index k = 0; k < tries; ++k) {
      const Vec<Dim, Real> x = box_.wrap(random.point_in(bounds_));
      if (!(clearance(x) < radius) && !touches_wall(x, radius)) return true;
    }
    return false;
  }

 private:
  Real clearance(const Vec<Dim, Real>& x) const {
    const Real distance = region_.clearance(x);
    if (is_nan(double(distance))) {
      fail({"dem: clearance(x) of the region returned nan at x = ", to_text(x),
           " m; correct it to return the distance to the boundary"});
    }
    return distance;
  }

  const Region& region_;
  Box<Dim, Real> bounds_;
  Box<Dim, Real> box_;
  Occupancy<Dim, Real> occupancy_;
};

/// What was asked for, as text; `expected` is the number of grains.
inline std::string text_of(const Scatter& scatter, double expected) {
  return scatter.number ? "number = " + to_text(expected) + " grains"
                        : "solid_fraction = " + to_text(*scatter.solid_fraction) + " gives " +
                              to_text(expected) + " grains, which";
}

/// About how many grains a placement adds to a region of this volume [m³]. Throws if there are too
/// many.
template <int Dim, DrawsGrains B>
double expected_number(const B& blend, const Scatter& scatter, double volume) {
  if (scatter.number.has_value() == scatter.solid_fraction.has_value()) {
    fail("dem::scatter: give either number or solid_fraction");
  }
  const double share = scatter.solid_fraction.value_or(0);
  require_between("dem::scatter: solid_fraction", share, {0, 1});
  const double expected = scatter.number ? double(*scatter.number)
                                         : number_in<Dim>(share * volume, blend, scatter.seed);
  if (!(expected <= max_placed)) {
    fail({"dem::scatter: ", text_of(scatter, expected),
          " are more than 1e8; place fewer or larger grains"});
  }
  return expected;
}

template <class P, DrawsGrains B>
auto draw_grains(const B& blend, const Scatter& scatter, double volume) {
  const double share = scatter.solid_fraction.value_or(0);
  std::vector<decltype(blend.draw(std::declval<Random&>()))> drawn;
  const auto volume_of_last = [&] {
    if constexpr (requires { blend.volume(drawn.back()); }) {
      return blend.volume(drawn.back());
    } else {
      return volume_of<P::dimension>(drawn.back().radius);
    }
  };
  for (double filled = 0; scatter.number ? drawn.size() < *scatter.number : filled < share * volume;
       filled += volume_of_last()) {
    if (filled > volume) {
      fail({"dem::scatter: number = ", *scatter.number, " grains have no room: the first ",
            drawn.size(), " of them have the volume of the region, ", volume,
            "; place fewer or smaller grains"});
    }
    Random random{.seed = scatter.seed, .id = drawn.size()};
    drawn.push_back(blend.draw(random));
    if constexpr (requires { inertia_of<P>(drawn.back()); }) inertia_of<P>(drawn.back());
  }
  std::stable_sort(drawn.begin(), drawn.end(),
                   [](const auto& a, const auto& b) { return a.radius > b.radius; });
  return drawn;
}

struct NoWalls {
  template <class Vec, class Real>
  bool would_touch(const Vec&, Real, double) const {
    return false;
  }
};

/// Places the grains of scatter() in a region of this volume [m³]; adds all by add(x, drawn), or
/// throws.
template <class P, DrawsGrains B, class R, class Walls, class Add>
void scatter_in(P& grains, const B& blend, const R& region, const Scatter& scatter, double volume,
                const Walls& walls, Add&& add) {
  using Real = typename P::Real;
  const auto touches_wall = [&](const typename P::Vec& x, Real radius) {
    return walls.would_touch(x, radius, 0);
  };
  const auto drawn = draw_grains<P>(blend, scatter, volume);
  if (!drawn.empty()) {
    const Box<P::dimension, Real> bounds = region.bounds();
    check_fits("dem::scatter", bounds, drawn.front().radius);
  }
  Placement<R, P::dimension, Real> placement(std::as_const(grains), region, blend.largest());
  std::vector<Ball<P::dimension, Real>> placed;
  double filled = 0;
  for (const auto& grain : drawn) {
    // The first numbers of each stream were used for the radii.
    Random random{.seed = scatter.seed, .id = placed.size(), .counter = std::uint64_t{1} << 32};
    const auto ball = placement.find(random, Real(grain.radius), scatter.tries, touches_wall);
    if (!ball) {
      fail({"dem::scatter: placed ", placed.size(), " of ", drawn.size(), " grains, ",
            filled / volume, " of the region, and found no free position for a grain of radius ",
            grain.radius, " m in ", scatter.tries,
            " tries; place fewer grains, or let grains fall and settle"});
    }
    placed.push_back(*ball);
    filled += volume_of<P::dimension>(grain.radius);
  }
  grains.reserve(grains.size() + placed.size());
  for (Index k = 0; k < placed.size(); ++k) add(placed[k].centre, drawn[k]);
}

/// scatter() with any source.
template <class P, DrawsGrains B, class R, class Walls, class Add>
void scatter_any(P& grains, const B& blend, const R& region, const Scatter& scatter,
                 const Walls& walls, Add&& add) {
  using Real = typename P::Real;
  blend.check();
  region.check();
  check_tries("dem::scatter", scatter.tries);
  const double volume = region.volume();
  if (scatter.solid_fraction) require_positive("dem::scatter: volume of the region", volume);
  check_bounds(Box<P::dimension, Real>(region.bounds()));
  const double expected = expected_number<P::dimension>(blend, scatter, volume);
  const auto fail_for_memory = [&] {
    fail({"dem::scatter: ", text_of(scatter, expected),
          " do not fit into memory; place fewer or larger grains"});
  };
  try {
    scatter_in(grains, blend, region, scatter, volume, walls, add);
  } catch (const std::bad_alloc&) {
    fail_for_memory();
  } catch (const std::length_error&) {
    fail_for_memory();
  }
}

}  // namespace detail

/// Adds grains at rest that lie entirely inside the region and touch neither each other nor
/// existing grains nor any of these walls, a WallSet, at time 0. If there is no free position for a
/// grain, throws silt::Error and adds none; the message contains the number of grains placed until
/// then. So it does if a position is beyond a side of the box that is not periodic, or if memory
/// does not suffice.
template <class P, class Sizes, Region<P::dimension, typename P::Real> R,
          class Walls = detail::NoWalls>
void scatter(P& grains, const Blend<Sizes>& blend, const R& region, const Scatter& scatter,
             const Walls& walls = {}) {
  detail::scatter_any(
      grains, blend, region, scatter, walls,
      [&](const typename P::Vec& x, const Grain& grain) { add_grain(grains, x, grain); });
}

/// The same with clumps of a ClumpBlend, whose bounding spheres do not touch, in random
/// orientations.
template <class P, class B, Region<P::dimension, typename P::Real> R, class Walls = detail::NoWalls>
  requires DrawsGrains<B>
void scatter(P& grains, Clumps<P::dimension>& clumps, const B& blend, const R& region,
             const Scatter& scatter, const Walls& walls = {}) {
  detail::scatter_any(grains, blend, region, scatter, walls,
                      [&](const typename P::Vec& x, const auto& drawn) {
                        blend.add(grains, clumps, x, drawn, typename P::Vec(P::Vec::Zero()));
                      });
}

}  // namespace silt::dem
