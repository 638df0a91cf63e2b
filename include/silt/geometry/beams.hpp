// SPDX-License-Identifier: MIT
// Beams: where lines from a viewpoint go that pass through one facet after another.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace silt {

/// Beams of mirrored viewpoints. Their lines may be shifted, in any direction, without being turned.
template <int Dim>
class Beams {
 public:
  using Vec = silt::Vec<Dim>;
  using Element = typename Faces<Dim>::Element;

  /// One of them.
  /// The lines from one viewpoint through one facet: those points beyond it.
  struct Beam {
    Vec viewpoint = Vec::Zero();       ///< [m]
    std::uint32_t first = 0, end = 0;  ///< of the half-spaces that have all of it
    /// In one of which each point is; none: everywhere.
    std::uint32_t first_piece = 0, end_piece = 0;
  };

  void clear() {
    half_spaces_.clear();
    pieces_.clear();
  }

  /// The beam of lines from a viewpoint through faces of one facet, beyond it, among those of another
  /// beam, `before`, mirrored in the facet. Height of the viewpoint above the plane of the first face,
  /// and largest shift of the lines [m].
  template <class ElementOf>
  Beam through(std::span<const std::uint32_t> faces, const ElementOf& element_of, const Vec& viewpoint,
               double height, double shift, const Beam& before) {
    const Element& plane = element_of(faces[0]);
    Beam beam{.viewpoint = viewpoint, .first = size_of(half_spaces_)};
    for (std::uint32_t k = before.first; k < before.end; ++k) {
      HalfSpace half = half_spaces_[k];
      const double across = half.normal.dot(plane.normal);
      half.normal -= (2 * across) * plane.normal;
      half.offset -= (2 * across) * plane.offset;
      half_spaces_.push_back(half);
    }
    const double side = height > 0 ? -1 : 1;
    const double round_off = 1e-6 * shift;
    half_spaces_.push_back({side * plane.normal, side * plane.offset - round_off, 0});
    const auto add_edge = [&](const Element& element, std::size_t k) {
      // A shifted line from o to x passes the edge from a to b on the inner side of it if
      // |b − a × d| s ≥ (b − a × a − o)·d with d = x − o and its shift s.
      const Vec from = element.face.corners[k] - viewpoint;
      Vec normal;
      if constexpr (Dim == 2) {
        normal = {-from[1], from[0]};
      } else {
        const Vec& next = element.face.corners[(k + 1) % 3];
        normal = cross(from, Vec(next - element.face.corners[k]).normalized());
      }
      if (normal.dot(element.inwards[k]) < 0) normal = -normal;
      half_spaces_.push_back({normal, normal.dot(viewpoint), shift});
    };
    if (plane.is_convex) {
      for (const std::uint32_t face : faces) {
        const Element& element = element_of(face);
        for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
          if (element.is_rim[k]) add_edge(element, k);
        }
      }
    }
    beam.end = size_of(half_spaces_);
    beam.first_piece = beam.end_piece = size_of(pieces_);
    if (!plane.is_convex) {
      for (const std::uint32_t face : faces) {
        const std::uint32_t first = size_of(half_spaces_);
        for (std::size_t k = 0; k < std::size_t(Dim); ++k) add_edge(element_of(face), k);
        pieces_.push_back({first, size_of(half_spaces_)});
      }
      beam.end_piece = size_of(pieces_);
    }
    return beam;
  }

  /// Whether a line of the beam may lead to x [m].
  bool contains(const Beam& beam, const Vec& x) const {
    const double distance = (x - beam.viewpoint).norm();
    return has_part(beam, [&](const HalfSpace& half) { return half.contains(x, distance); });
  }
  /// Whether a line of the beam may lead to a point of a face that is not further from the viewpoint
  /// than `distance` [m].
  bool may_meet(const Beam& beam, const Face<Dim>& face, double distance) const {
    return has_part(beam, [&](const HalfSpace& half) {
      return std::ranges::any_of(face.corners,
                                 [&](const Vec& x) { return half.contains(x, distance); });
    });
  }

 private:
  // For an edge, with a normal as long as the viewpoint is away from it.
  struct HalfSpace {
    Vec normal;
    double offset;
    double shift;  // of lines [m]

    // A point at this distance from the viewpoint.
    bool contains(const Vec& x, double distance) const {
      return normal.dot(x) >= offset - shift * distance;
    }
  };
  struct Piece {
    std::uint32_t first, end;  // of its half-spaces
  };
  template <class T>
  static std::uint32_t size_of(const Buffer<T>& values) {
    return static_cast<std::uint32_t>(values.size());
  }
  template <class F>
  bool has_part(const Beam& beam, F&& f) const {
    const auto all = [&](std::uint32_t first, std::uint32_t end) {
      for (std::uint32_t k = first; k < end; ++k) {
        if (!f(half_spaces_[k])) return false;
      }
      return true;
    };
    if (!all(beam.first, beam.end)) return false;
    if (beam.first_piece == beam.end_piece) return true;
    for (std::uint32_t p = beam.first_piece; p < beam.end_piece; ++p) {
      if (all(pieces_[p].first, pieces_[p].end)) return true;
    }
    return false;
  }

  Buffer<HalfSpace> half_spaces_;
  Buffer<Piece> pieces_;
};

}  // namespace silt
