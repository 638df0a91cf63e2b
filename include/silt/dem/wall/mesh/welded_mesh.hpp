// SPDX-License-Identifier: MIT
// Connects separate triangles, as read from a file, to a surface with shared vertices.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace silt::dem {

/// Triangles with shared vertices.
template <class Real>
struct WeldedMesh {
  using Corners = std::array<std::uint32_t, 3>;
  std::vector<Vec<3, Real>> vertices;  ///< [m]
  std::vector<Corners> triangles;      ///< indices of the vertices; no duplicates
  Real distance = 0;                   ///< points within this distance were merged [m]
};

namespace detail {
/// Numbers points; points within a distance get the same number.
template <class Real>
class Welder {
 public:
  Welder(Real distance, std::vector<Vec<3, Real>>& points) : distance_(distance), points_(points) {}

  std::uint32_t number_of(const Vec<3, Real>& x) {
    // The neighbourhood of the point overlaps up to eight cells, but usually only one.
    std::set<Cell> asked;
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec<3, Real> at = x;
      for (int k = 0; k < 3; ++k) at[k] += (corner >> k & 1) != 0 ? distance_ : -distance_;
      if (!asked.insert(cell_of(at)).second) continue;
      const auto found = cells_.find(cell_of(at));
      if (found == cells_.end()) continue;
      for (const std::uint32_t number : found->second) {
        if ((points_[number] - x).norm() <= distance_) return number;
      }
    }
    points_.push_back(x);
    const auto number = static_cast<std::uint32_t>(points_.size() - 1);
    cells_[cell_of(x)].push_back(number);
    return number;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Vec<3, Real>& x) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) {
      cell[static_cast<std::size_t>(k)] =
          static_cast<std::int64_t>(std::floor(double(x[k]) / (8 * double(distance_))));
    }
    return cell;
  }

  Real distance_;
  std::vector<Vec<3, Real>>& points_;
  std::map<Cell, std::vector<std::uint32_t>> cells_;
};
}  // namespace detail

/// Merges corners that single precision cannot distinguish, and drops duplicate triangles. Throws
/// if there is no triangle, or if a triangle has no area.
template <class Real>
WeldedMesh<Real> weld(const std::vector<Triangle<Real>>& triangles) {
  if (triangles.empty()) fail("MeshWall: there are no triangles; give at least one");
  Real farthest = 0;
  for (Index t = 0; t < triangles.size(); ++t) {
    require_area("MeshWall: triangle " + std::to_string(t), triangles[t]);
    for (const auto& x : triangles[t].corners) {
      farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
    }
  }
  WeldedMesh<Real> mesh{.vertices = {}, .triangles = {}, .distance = farthest * Real(4e-7)};
  detail::Welder<Real> welder(mesh.distance, mesh.vertices);
  std::set<std::array<std::uint32_t, 3>> known;
  for (Index t = 0; t < triangles.size(); ++t) {
    std::array<std::uint32_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = welder.number_of(triangles[t].corners[k]);
    auto sorted = corners;
    std::ranges::sort(sorted);
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) {
      fail("MeshWall: triangle " + std::to_string(t) + " at " + to_text(triangles[t].corners[0]) +
           " m is too small compared with the mesh: two of its corners coincide in single "
           "precision; remove it, or move the mesh to the origin");
    }
    if (known.insert(sorted).second) mesh.triangles.push_back(corners);
  }
  return mesh;
}

}  // namespace silt::dem
