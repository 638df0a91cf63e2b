// SPDX-License-Identifier: MIT
// A wall of triangles. It touches a sphere at the local minima of the distance to the sphere's
// centre. On a flat facet this is a single point, however the facet is triangulated. At a convex
// edge or corner there is a single contact as well: an edge or corner is in contact only where it
// is nearer than the facets and edges that meet there.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/mesh/mesh_features.hpp>
#include <silt/dem/wall/mesh/mesh_repair.hpp>
#include <silt/dem/wall/wall.hpp>
#include <silt/geometry/bounding_volume_tree.hpp>
#include <silt/geometry/point_checksum.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

namespace silt::dem {

/// How a MeshWall is made of its triangles.
struct MeshSettings {
  std::uint32_t material = 0;  ///< index in dem::Materials
  double flat_angle = 1e-3;    ///< triangles at smaller angles form one facet [rad]
};

/// Two-sided wall. Its elements are its facets, then its lines, then its corners, in the order of
/// the triangles; each has its own contact history. Copies share the mesh.
template <class Real = double>
class MeshWall {
  using Vec = silt::Vec<3, Real>;
  using Nearest = NearestPoint<3, Real>;
  using Features = MeshFeatures<Real>;
  using Piece = typename Features::Piece;
  using Tree = BoxTree<3, Real>;

 public:
  std::uint32_t material;

  /// Throws if there is no triangle, or if a triangle has no area.
  explicit MeshWall(const std::vector<Triangle<Real>>& triangles, const MeshSettings& settings = {})
      : material(settings.material) {
    require_between("MeshSettings: flat_angle", settings.flat_angle, {0, 0.5});
    auto welded = weld(triangles);
    split_at_junctions(welded);
    mesh_ = std::make_shared<const Mesh>(welded, Real(settings.flat_angle));
  }
  void check() const noexcept {}

  std::uint64_t checksum() const {
    PointChecksum all;
    for (const Vec& vertex : mesh_->features.vertices) all.add<3, Real>(vertex);
    for (const Face& face : mesh_->features.faces) {
      for (const std::uint32_t vertex : face.vertices) all.add(vertex);
    }
    return all.sum();
  }

  /// Number of facets, which are its first elements.
  Index facets() const { return mesh_->features.facets.size(); }
  /// Number of lines, which are its elements behind the facets.
  Index lines() const { return mesh_->features.lines.size(); }
  /// Number of corners, which are its last elements.
  Index corners() const { return mesh_->features.corners.size(); }

  Index element_count() const { return facets() + lines() + corners(); }

  Nearest nearest(Index element, const Vec& x) const {
    if (element < facets()) return nearest_of_facet(element, x);
    element -= facets();
    return element < lines() ? nearest_of_line(element, x)
                             : nearest_of_corner(element - lines(), x);
  }

  template <class F>
  void for_each_element_near(const Vec& x, Real distance, F&& f) const {
    const auto& all = mesh_->features;
    std::vector<Index> near;
    mesh_->faces.visit_near(x, squared(distance), [&](std::uint32_t number) {
      const auto& face = all.faces[number];
      bool is_near = is_above(face, x) && std::abs(height(face, x)) < distance;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& edge = all.edges[face.edges[k]];
        if ((x - closest_point_on(edge, x)).norm() < distance) {
          is_near = true;
          if (edge.line != Features::none) near.push_back(facets() + edge.line);
        }
        const std::uint32_t v = face.vertices[k];
        if (all.corner_at[v] != Features::none && (x - all.vertices[v]).norm() < distance) {
          near.push_back(facets() + lines() + all.corner_at[v]);
        }
      }
      if (is_near) near.push_back(face.facet);
      return squared(distance);
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const Index element : near) f(element);
  }

 private:
  struct Mesh {
    Mesh(const WeldedMesh<Real>& mesh, Real flat) : features(mesh, flat) {
      std::vector<std::uint32_t> all(features.faces.size());
      std::iota(all.begin(), all.end(), std::uint32_t(0));
      faces = tree_of(all);
      for (const auto& facet : features.facets) {
        trees.push_back(facet.size() > few ? tree_of(facet) : Tree());
      }
    }
    Tree tree_of(const std::vector<std::uint32_t>& some) const {
      Buffer<typename Tree::Bounds> bounds;
      for (const std::uint32_t f : some) {
        const auto& [a, b, c] = features.faces[f].vertices;
        const auto& x = features.vertices;
        bounds.push_back({x[a].cwiseMin(x[b]).cwiseMin(x[c]), x[a].cwiseMax(x[b]).cwiseMax(x[c])});
      }
      return Tree(bounds);
    }
    static constexpr Index few = 8;

    Features features;
    Tree faces;
    std::vector<Tree> trees;  // for facets with more than a few faces
  };
  using Face = typename Features::Face;
  using Edge = typename Features::Edge;

  Real height(const Face& face, const Vec& x) const {
    return (x - mesh_->features.vertices[face.vertices[0]]).dot(face.normal);
  }

  // Signed distance of x from an edge, positive on the side of a face. Faces and lines test the
  // same number, so that exactly one of them is in contact.
  Real inside(const Edge& edge, const Vec& inwards, const Vec& x) const {
    return (x - mesh_->features.vertices[edge.from]).dot(inwards);
  }
  bool is_above(const Face& face, const Vec& x) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge& edge = mesh_->features.edges[face.edges[k]];
      const Real s = inside(edge, face.inwards[k], x);
      const bool is_within = edge.line == Features::none ? s >= 0 : s > 0;
      if (!is_within || is_straight_above_corner(face, k, x)) return false;
    }
    return true;
  }
  // For a face with a vertex on a line, but no edge on it there.
  bool is_straight_above_corner(const Face& face, std::size_t k, const Vec& x) const {
    const auto& all = mesh_->features;
    const std::uint32_t v = face.vertices[k];
    if (!all.is_on_line[v]) return false;
    for (const std::uint32_t e : {face.edges[k], face.edges[(k + 2) % 3]}) {
      const Piece piece{e, all.edges[e].to == v};
      if (all.edges[e].line != Features::none || beyond_begin(piece, x) > 0) return false;
    }
    return true;
  }

  Vec closest_point_on(const Edge& edge, const Vec& x) const {
    const Vec& from = mesh_->features.vertices[edge.from];
    return from + std::clamp<Real>((x - from).dot(edge.along), 0, edge.length) * edge.along;
  }

  // visit(face) for the faces of a facet that may be closer to x than the limit, a squared distance
  // [m²]. visit returns the limit for the remaining faces.
  template <class Visit>
  void visit_faces(Index facet, const Vec& x, Visit&& visit) const {
    const auto& all = mesh_->features;
    const auto& faces = all.facets[facet];
    if (faces.size() <= Mesh::few) {
      for (const std::uint32_t f : faces) visit(all.faces[f]);
    } else {
      mesh_->trees[facet].visit_near(
          x, std::numeric_limits<Real>::infinity(),
          [&](std::uint32_t number) { return visit(all.faces[faces[number]]); });
    }
  }

  Nearest nearest_of_facet(Index number, const Vec& x) const {
    Nearest nearest = no_nearest_point<3, Real>();
    Real limit = std::numeric_limits<Real>::infinity();
    visit_faces(number, x, [&](const Face& face) {
      if (is_above(face, x)) {
        const Real h = height(face, x);
        if (std::abs(h) < nearest.distance) {
          nearest = {h < 0 ? Vec(-face.normal) : face.normal, std::abs(h)};
        }
        limit = std::min(limit, squared(h));
      } else {
        limit = std::min(limit, (x - mesh_->features.vertices[face.vertices[0]]).squaredNorm());
      }
      return beyond_round_off(limit);
    });
    return std::isfinite(nearest.distance) ? nearest : nearest_where_faces_meet(number, x);
  }

  // If two faces of a facet are slightly tilted, x may project onto neither. The nearest point is
  // then on their common edge. More often, however, it is on a line of the facet's boundary, and
  // the facet has no contact.
  Nearest nearest_where_faces_meet(Index number, const Vec& x) const {
    const auto& all = mesh_->features;
    Real at_edge = std::numeric_limits<Real>::infinity();
    Real on_line = at_edge;
    Vec closest = x;
    visit_faces(number, x, [&](const Face& face) {
      for (const std::uint32_t e : face.edges) {
        const Edge& edge = all.edges[e];
        const Vec candidate = closest_point_on(edge, x);
        const Real distance = (x - candidate).squaredNorm();
        if (edge.line != Features::none) on_line = std::min(on_line, distance);
        for (const std::uint32_t v : {edge.from, edge.to}) {
          if (all.is_on_line[v]) on_line = std::min(on_line, (x - all.vertices[v]).squaredNorm());
        }
        if (distance < at_edge) {
          at_edge = distance;
          closest = candidate;
        }
      }
      return beyond_round_off(at_edge);
    });
    if (!(at_edge > 0) || on_line <= beyond_round_off(at_edge)) return no_nearest_point<3, Real>();
    return {(x - closest).normalized(), std::sqrt(at_edge)};
  }

  static Real beyond_round_off(Real squared_distance) {
    return squared_distance * (1 + 64 * std::numeric_limits<Real>::epsilon()) +
           std::numeric_limits<Real>::min();
  }

  Real beyond_begin(const Piece& piece, const Vec& x) const {
    const auto& all = mesh_->features;
    return (x - all.vertices[all.begin_of(piece)]).dot(all.along(piece));
  }

  Nearest nearest_of_line(Index number, const Vec& x) const {
    const auto& all = mesh_->features;
    const auto& line = all.lines[number];
    const Piece last{line.pieces.back().edge, !line.pieces.back().is_reversed};
    const Real along = beyond_begin(line.pieces.front(), x);
    if (!(along > 0 && beyond_begin(last, x) > 0)) return no_nearest_point<3, Real>();
    const auto behind = std::upper_bound(line.begins.begin() + 1, line.begins.end(), along);
    const Edge& edge =
        all.edges[line.pieces[static_cast<Index>(behind - line.begins.begin()) - 1].edge];
    Vec outwards = Vec::Zero();
    for (const auto& side : all.sides_of(edge)) {
      if (inside(edge, side.inwards, x) > 0) return no_nearest_point<3, Real>();
      outwards -= side.inwards;
    }
    return away_from(closest_point_on(edge, x), x, outwards);
  }

  Nearest nearest_of_corner(Index number, const Vec& x) const {
    const auto& all = mesh_->features;
    const std::uint32_t v = all.corners[number];
    Vec outwards = Vec::Zero();
    for (const Piece& piece : all.edges_at[v]) {
      if (beyond_begin(piece, x) > 0) return no_nearest_point<3, Real>();
      outwards -= all.along(piece);
    }
    return away_from(all.vertices[v], x, outwards);
  }

  // If x is the closest point itself, the normal is `outwards`.
  static Nearest away_from(const Vec& closest, const Vec& x, const Vec& outwards) {
    const Vec out = x - closest;
    const Real distance = out.norm();
    if (detail::has_direction(distance)) return {out / distance, distance};
    return {outwards.norm() > 0 ? Vec(outwards.normalized()) : Vec(Vec::Unit(2)), 0};
  }

  std::shared_ptr<const Mesh> mesh_;
};

}  // namespace silt::dem
