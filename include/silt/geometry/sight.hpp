// SPDX-License-Identifier: MIT
// Whether faces hide a point from another one.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/line_of_sight.hpp>

#include <algorithm>
#include <span>

namespace silt {

/// Whether the segment from p to q goes through a face.
template <int Dim>
bool hides(const Face<Dim>& face, const Vec<Dim>& p, const Vec<Dim>& q) {
  const Vec<Dim> normal = normal_of(face);
  const bool is_above = normal.dot(p - face.corners[0]) > 0;
  if (is_above == (normal.dot(q - face.corners[0]) > 0)) return false;
  return detail::is_crossed(face, p, q);
}

/// Whether none of the faces is between p and q.
template <int Dim>
bool sees(std::span<const Face<Dim>> faces, const Vec<Dim>& p, const Vec<Dim>& q) {
  return std::none_of(faces.begin(), faces.end(),
                      [&](const Face<Dim>& face) { return hides(face, p, q); });
}

}  // namespace silt
