// SPDX-License-Identifier: MIT
// T-junctions: a vertex in the middle of another triangle's side, as some CAD programs write them.
//
//   +-------+           +-------+
//   |       +---        |  _.-' +---
//   |       |           |-'     |          the left triangle is split at the vertex of the others
//   +-------+---        +-------+---
//
// Without the split the triangles share no edge there, and a sphere would be disturbed at the seam.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/wall/mesh/bounding_volume_tree.hpp>
#include <silt/dem/wall/mesh/welded_mesh.hpp>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace silt::dem {

/// Splits triangles until no vertex of a boundary edge lies in the middle of another triangle's
/// side.
template <class Real>
void split_at_junctions(WeldedMesh<Real>& mesh) {
  using Vec = silt::Vec<3, Real>;
  using Ends = std::pair<std::uint32_t, std::uint32_t>;  // of a side; the lower one first
  using Tree = BoxTree<Real>;
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
    std::vector<typename Tree::Bounds> bounds;
    std::vector<std::uint32_t> ends;
    for (const auto& [side, count] : sides) {
      if (count != 1) continue;
      const Vec& a = mesh.vertices[side.first];
      const Vec& b = mesh.vertices[side.second];
      border.push_back(side);
      bounds.push_back({a.cwiseMin(b), a.cwiseMax(b)});
      ends.insert(ends.end(), {side.first, side.second});
    }
    std::ranges::sort(ends);
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
        std::ranges::sort(between);
        if (from > to) std::ranges::reverse(between);
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
