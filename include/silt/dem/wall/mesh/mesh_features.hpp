// SPDX-License-Identifier: MIT
// The geometric features of a triangle mesh: flat facets of one or more triangles, straight lines
// where facets meet or end, and corners where lines meet or end.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/wall/mesh/mesh_repair.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace silt::dem {

/// The features of a welded mesh. Faces, edges, facets, lines and corners have numbers, from 0.
template <class Real>
struct MeshFeatures {
  using Vec = silt::Vec<3, Real>;
  static constexpr std::uint32_t none = ~std::uint32_t(0);  ///< in place of a number

  /// Between two vertices, `from` and `to`.
  struct Edge {
    std::uint32_t from;
    std::uint32_t to;
    Vec along;                  ///< unit vector, from → to [-]
    Real length;                ///< [m]
    std::uint32_t first_side;   ///< index of its first side
    std::uint32_t last_side;    ///< one past its last side
    std::uint32_t line = none;  ///< the line it belongs to; none: inside a facet
  };
  /// A face at an edge.
  struct EdgeSide {
    Vec inwards;  ///< unit vector from the edge into the face [-]
    std::uint32_t face;
  };
  /// A triangle of the mesh: its `vertices`, and the `facet` that it is part of.
  struct Face {
    std::array<std::uint32_t, 3> vertices;
    std::array<std::uint32_t, 3> edges{};  ///< from each vertex to the next
    std::array<Vec, 3> inwards;            ///< unit vectors from these edges into the face
    Vec normal;  ///< unit vector [-], by the right-hand rule from the vertices
    std::uint32_t facet = none;
  };
  /// An edge with a direction: from → to, unless it `is_reversed`.
  struct Piece {
    std::uint32_t edge;
    bool is_reversed;
  };
  /// A straight line of edges: its `pieces`, one behind the other.
  struct Line {
    std::vector<Piece> pieces;
    std::vector<Real> begins;  ///< position along the line where each begins [m]
  };

  std::vector<Vec> vertices;  ///< [m]
  std::vector<Face> faces;    ///< of the mesh, in the order of its triangles
  std::vector<Edge> edges;    ///< each once
  std::vector<EdgeSide> sides;                     ///< in the order of the edges
  std::vector<std::vector<std::uint32_t>> facets;  ///< the faces of each facet
  std::vector<Line> lines;                         ///< where facets meet or end
  std::vector<std::uint32_t> corners;        ///< vertex of each corner
  std::vector<std::uint32_t> corner_at;      ///< corner at each vertex, or none
  std::vector<std::vector<Piece>> edges_at;  ///< edges at each vertex, directed away from it
  std::vector<char> is_on_line;              ///< for each vertex

  /// Adjacent faces at an angle below `flat` [rad] are merged into facets, and edges into lines.
  MeshFeatures(const WeldedMesh<Real>& mesh, Real flat) : vertices(mesh.vertices) {
    for (const auto& triangle : mesh.triangles) add_face(triangle);
    find_edges();
    find_facets(flat);
    find_lines(flat);
    find_corners();
  }

  /// The faces that meet at an edge.
  std::span<const EdgeSide> sides_of(const Edge& edge) const {
    return std::span(sides).subspan(edge.first_side, edge.last_side - edge.first_side);
  }
  /// Unit vector in the direction of the piece [-].
  Vec along(const Piece& piece) const {
    return piece.is_reversed ? Vec(-edges[piece.edge].along) : edges[piece.edge].along;
  }
  /// The vertex at which the piece begins.
  std::uint32_t begin_of(const Piece& piece) const {
    return piece.is_reversed ? edges[piece.edge].to : edges[piece.edge].from;
  }
  /// The vertex at which the piece ends.
  std::uint32_t end_of(const Piece& piece) const {
    return piece.is_reversed ? edges[piece.edge].from : edges[piece.edge].to;
  }

 private:
  void add_face(const std::array<std::uint32_t, 3>& triangle) {
    const Vec& a = vertices[triangle[0]];
    const Vec n = cross(Vec(vertices[triangle[1]] - a), Vec(vertices[triangle[2]] - a));
    faces.push_back({.vertices = triangle, .inwards = {}, .normal = n.normalized()});
  }

  void find_edges() {
    using Found = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::size_t>;
    std::vector<Found> all;  // lower vertex, higher vertex, face, index in the face
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto ends = std::minmax(faces[f].vertices[k], faces[f].vertices[(k + 1) % 3]);
        all.emplace_back(ends.first, ends.second, f, k);
      }
    }
    std::sort(all.begin(), all.end());
    for (const auto& [from, to, f, k] : all) {
      if (edges.empty() || edges.back().from != from || edges.back().to != to) {
        const Vec difference = vertices[to] - vertices[from];
        const auto side = static_cast<std::uint32_t>(sides.size());
        edges.push_back({from, to, difference.normalized(), difference.norm(), side, side});
      }
      Edge& edge = edges.back();
      const Vec across = vertices[faces[f].vertices[(k + 2) % 3]] - vertices[from];
      faces[f].edges[k] = static_cast<std::uint32_t>(edges.size() - 1);
      faces[f].inwards[k] = (across - across.dot(edge.along) * edge.along).normalized();
      sides.push_back({faces[f].inwards[k], f});
      ++edge.last_side;
    }
  }

  // The facet continues beyond the edge.
  bool is_flat(const Edge& edge, Real flat) const {
    const auto both = sides_of(edge);
    return both.size() == 2 && (both[0].inwards + both[1].inwards).norm() < flat;
  }

  void find_facets(Real flat) {
    for (std::uint32_t first = 0; first < faces.size(); ++first) {
      if (faces[first].facet != none) continue;
      const auto number = static_cast<std::uint32_t>(facets.size());
      std::vector<std::uint32_t> facet{first};
      faces[first].facet = number;
      for (Index k = 0; k < facet.size(); ++k) {
        for (const std::uint32_t e : faces[facet[k]].edges) {
          if (!is_flat(edges[e], flat)) continue;
          for (const auto& [inwards, other] : sides_of(edges[e])) {
            // Compare with the first face: many small angles must not add up to a curved facet.
            if (faces[other].facet != none ||
                cross(faces[other].normal, faces[first].normal).norm() > flat) {
              continue;
            }
            faces[other].facet = number;
            facet.push_back(other);
          }
        }
      }
      std::sort(facet.begin(), facet.end());
      facets.push_back(std::move(facet));
    }
  }

  bool is_within_a_facet(const Edge& edge, Real flat) const {
    const auto both = sides_of(edge);
    return is_flat(edge, flat) && faces[both[0].face].facet == faces[both[1].face].facet;
  }

  void find_lines(Real flat) {
    edges_at.resize(vertices.size());
    is_on_line.assign(vertices.size(), false);
    std::vector<std::vector<Piece>> creases(vertices.size());
    std::vector<char> is_free(edges.size(), false);
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      const bool is_crease = !is_within_a_facet(edges[e], flat);
      is_free[e] = is_crease;
      for (const bool is_reversed : {false, true}) {
        const std::uint32_t v = begin_of({e, is_reversed});
        edges_at[v].push_back({e, is_reversed});
        if (is_crease) {
          creases[v].push_back({e, is_reversed});
          is_on_line[v] = true;
        }
      }
    }
    // The next piece of a line, if it has the direction of the line's first piece.
    const auto next_of = [&](const Piece& piece, const Vec& direction) {
      const auto& at = creases[end_of(piece)];
      if (at.size() != 2) return Piece{none, false};
      const Piece next = at[0].edge == piece.edge ? at[1] : at[0];
      const bool goes_on = is_free[next.edge] && (along(next) - direction).norm() < flat;
      return goes_on ? next : Piece{none, false};
    };
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      if (!is_free[e]) continue;
      Piece first{e, true};  // follow the line backwards to its beginning
      is_free[e] = false;
      const Vec back = along(first);
      std::vector<Piece> behind{first};
      for (Piece next = next_of(first, back); next.edge != none; next = next_of(next, back)) {
        is_free[next.edge] = false;
        behind.push_back(next);
      }
      Line line;
      for (Index k = behind.size(); k-- > 0;) {
        line.pieces.push_back({behind[k].edge, !behind[k].is_reversed});
      }
      const Piece own{e, false};
      for (Piece next = next_of(own, along(own)); next.edge != none;
           next = next_of(next, along(own))) {
        is_free[next.edge] = false;
        line.pieces.push_back(next);
      }
      Real begin = 0;
      for (const Piece& piece : line.pieces) {
        line.begins.push_back(begin);
        begin += edges[piece.edge].length;
        edges[piece.edge].line = static_cast<std::uint32_t>(lines.size());
      }
      lines.push_back(std::move(line));
    }
  }

  void find_corners() {
    corner_at.assign(vertices.size(), none);
    for (const Line& line : lines) {
      for (const std::uint32_t v : {begin_of(line.pieces.front()), end_of(line.pieces.back())}) {
        if (corner_at[v] != none) continue;
        corner_at[v] = static_cast<std::uint32_t>(corners.size());
        corners.push_back(v);
      }
    }
  }
};

}  // namespace silt::dem
