// SPDX-License-Identifier: MIT
// Mass and moment of inertia of a rigid body.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

namespace silt {

/// The moment of inertia about the centre of mass [kg m²], in 2D [kg m² per m of depth].
template <int Dim>
struct InertiaOf {
  using type = Eigen::Matrix<double, 3, 3>;
};
template <>
struct InertiaOf<2> {
  using type = double;
};
/// About the centre of mass: a matrix in 3D, a number in 2D.
template <int Dim>
using Inertia = typename InertiaOf<Dim>::type;

/// Mass and moment of inertia of a body where it is defined.
template <int Dim>
struct MassProperties {
  double mass = 0;                                 ///< [kg], in 2D per metre of depth
  Vec<Dim> centre = Vec<Dim>::Zero();              ///< of mass [m]
  Inertia<Dim> inertia = zero_of<Inertia<Dim>>();  ///< about the centre
};

/// Row by row.
template <class InertiaType>
std::string inertia_to_text(const InertiaType& theta) {
  if constexpr (std::is_same_v<InertiaType, double>) {
    return to_text(theta);
  } else {
    return to_text(Vec<3>(theta.row(0))) + " " + to_text(Vec<3>(theta.row(1))) + " " +
           to_text(Vec<3>(theta.row(2)));
  }
}

/// Whether it may be that of a body of some size [kg m²].
template <class InertiaType>
bool is_inertia(const InertiaType& theta) {
  if constexpr (std::is_same_v<InertiaType, double>) {
    return theta > 0 && is_finite(theta);
  } else {
    return theta.allFinite() && theta.isApprox(theta.transpose()) && theta(0, 0) > 0 &&
           theta.template topLeftCorner<2, 2>().determinant() > 0 && theta.determinant() > 0;
  }
}

/// Throws if mass, centre or moment of inertia is not possible; `name` identifies them.
template <int Dim>
void require_valid(const std::string& name, const MassProperties<Dim>& body) {
  require_positive((name + ": mass_properties: mass").c_str(), body.mass);
  require_finite((name + ": mass_properties: centre").c_str(), body.centre);
  if (is_inertia(body.inertia)) return;
  fail({name, ": mass_properties: inertia = ", inertia_to_text(body.inertia),
        " kg m² must be finite and ",
        Dim == 2 ? "above 0" : "symmetric, with a positive one about each axis",
        "; give it about the centre of mass"});
}

/// Those of a homogeneous body [kg/m³] from its volume and the moments ∫x dV and ∫x xᵀ dV of the
/// vector x from `origin` [m].
template <int Dim>
MassProperties<Dim> homogeneous(const Vec<Dim>& origin, double density, double volume,
                                const Vec<Dim>& first, Eigen::Matrix<double, Dim, Dim> second) {
  MassProperties<Dim> body;
  body.mass = density * volume;
  const Vec<Dim> centre = first / volume;
  body.centre = origin + centre;
  second = density * (second - volume * (centre * centre.transpose()));
  if constexpr (Dim == 2) {
    body.inertia = second.trace();
  } else {
    body.inertia = second.trace() * Eigen::Matrix<double, 3, 3>::Identity() - second;
  }
  return body;
}

/// Those of a homogeneous body [kg/m³] inside closed faces, whose normals are all outwards or all
/// inwards. Throws if the faces are not closed or have no volume; `name` identifies them.
template <int Dim>
MassProperties<Dim> mass_properties_of(const std::string& name, const std::vector<Face<Dim>>& faces,
                                       double density) {
  using Corner = std::array<double, std::size_t(Dim)>;
  using Edge = std::array<Corner, std::size_t(Dim) - 1>;
  const auto coordinates = [](const Vec<Dim>& x) {
    Corner corner;
    for (int k = 0; k < Dim; ++k) corner[std::size_t(k)] = x[k] + 0.0;  // no −0
    return corner;
  };
  // Each edge (in 2D, each end) belongs to two faces, which pass it in opposite directions.
  std::map<Edge, int> edges;
  for (const Face<Dim>& face : faces) {
    if constexpr (Dim == 2) {
      ++edges[{coordinates(face.corners[0])}];
      --edges[{coordinates(face.corners[1])}];
    } else {
      for (std::size_t k = 0; k < 3; ++k) {
        const Corner a = coordinates(face.corners[k]), b = coordinates(face.corners[(k + 1) % 3]);
        if (a < b) ++edges[{a, b}];
        if (b < a) --edges[{b, a}];
      }
    }
  }
  for (const auto& [edge, sum] : edges) {
    if (sum == 0) continue;
    Vec<Dim> x;
    for (int k = 0; k < Dim; ++k) x[k] = edge[0][std::size_t(k)];
    fail({name, ": the faces are not closed at ", to_text(x),
          " m; give a closed surface with all normals outwards"});
  }
  // Sums over the simplices from the first corner to each face: the moments of volume 0, 1 and 2.
  const Vec<Dim> origin = faces.empty() ? Vec<Dim>(Vec<Dim>::Zero()) : faces[0].corners[0];
  double volume = 0;
  Vec<Dim> first = Vec<Dim>::Zero();
  Eigen::Matrix<double, Dim, Dim> second = Eigen::Matrix<double, Dim, Dim>::Zero();
  for (const Face<Dim>& face : faces) {
    Eigen::Matrix<double, Dim, Dim> corners;
    for (int k = 0; k < Dim; ++k) corners.col(k) = face.corners[std::size_t(k)] - origin;
    const double part = corners.determinant() / (Dim == 2 ? 2 : 6);
    const Vec<Dim> sum = corners.rowwise().sum();
    volume += part;
    first += part / (Dim + 1) * sum;
    const double weight = part / ((Dim + 1) * (Dim + 2));
    second += weight * (corners * corners.transpose() + sum * sum.transpose());
  }
  if (!(std::abs(volume) > 0) || !is_finite(volume)) {
    fail({name, ": the faces enclose no volume; give a closed surface"});
  }
  const double sign = volume > 0 ? 1 : -1;
  return homogeneous(origin, density * sign, volume, first, second);
}

}  // namespace silt
