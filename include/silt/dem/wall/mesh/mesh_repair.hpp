// SPDX-License-Identifier: MIT
// Connects separate triangles, as read from a file, to a surface with shared vertices, and splits
// those with a T-junction: a vertex in the middle of another triangle's side, as some CAD programs
// write them.
//
//   +-------+           +-------+
//   |       +---        |  _.-' +---
//   |       |           |-'     |          the left triangle is split at the vertex of the others
//   +-------+---        +-------+---
//
// Without the split the triangles share no edge there, and a sphere would be disturbed at the seam.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/bounding_volume_tree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

/// Triangles with shared vertices.
template <class Real>
struct WeldedMesh {
  /// Indices of the three vertices of a triangle.
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
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) {
      fail({"MeshWall: triangle ", t, " at ", to_text(triangles[t].corners[0]),
            " m is too small compared with the mesh: two of its corners coincide in single "
            "precision; remove it, or move the mesh to the origin"});
    }
    if (known.insert(sorted).second) mesh.triangles.push_back(corners);
  }
  return mesh;
}

/// Splits triangles until no vertex of a boundary edge lies in the middle of another triangle's
/// side.
template <class Real>
void split_at_junctions(WeldedMesh<Real>& mesh) {
  using Vec = silt::Vec<3, Real>;
  using Ends = std::pair<std::uint32_t, std::uint32_t>;  // of a side; the lower one first
  using Tree = BoxTree<3, Real>;
  const auto side_of = [&](Index t, std::size_t k) {
    return Ends(std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]));
  };
  for (bool splits = true; splits;) {
    splits = false;
    std::map<Ends, int> sides;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) ++sides[side_of(t, k)];
    }
    std::vector<Ends> border;
    Buffer<typename Tree::Bounds> bounds;
    std::vector<std::uint32_t> ends;
    for (const auto& [side, count] : sides) {
      if (count != 1) continue;
      const Vec& a = mesh.vertices[side.first];
      const Vec& b = mesh.vertices[side.second];
      border.push_back(side);
      bounds.push_back({a.cwiseMin(b), a.cwiseMax(b)});
      ends.insert(ends.end(), {side.first, side.second});
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());

    // Vertices on each boundary side, with their positions along it.
    std::map<Ends, std::vector<std::pair<Real, std::uint32_t>>> on;
    const Tree tree(bounds);
    const Real limit = squared(2 * mesh.distance);
    for (const std::uint32_t v : ends) {
      tree.visit_near(mesh.vertices[v], limit, [&](std::uint32_t number) {
        const Vec& a = mesh.vertices[border[number].first];
        const Vec along = mesh.vertices[border[number].second] - a;
        const Real t = (mesh.vertices[v] - a).dot(along) / along.norm();
        const Vec closest = a + t * along.normalized();
        if (t > mesh.distance && along.norm() - t > mesh.distance &&
            (mesh.vertices[v] - closest).norm() <= mesh.distance) {
          on[border[number]].emplace_back(t, v);
        }
        return limit;
      });
    }
    const Index before = mesh.triangles.size();
    for (Index t = 0; t < before; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = on.find(side_of(t, k));
        if (found == on.end()) continue;
        const auto corners = mesh.triangles[t];
        const std::uint32_t from = corners[k];
        const std::uint32_t to = corners[(k + 1) % 3];
        const std::uint32_t apex = corners[(k + 2) % 3];
        auto& between = found->second;
        std::sort(between.begin(), between.end());
        if (from > to) std::reverse(between.begin(), between.end());
        mesh.triangles[t] = {from, between.front().second, apex};
        for (Index n = 0; n < between.size(); ++n) {
          const std::uint32_t next = n + 1 < between.size() ? between[n + 1].second : to;
          mesh.triangles.push_back({between[n].second, next, apex});
        }
        splits = true;
        break;  // its other sides are treated in the next pass
      }
    }
  }
}

}  // namespace silt::dem
