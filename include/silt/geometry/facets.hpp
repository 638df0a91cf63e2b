// SPDX-License-Identifier: MIT
// The facets of a surface: which of its faces continue each other in one plane, where facets end, and
// which of them are convex.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

namespace silt {

/// A face of a surface, with what is asked of it often.
template <int Dim>
struct FaceOfSurface {
  using Vec = silt::Vec<Dim>;

  Face<Dim> face;
  Vec normal;           ///< unit vector [-]
  double offset;        ///< normal·x of the points x of its plane [m]
  std::uint32_t facet;  ///< the number of its facet
  /// Whether the edge from corner k to the next one (in 2D, the end k) is on the facet's rim.
  std::array<bool, std::size_t(Dim)> is_rim;
  /// Whether its facet is known to be convex.
  bool is_convex;
  /// Unit vectors in the plane, from these edges (ends) into the face [-].
  std::array<Vec, std::size_t(Dim)> inwards;
  /// Their products with the points of the edges [m].
  std::array<double, std::size_t(Dim)> inner_offset;
  std::uint32_t group;  ///< of faces that move together; 0: at rest
  /// The number of its closed surface, from 1 on, whose normals are all outwards or all inwards; 0:
  /// of none.
  std::uint32_t closed_surface = 0;

  /// Signed distance of x, a point of the plane, from the line of an edge, positive on the side
  /// of the face [m].
  double inside(std::size_t k, const Vec& x) const { return inwards[k].dot(x) - inner_offset[k]; }
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

namespace detail {

/// Corners in an order that does not depend on which is given first.
template <int Dim, std::size_t n>
using Corners = std::array<std::array<double, std::size_t(Dim)>, n>;
template <int Dim, std::size_t n>
Corners<Dim, n> sorted_corners(const std::array<Vec<Dim>, n>& corners) {
  Corners<Dim, n> result;
  for (std::size_t k = 0; k < n; ++k) {
    for (int axis = 0; axis < Dim; ++axis) {
      result[k][std::size_t(axis)] = corners[k][axis] + 0.0;  // no −0
    }
    // std::sort() would compile a sort for arrays of any size.
    for (std::size_t m = k; m > 0 && result[m] < result[m - 1]; --m) {
      std::swap(result[m], result[m - 1]);
    }
  }
  return result;
}

/// Joins faces with planes of their own to facets. Faces with a common edge (in 2D a common end) and
/// the same plane (line) form one facet, with one plane; its rim are the edges (ends) at which it ends.
template <int Dim>
class Facets {
  using Element = FaceOfSurface<Dim>;
  using Vec = silt::Vec<Dim>;

 public:
  /// Changes the elements of `elements`.
  static void join(Buffer<Element>& elements) {
    Facets facets(elements);
    facets.join_facets();
    facets.find_closed_surfaces();
    facets.find_edges();
    facets.find_convex_facets();
  }

 private:
  explicit Facets(Buffer<Element>& elements) : elements_(elements) {}

  // A side of a face: the edge from corner k to the next one (in 2D, the end k).
  struct SideOfFace {
    std::uint32_t element;
    std::size_t k;
  };
  using Edge = Corners<Dim, std::size_t(Dim) - 1>;

  Edge edge_of(const SideOfFace& side) const {
    std::array<Vec, std::size_t(Dim) - 1> ends;
    for (std::size_t end = 0; end < ends.size(); ++end) {
      ends[end] = elements_[side.element].face.corners[(side.k + end) % std::size_t(Dim)];
    }
    return sorted_corners<Dim>(ends);
  }
  // From a point of the edge to the opposite corner (in 2D, to the other end).
  Vec inwards(const SideOfFace& side, const Vec& from) const {
    const auto& corners = elements_[side.element].face.corners;
    return corners[(side.k + std::size_t(Dim) - 1) % std::size_t(Dim)] - from;
  }

  // A facet is the faces connected with its first one in the plane of that one.
  void join_facets() {
    for (std::uint32_t e = 0; e < elements_.size(); ++e) {
      for (std::size_t k = 0; k < std::size_t(Dim); ++k) edges_[edge_of({e, k})].push_back({e, k});
    }
    Buffer<bool> has_facet(elements_.size(), false);
    Buffer<std::uint32_t> waiting;
    for (std::uint32_t first = 0; first < elements_.size(); ++first) {
      if (has_facet[first]) continue;
      has_facet[first] = true;
      waiting.assign(1, first);
      while (!waiting.empty()) {
        const std::uint32_t e = waiting.back();
        waiting.pop_back();
        for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
          for (const SideOfFace& other : edges_[edge_of({e, k})]) {
            if (has_facet[other.element] || !continues({e, k}, other, elements_[first])) continue;
            has_facet[other.element] = true;
            take_plane(elements_[other.element], elements_[first]);
            waiting.push_back(other.element);
          }
        }
      }
    }
    for (const auto& [edge, sides] : edges_) {
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
    if (elements_[one.element].group != elements_[other.element].group) return false;
    if (!are_opposite(one, other)) return false;
    const Vec& a = plane.face.corners[0];
    const double size = (plane.face.corners[1] - a).norm();
    return std::ranges::all_of(elements_[other.element].face.corners, [&](const Vec& corner) {
      const double round_off = 4 * double(std::numeric_limits<float>::epsilon()) * max_norm(corner);
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

  // Faces that are connected by edges, if none ends there, or has more than one neighbour, or one
  // of another group or with the other normal.
  void find_closed_surfaces() {
    Buffer<bool> is_known(elements_.size(), false);
    Buffer<std::uint32_t> surface;
    std::uint32_t number = 0;
    for (std::uint32_t first = 0; first < elements_.size(); ++first) {
      if (is_known[first]) continue;
      is_known[first] = true;
      surface.assign(1, first);
      bool is_closed = true;
      for (std::size_t n = 0; n < surface.size(); ++n) {
        const std::uint32_t e = surface[n];
        for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
          const auto& sides = edges_.find(edge_of({e, k}))->second;
          is_closed = is_closed && sides.size() == 2 && go_on(sides[0], sides[1]);
          for (const SideOfFace& side : sides) {
            if (is_known[side.element]) continue;
            is_known[side.element] = true;
            surface.push_back(side.element);
          }
        }
      }
      if (!is_closed) continue;
      ++number;
      for (const std::uint32_t e : surface) elements_[e].closed_surface = number;
    }
  }
  // Whether two faces of a group have the same side of their surface in the direction of their
  // normals: their corners are in the same sense.
  bool go_on(const SideOfFace& one, const SideOfFace& other) const {
    if (elements_[one.element].group != elements_[other.element].group) return false;
    if constexpr (Dim == 2) {
      return one.k != other.k;
    } else {
      return elements_[one.element].face.corners[one.k] !=
             elements_[other.element].face.corners[other.k];
    }
  }

  void find_edges() {
    for (Element& element : elements_) {
      const auto& corners = element.face.corners;
      for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
        Vec across = corners[(k + std::size_t(Dim) - 1) % std::size_t(Dim)] - corners[k];
        if constexpr (Dim == 3) {
          const Vec along = (corners[(k + 1) % 3] - corners[k]).normalized();
          across -= across.dot(along) * along;
        }
        element.inwards[k] = across.normalized();
        element.inner_offset[k] = element.inwards[k].dot(corners[k]);
      }
    }
  }
  // Those with few corners, all of which are on the inner side of all edges of the rim.
  void find_convex_facets() {
    constexpr std::size_t max_faces = 200;
    Buffer<Buffer<std::uint32_t>> facets(elements_.size());
    for (std::uint32_t e = 0; e < elements_.size(); ++e) facets[elements_[e].facet].push_back(e);
    for (const auto& facet : facets) {
      if (facet.size() > max_faces) continue;
      const bool is_convex = std::ranges::all_of(facet, [&](std::uint32_t one) {
        return std::ranges::all_of(facet, [&](std::uint32_t other) {
          return is_inside_rim(elements_[other], elements_[one]);
        });
      });
      for (const std::uint32_t e : facet) elements_[e].is_convex = is_convex;
    }
  }
  // Whether a face is on the inner side of those edges of another one that are on the rim.
  static bool is_inside_rim(const Element& face, const Element& of_rim) {
    for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
      if (!of_rim.is_rim[k]) continue;
      for (const Vec& corner : face.face.corners) {
        const double round_off =
            4 * double(std::numeric_limits<float>::epsilon()) * max_norm(corner);
        if (of_rim.inside(k, corner) < -round_off) return false;
      }
    }
    return true;
  }

  Buffer<Element>& elements_;
  std::map<Edge, Buffer<SideOfFace>> edges_;
};

}  // namespace detail

}  // namespace silt
