// SPDX-License-Identifier: MIT
// How velocities are mirrored in planes that move.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/geometry/mirrors.hpp>

#include <cstdint>
#include <span>

namespace silt {

/// Whether points slip along the surfaces of a mirror or stick to them.
enum class AlongMirror : std::uint8_t { slip, stick };

/// M of MirrorRate, times a velocity [m/s].
template <int Dim>
Vec<Dim> mirrored(const Mirror<Dim>& mirror, AlongMirror along, const Vec<Dim>& v) {
  if (along == AlongMirror::slip) return multiply<Dim, double>(mirror.rotation, v);
  return mirror.is_reflection() ? Vec<Dim>(-v) : v;
}
/// Of one surface, whose points x move with field.at(x), which is linear in x.
template <int Dim, class Velocity>
MirrorRate<Dim> rate_in(const Mirror<Dim>& mirror, AlongMirror along, const Velocity& field) {
  // Relative to the surface, velocities are mirrored as at rest: V(x') + M (u − V(x)).
  const auto at = [&](const Vec<Dim>& x) -> Vec<Dim> {
    return field.at(mirror(x)) - mirrored<Dim>(mirror, along, field.at(x));
  };
  MirrorRate<Dim> rate;
  rate.at_origin = at(Vec<Dim>::Zero());
  for (int k = 0; k < Dim; ++k) rate.of_position.col(k) = at(Vec<Dim>::Unit(k)) - rate.at_origin;
  return rate;
}
/// Of the mirror last.after(first).
template <int Dim>
MirrorRate<Dim> rate_of(const Mirror<Dim>& last, const MirrorRate<Dim>& rate_of_last,
                        const Mirror<Dim>& first, const MirrorRate<Dim>& rate_of_first,
                        AlongMirror along) {
  const auto at = [&](const Vec<Dim>& x) -> Vec<Dim> {
    return rate_of_last.at(first(x)) + mirrored<Dim>(last, along, rate_of_first.at(x));
  };
  MirrorRate<Dim> rate;
  rate.at_origin = at(Vec<Dim>::Zero());
  for (int k = 0; k < Dim; ++k) rate.of_position.col(k) = at(Vec<Dim>::Unit(k)) - rate.at_origin;
  return rate;
}

/// Of the mirror that consists of these planes, in the order in which a point is mirrored in them; the
/// points of a group of faces move with field_of(group).at(x), which is linear in x.
template <int Dim, class FieldOf>
MirrorRate<Dim> rate_of(std::span<const PlaneOfMirror<Dim>> planes, AlongMirror along,
                        FieldOf&& field_of) {
  Mirror<Dim> mirror;
  MirrorRate<Dim> rate;
  for (const PlaneOfMirror<Dim>& plane : planes) {
    const Mirror<Dim> next = mirror_in<Dim>(plane.normal, plane.offset);
    const MirrorRate<Dim> in_next =
        plane.group > 0 ? rate_in<Dim>(next, along, field_of(plane.group)) : MirrorRate<Dim>{};
    rate = rate_of<Dim>(next, in_next, mirror, rate, along);
    mirror = next.after(mirror);
  }
  return rate;
}

}  // namespace silt
