// SPDX-License-Identifier: MIT
// Checks of a floating body, as a user describes it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/mps/wall/floating_body.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>

namespace silt::mps::detail {

/// How far the faces of a disc or a sphere are from its radius, at most [m]. Throws if they are
/// those of another shape; its volume and the centre of that are in [m³] and [m], where the faces
/// are defined.
template <int Dim>
double deviation_of_round(const std::string& name, const FloatingBody<Dim>& body, double volume,
                          const Vec<Dim>& centre) {
  require_positive((name + ": radius").c_str(), body.radius);
  const double of_volume = Dim == 2 ? std::sqrt(volume / std::numbers::pi)
                                    : std::cbrt(3 * volume / (4 * std::numbers::pi));
  if (!(std::abs(of_volume - body.radius) <= 0.01 * body.radius)) {
    fail({name, ": radius = ", body.radius, " m, but its faces have the volume of a ",
          Dim == 2 ? "disc" : "sphere", " of a radius of ", of_volume, " m; give the same to ",
          Dim == 2 ? "faces_of_disc()" : "faces_of_sphere()"});
  }
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const Face<Dim>& face : body.faces) {
    least = std::min(least, (nearest_of(face, centre) - centre).norm());
    for (const Vec<Dim>& corner : face.corners) most = std::max(most, (corner - centre).norm());
  }
  const double deviation = std::max(most - body.radius, body.radius - least);
  if (deviation <= 0.1 * body.radius) return deviation;
  fail({name, ": radius = ", body.radius, " m, but its faces are between ", least, " m and ", most,
        " m away from the centre of its volume; give those of ",
        Dim == 2 ? "faces_of_disc()" : "faces_of_sphere()", " with this radius, or no radius"});
}

}  // namespace silt::mps::detail
