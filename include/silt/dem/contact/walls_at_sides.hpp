// SPDX-License-Identifier: MIT
// Walls in a periodic box. They are not repeated beyond its sides: a wall continues across a side,
// or is out of reach of the grains at the opposite one.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <cmath>

namespace silt::dem::detail {

/// An element closer than `reach` [m] to an image of x beyond a periodic side, at a point that is
/// on no wall at x's side; `no_index` if there is none. The walls may have a kink at the side, so
/// that they are not exactly the same. `walls` is a WallsAtTime.
template <class Walls, int Dim, class Real>
Index element_beyond_sides(const Walls& walls, const Box<Dim, Real>& box, const Vec<Dim, Real>& x,
                           Real reach) {
  const Real tolerance = Real(0.05) * reach;
  const auto is_on_a_wall = [&](const Vec<Dim, Real>& point) {
    bool is_on = false;
    walls.for_each_element_near(point, tolerance, [&](Index element) {
      is_on = is_on || std::abs(walls.nearest(element, point).distance) < tolerance;
    });
    return is_on;
  };
  Index found = no_index;
  for_each_image(box, x, reach, [&](const Vec<Dim, Real>& image) {
    if (image == x || found != no_index) return;
    walls.for_each_element_near(image, reach, [&](Index element) {
      const auto at = walls.nearest(element, image);
      if (found != no_index || !(at.distance < reach)) return;
      if (!is_on_a_wall(x - at.distance * at.normal)) found = element;
    });
  });
  return found;
}

/// Throws if a grain from `first` on, moved by up to `margin` [m], may touch a wall only across a
/// periodic side.
template <class P, class Walls>
void check_walls_at_sides(const P& grains, const Walls& walls, typename P::Real margin,
                          Index first = 0) {
  const auto& box = grains.box();
  if (!box.any_periodic()) return;
  const auto x = grains[position];
  const auto R = grains[radius];
  const auto element_near = [&](Index i) {
    return element_beyond_sides(walls, box, typename P::Vec(x[i]), R[i] + margin);
  };
  const Index odd = first_where(grains.size() - first,
                                [&](Index k) { return element_near(first + k) != no_index; });
  if (odd == no_index) return;
  const Index i = first + odd;
  fail({"dem::Contacts: wall ", walls.number_of(element_near(i)),
        " breaks off at a periodic side: a grain at x = ", to_text(typename P::Vec(x[i])),
        " m is closer to its image than ", R[i] + margin,
        " m; continue the wall beyond the side by this length, or move it away"},
       {.particle = i, .id = grains.id(i)});
}

}  // namespace silt::dem::detail
