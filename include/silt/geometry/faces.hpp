// SPDX-License-Identifier: MIT
// A surface of faces, and a grid that finds those near a point.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace silt {

/// Faces that may form closed or open surfaces, with normals; a face that is given twice counts
/// once. Faces with a common edge (in 2D a common end) and the same plane (line) form one facet. Its
/// rim are the edges (ends) at which it ends.
template <int Dim>
class Faces {
 public:
  using Vec = silt::Vec<Dim>;

  struct Element {
    Face<Dim> face;
    std::size_t number;  ///< among those given
    Vec normal;
    double offset;       ///< normal·x of the points x of its plane [m]
    std::uint32_t facet;  ///< the number of its facet
    /// Whether the edge from corner k to the next one (in 2D, the end k) is on the facet's rim.
    std::array<bool, std::size_t(Dim)> is_rim;

    /// Signed distance of x from the plane [m].
    double height(const Vec& x) const { return normal.dot(x) - offset; }
    /// Distance of x from the part of the facet's rim that belongs to the face [m]; infinite if
    /// there is none.
    double distance_from_rim(const Vec& x) const {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
        if (!is_rim[k]) continue;
        const Vec& a = face.corners[k];
        const Vec& b = face.corners[Dim == 2 ? k : (k + 1) % std::size_t(Dim)];
        const Vec nearest = Dim == 2 ? a : nearest_of_segment<Dim>(a, b, x);
        least = std::min(least, (x - nearest).norm());
      }
      return least;
    }
  };

  Faces() = default;
  /// `reach` [m] is the greatest distance at which faces are asked for, above 0. Throws if a face
  /// is invalid, see require_size(), or larger than 1e8 cells of that size; `name` identifies the
  /// surface.
  Faces(const std::string& name, const std::vector<Face<Dim>>& faces, double reach)
      : cell_(reach) {
    elements_.reserve(faces.size());
    std::set<Corners<std::size_t(Dim)>> known;
    for (std::size_t k = 0; k < faces.size(); ++k) {
      require_size(name + ": face " + std::to_string(k), faces[k]);
      if (!known.insert(sorted(faces[k].corners)).second) continue;
      const Vec normal = normal_of(faces[k]);
      Element element{faces[k], k, normal, normal.dot(faces[k].corners[0]),
                      std::uint32_t(elements_.size()), {}};
      element.is_rim.fill(true);
      elements_.push_back(element);
    }
    join_facets();
    fill_cells(name);
  }

  std::span<const Element> elements() const { return elements_; }
  const Element& operator[](std::uint32_t element) const { return elements_[element]; }

  /// The numbers of all faces closer to x than the reach, and of some further ones.
  std::span<const std::uint32_t> near(const Vec& x) const {
    const auto found = cells_.find(cell_of(x));
    if (found == cells_.end()) return {};
    return found->second;
  }

 private:
  using Cell = std::array<std::int64_t, std::size_t(Dim)>;
  struct HashOfCell {
    std::size_t operator()(const Cell& cell) const noexcept {
      std::uint64_t hash = 0;
      for (const std::int64_t k : cell) hash = (hash ^ std::uint64_t(k)) * 0x9E3779B97F4A7C15u;
      return std::size_t(hash ^ hash >> 32);
    }
  };

  // A side of a face: the edge from corner k to the next one (in 2D, the end k).
  struct SideOfFace {
    std::uint32_t element;
    std::size_t k;
  };
  // In an order that does not depend on which is given first.
  template <std::size_t n>
  using Corners = std::array<std::array<double, std::size_t(Dim)>, n>;
  using Edge = Corners<std::size_t(Dim) - 1>;

  template <std::size_t n>
  static Corners<n> sorted(const std::array<Vec, n>& corners) {
    Corners<n> result;
    for (std::size_t k = 0; k < n; ++k) {
      for (int axis = 0; axis < Dim; ++axis) {
        result[k][std::size_t(axis)] = corners[k][axis] + 0.0;  // no −0
      }
    }
    std::ranges::sort(result);
    return result;
  }
  Edge edge_of(const SideOfFace& side) const {
    std::array<Vec, std::size_t(Dim) - 1> ends;
    for (std::size_t end = 0; end < ends.size(); ++end) {
      ends[end] = elements_[side.element].face.corners[(side.k + end) % std::size_t(Dim)];
    }
    return sorted(ends);
  }
  // From a point of the edge to the opposite corner (in 2D, to the other end).
  Vec inwards(const SideOfFace& side, const Vec& from) const {
    const auto& corners = elements_[side.element].face.corners;
    return corners[(side.k + std::size_t(Dim) - 1) % std::size_t(Dim)] - from;
  }

  // A facet is the faces connected with its first one in the plane of that one.
  void join_facets() {
    std::map<Edge, std::vector<SideOfFace>> edges;
    for (std::uint32_t e = 0; e < elements_.size(); ++e) {
      for (std::size_t k = 0; k < std::size_t(Dim); ++k) edges[edge_of({e, k})].push_back({e, k});
    }
    std::vector<bool> has_facet(elements_.size(), false);
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t first = 0; first < elements_.size(); ++first) {
      if (has_facet[first]) continue;
      has_facet[first] = true;
      waiting.assign(1, first);
      while (!waiting.empty()) {
        const std::uint32_t e = waiting.back();
        waiting.pop_back();
        for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
          for (const SideOfFace& other : edges[edge_of({e, k})]) {
            if (has_facet[other.element] || !continues({e, k}, other, elements_[first])) continue;
            has_facet[other.element] = true;
            take_plane(elements_[other.element], elements_[first]);
            waiting.push_back(other.element);
          }
        }
      }
    }
    for (const auto& [edge, sides] : edges) {
      for (const SideOfFace& one : sides) {
        for (const SideOfFace& other : sides) {
          if (elements_[one.element].facet == elements_[other.element].facet &&
              are_opposite(one, other)) {
            elements_[one.element].is_rim[one.k] = false;
          }
        }
      }
    }
  }
  // Whether a face lies beyond the edge of another one, in the plane of a third, to the round-off
  // of corners in single precision.
  bool continues(const SideOfFace& one, const SideOfFace& other, const Element& plane) const {
    if (!are_opposite(one, other)) return false;
    const Vec& a = plane.face.corners[0];
    const double size = (plane.face.corners[1] - a).norm();
    return std::ranges::all_of(elements_[other.element].face.corners, [&](const Vec& corner) {
      const double round_off =
          4 * double(std::numeric_limits<float>::epsilon()) * corner.cwiseAbs().maxCoeff();
      return std::abs(plane.height(corner)) <= round_off * (1 + (corner - a).norm() / size);
    });
  }
  // Not of a face that lies on the other one.
  bool are_opposite(const SideOfFace& one, const SideOfFace& other) const {
    const Vec& x = elements_[one.element].face.corners[one.k];
    Vec across = inwards(one, x);
    if constexpr (Dim == 3) {
      const auto& corners = elements_[one.element].face.corners;
      const Vec along = corners[(one.k + 1) % 3] - corners[one.k];
      across -= across.dot(along) / along.squaredNorm() * along;
    }
    return across.dot(inwards(other, x)) < 0;
  }
  static void take_plane(Element& element, const Element& plane) {
    const double sign = element.normal.dot(plane.normal) > 0 ? 1 : -1;
    element.normal = sign * plane.normal;
    element.offset = sign * plane.offset;
    element.facet = plane.facet;
  }

  void fill_cells(const std::string& name) {
    constexpr double max_cells = 1e8;
    for (std::uint32_t e = 0; e < elements_.size(); ++e) {
      const Face<Dim>& face = elements_[e].face;
      Vec lower = face.corners[0], upper = lower;
      for (const Vec& x : face.corners) {
        lower = lower.cwiseMin(x);
        upper = upper.cwiseMax(x);
      }
      const Vec margin = Vec::Constant(cell_);
      const Vec size = (upper - lower) / cell_ + Vec::Constant(3);
      if (!(size.prod() < max_cells)) {
        fail(name + ": face " + std::to_string(elements_[e].number) + " from " + to_text(lower) + " to " +
             to_text(upper) + " m is too large for an effective radius of " + to_text(cell_) +
             " m; give the part that fluid can reach");
      }
      const Cell from = cell_of(lower - margin), to = cell_of(upper + margin);
      Cell cell = from;
      while (true) {
        Vec centre;
        for (int k = 0; k < Dim; ++k) centre[k] = (double(cell[std::size_t(k)]) + 0.5) * cell_;
        const double half_diagonal = 0.5 * std::sqrt(double(Dim)) * cell_;
        if ((nearest_of(face, centre) - centre).norm() <= 1.0001 * (cell_ + half_diagonal)) {
          cells_[cell].push_back(e);
        }
        std::size_t k = 0;
        while (k < cell.size() && ++cell[k] > to[k]) {
          cell[k] = from[k];
          ++k;
        }
        if (k == cell.size()) break;
      }
    }
  }
  Cell cell_of(const Vec& x) const {
    Cell cell;
    for (int k = 0; k < Dim; ++k) {
      constexpr double most = 1e18;
      cell[std::size_t(k)] = std::int64_t(std::clamp(std::floor(x[k] / cell_), -most, most));
    }
    return cell;
  }

  double cell_ = 1;  // [m]
  std::vector<Element> elements_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, HashOfCell> cells_;
};

}  // namespace silt
