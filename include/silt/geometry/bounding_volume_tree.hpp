// SPDX-License-Identifier: MIT
// A tree of bounding boxes, for finding the items near a point.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

namespace silt {

/// Finds the items near a point by their bounding boxes.
template <int Dim, class Real>
class BoxTree {
 public:
  using Vec = silt::Vec<Dim, Real>;
  /// A bounding box, from its corner `lower` to `upper` [m].
  struct Bounds {
    Vec lower = Vec::Zero();
    Vec upper = Vec::Zero();

    /// Extends the box, so that it has the other one inside.
    void enclose(const Bounds& other) {
      for (int k = 0; k < Dim; ++k) {
        lower[k] = std::min(lower[k], other.lower[k]);
        upper[k] = std::max(upper[k], other.upper[k]);
      }
    }
    /// Squared distance of a point, or of another box, from the box [m²]; 0 inside.
    Real squared_distance(const Vec& x) const { return squared_distance(Bounds{x, x}); }
    Real squared_distance(const Bounds& other) const {
      Vec gap;
      for (int k = 0; k < Dim; ++k) {
        gap[k] = std::max({lower[k] - other.upper[k], other.lower[k] - upper[k], Real(0)});
      }
      return gap.squaredNorm();
    }
  };

  BoxTree() = default;
  /// Items are known by their index in this vector.
  explicit BoxTree(const Buffer<Bounds>& items) : items_(items.size()) {
    std::iota(items_.begin(), items_.end(), std::uint32_t(0));
    nodes_.reserve(2 * items.size());
    if (!items.empty()) build(items, {0, static_cast<std::uint32_t>(items.size())});
  }

  /// The same items with other bounds: nodes keep their items, and become larger or smaller.
  void refit(const Buffer<Bounds>& items) {
    for (Index k = nodes_.size(); k-- > 0;) {
      Node& node = nodes_[k];
      if (node.second == 0) {
        node.bounds = items[items_[node.items.first]];
        for (std::uint32_t n = node.items.first; n < node.items.last; ++n) {
          node.bounds.enclose(items[items_[n]]);
        }
      } else {
        node.bounds = nodes_[k + 1].bounds;
        node.bounds.enclose(nodes_[node.second].bounds);
      }
    }
  }

  /// visit(item) for the items whose bounds are closer to x, a point or Bounds, than `limit`, a squared
  /// distance [m²], and for some further ones. visit returns the limit for the remaining items. Nearer
  /// nodes are visited first.
  template <class Shape, class Visit>
  void visit_near(const Shape& x, Real limit, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, 64> stack;  // nodes are halved, so the depth is at most 32
    Index count = 0;
    stack[count++] = 0;
    while (count > 0) {
      const std::uint32_t number = stack[--count];
      const Node& node = nodes_[number];
      if (!(node.bounds.squared_distance(x) < limit)) continue;
      for (std::uint32_t k = node.items.first; k < node.items.last; ++k) limit = visit(items_[k]);
      if (node.second == 0) continue;
      std::uint32_t near = number + 1;
      std::uint32_t far = node.second;
      if (nodes_[far].bounds.squared_distance(x) < nodes_[near].bounds.squared_distance(x)) {
        std::swap(near, far);
      }
      stack[count++] = far;
      stack[count++] = near;
    }
  }

 private:
  struct Range {
    std::uint32_t first;
    std::uint32_t last;
  };
  // The first child of a node is the next node.
  struct Node {
    Bounds bounds;
    Range items{0, 0};         // of a leaf
    std::uint32_t second = 0;  // second child; 0: a leaf
  };
  static constexpr std::uint32_t leaf_size = 4;

  void build(const Buffer<Bounds>& bounds, Range range) {
    const Index number = nodes_.size();
    nodes_.resize(number + 1);
    Bounds all = bounds[items_[range.first]];
    for (std::uint32_t k = range.first; k < range.last; ++k) all.enclose(bounds[items_[k]]);
    nodes_[number].bounds = all;
    if (range.last - range.first <= leaf_size) {
      nodes_[number].items = range;
      return;
    }
    int axis = 0;
    const Vec size = all.upper - all.lower;
    for (int k = 1; k < Dim; ++k) {
      if (size[k] > size[axis]) axis = k;
    }
    const std::uint32_t middle = range.first + (range.last - range.first) / 2;
    const auto key = [&](std::uint32_t item) {
      return std::pair(bounds[item].lower[axis] + bounds[item].upper[axis], item);
    };
    std::nth_element(items_.begin() + range.first, items_.begin() + middle,
                     items_.begin() + range.last,
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    build(bounds, {range.first, middle});
    nodes_[number].second = static_cast<std::uint32_t>(nodes_.size());
    build(bounds, {middle, range.last});
  }

  Buffer<std::uint32_t> items_;
  Buffer<Node> nodes_;
};

}  // namespace silt
