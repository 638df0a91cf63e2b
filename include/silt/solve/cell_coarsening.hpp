// SPDX-License-Identifier: MIT
// Coarsening of the multigrid on background cells: from one level to the next, with twice the edge.
//
//     +---+---+---+---+        The # are a wall. Fine cells with one coarse position become one
//     | a | a # b | b |        coarse cell if they are connected. If a wall separates them, they
//     +---+---+---+---+        become several coarse cells at one position: no level connects the
//     | a | a # b | b |        two sides of a wall.
//     +---+---+---+---+
//
// Masses are summed; the conductance of a coarse link is half the sum of those of its fine links.
// Prolongation is linear interpolation between the coarse centres that can be reached over links,
// with weights 9/16, 3/16, 3/16, 1/16 (in 2D).
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_level.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>

namespace silt {

/// Makes one CellLevel from another, and passes values between them.
template <int Dim>
class CellCoarsening {
 public:
  using Level = CellLevel<Dim>;

  /// Builds the next coarser level of `fine`, except its diagonal; false if it would not have at
  /// most three quarters of the cells.
  bool build(const Level& fine, Level& coarse) {
    const Index n = fine.size();
    positions_.resize(n);
    for_each_cell(n, [&](Index c) {
      for (std::size_t k = 0; k < Dim; ++k) positions_[c][k] = fine.cells[c][k] >> 1;
    });
    numbering_.number(positions_, CellOrder::chessboard);
    join_connected(fine);
    number_cells(coarse);
    if (coarse.size() * 4 > n * 3) return false;
    sum_children(fine, coarse);
    find_weights(fine, coarse);
    return true;
  }

  /// b = Pᵀ r
  void restrict_to(std::span<float> b, std::span<const float> r) const {
    for_each_cell(b.size(), [&](Index parent) {
      float sum = 0;
      for (Index k = first_in_column_[parent]; k < first_in_column_[parent + 1]; ++k) {
        sum += columns_[k].value * r[columns_[k].cell];
      }
      b[parent] = sum;
    });
  }

  /// x += P coarse
  void add_interpolated(std::span<const float> coarse, std::span<float> x) const {
    for_each_cell(x.size(), [&](Index c) {
      for (const Weight& weight : rows_[c]) x[c] += weight.value * coarse[weight.cell];
    });
  }

 private:
  using Link = typename Level::Link;
  static constexpr Index corners = Index(1) << Dim;
  static constexpr std::uint32_t none = BackgroundCells<Dim>::none;

  struct Weight {
    std::uint32_t cell = 0;
    float value = 0;
  };

  // joined_[c] is the lowest number of the cells connected with c at the same coarse position.
  void join_connected(const Level& fine) {
    joined_.resize(fine.size());
    std::iota(joined_.begin(), joined_.end(), 0u);
    for (bool changed = true; changed;) {
      changed = false;
      for (Index c = 0; c < fine.size(); ++c) {
        for (const Link& link : fine.links[c]) {
          std::uint32_t& other = joined_[link.cell];
          if (other == joined_[c] || positions_[link.cell] != positions_[c]) continue;
          joined_[c] = other = std::min(joined_[c], other);
          changed = true;
        }
      }
    }
  }

  void number_cells(Level& coarse) {
    const Index n = joined_.size();
    first_at_position_.assign(numbering_.size() + 1, 0);
    for (Index c = 0; c < n; ++c) {
      if (joined_[c] == c) ++first_at_position_[numbering_.find(positions_[c]) + 1];
    }
    std::partial_sum(first_at_position_.begin(), first_at_position_.end(),
                     first_at_position_.begin());
    coarse.reset(first_at_position_.back());
    coarse.reds = first_at_position_[numbering_.reds()];
    parent_.resize(n);
    for (Index c = 0; c < n; ++c) {
      if (joined_[c] == c) {
        parent_[c] = first_at_position_[numbering_.find(positions_[c])]++;
        coarse.cells[parent_[c]] = positions_[c];
      } else {
        parent_[c] = parent_[joined_[c]];
      }
    }
    first_child_.assign(coarse.size() + 2, 0);
    for (const Index parent : parent_) ++first_child_[parent + 2];
    std::partial_sum(first_child_.begin(), first_child_.end(), first_child_.begin());
    child_.resize(n);
    for (Index c = 0; c < n; ++c) child_[first_child_[parent_[c] + 1]++] = std::uint32_t(c);
  }

  std::span<const std::uint32_t> children_of(Index parent) const {
    return std::span(child_).subspan(first_child_[parent],
                                     first_child_[parent + 1] - first_child_[parent]);
  }

  void sum_children(const Level& fine, Level& coarse) const {
    for_each_cell(coarse.size(), [&](Index parent) {
      for (const Index c : children_of(parent)) coarse.mass[parent] += fine.mass[c];
    });
    coarse.links.build(coarse.size(), [&](Index parent, auto&& add) {
      static thread_local Buffer<Link> links;
      links.clear();
      for (const Index c : children_of(parent)) {
        for (const Link& link : fine.links[c]) {
          const std::uint32_t other = parent_[link.cell];
          if (other == parent) continue;
          const auto found = std::ranges::find(links, other, &Link::cell);
          if (found == links.end()) {
            links.push_back({other, link.conductance / 2});
          } else {
            found->conductance += link.conductance / 2;
          }
        }
      }
      for (const Link& link : links) add(link);
    });
  }

  void find_weights(const Level& fine, const Level& coarse) {
    rows_.resize(fine.size());
    const auto find_row = [&](Index c) {
      float sum = 0;
      for (Index corner = 0; corner < corners; ++corner) {
        Weight& weight = rows_[c][corner];
        weight = {parent_[c], 1};
        for (std::size_t k = 0; k < Dim; ++k) weight.value *= (corner >> k) & 1 ? 0.25f : 0.75f;
        if (!follow_links(coarse, fine.cells[c], corner, weight.cell)) weight = {};
        sum += weight.value;
      }
      for (Weight& weight : rows_[c]) weight.value /= sum;
    };
    for_each_cell(fine.size(), find_row, some_cells);
    first_in_column_.assign(coarse.size() + 2, 0);
    for_each_weight([&](Index, const Weight& weight) { ++first_in_column_[weight.cell + 2]; });
    std::partial_sum(first_in_column_.begin(), first_in_column_.end(), first_in_column_.begin());
    columns_.resize(first_in_column_.back());
    for_each_weight([&](Index c, const Weight& weight) {
      columns_[first_in_column_[weight.cell + 1]++] = {static_cast<std::uint32_t>(c), weight.value};
    });
  }

  template <class F>
  void for_each_weight(F&& f) const {
    for (Index c = 0; c < rows_.size(); ++c) {
      for (const Weight& weight : rows_[c]) {
        if (weight.value > 0) f(c, weight);
      }
    }
  }

  // Replaces the parent of a fine cell by the coarse cell at the given corner of the interpolation,
  // following links along one axis after the other, in both orders of the axes; false if there is
  // no path.
  static bool follow_links(const Level& coarse, const GridCell<Dim>& fine, Index corner,
                           std::uint32_t& cell) {
    for (const bool backwards : {false, true}) {
      std::uint32_t reached = cell;
      for (std::size_t step = 0; step < Dim && reached != none; ++step) {
        const std::size_t k = backwards ? Dim - 1 - step : step;
        if ((corner >> k) & 1) {
          reached = neighbour(coarse, reached, k, (fine[k] & 1) != 0 ? 1 : -1);
        }
      }
      if (reached != none) {
        cell = reached;
        return true;
      }
    }
    return false;
  }

  // The cell across a face; of two, at the end of a wall, the one with the larger conductance.
  static std::uint32_t neighbour(const Level& coarse, Index cell, std::size_t axis,
                                 std::int64_t direction) {
    std::uint32_t best = none;
    float max_conductance = 0;
    for (const Link& link : coarse.links[cell]) {
      if (coarse.cells[link.cell][axis] != coarse.cells[cell][axis] + direction) continue;
      if (link.conductance > max_conductance) {
        best = link.cell;
        max_conductance = link.conductance;
      }
    }
    return best;
  }

  Buffer<GridCell<Dim>> positions_;    // coarse position, by fine cell
  BackgroundCells<Dim> numbering_;          // of the coarse positions
  Buffer<std::uint32_t> joined_;            // by fine cell
  Buffer<std::uint32_t> first_at_position_;  // first coarse cell, by position
  Buffer<std::uint32_t> parent_;             // by fine cell
  Buffer<std::uint32_t> first_child_;        // by coarse cell
  Buffer<std::uint32_t> child_;
  Buffer<std::array<Weight, corners>> rows_;  // of P, by fine cell
  Buffer<std::uint32_t> first_in_column_;     // by coarse cell
  Buffer<Weight> columns_;                    // of P, the rows of Pᵀ
};

}  // namespace silt
