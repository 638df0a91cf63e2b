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
// with weights 9/16, 3/16, 3/16, 1/16 (in 2D). It is done to the red cells alone, and restriction
// from them: the sweep that follows sets the black cells from their red neighbours, and after a
// black sweep they have no residual.
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
#include <utility>

namespace silt {

/// Makes one CellLevel from another, and passes values between them.
template <int Dim>
class CellCoarsening {
 public:
  using Level = CellLevel<Dim>;

  /// Builds the next coarser level of `fine`, except its diagonal; false if it would not have at
  /// most three quarters of the cells.
  bool build(const Level& fine, Level& coarse) {
    number_positions(fine);
    join_connected(fine);
    number_cells(coarse);
    if (coarse.size() * 4 > fine.size() * 3) return false;
    sum_children(fine, coarse);
    find_weights(fine, coarse);
    return true;
  }

  /// b = Pᵀ r, where r = 0 in the black cells.
  void restrict_to(std::span<float> b, std::span<const float> r) const {
    for_each_cell(b.size(), [&](Index parent) {
      float sum = 0;
      for (Index k = first_in_column_[parent]; k < first_in_column_[parent + 1]; ++k) {
        sum += columns_[k].value * r[columns_[k].cell];
      }
      b[parent] = sum;
    });
  }

  /// x += P coarse in the red cells.
  void add_interpolated(std::span<const float> coarse, std::span<float> x) const {
    for_each_cell(rows_.size(), [&](Index c) {
      float sum = x[c];
      for (const Weight& weight : rows_[c]) sum += weight.value * coarse[weight.cell];
      x[c] = sum;
    });
  }

 private:
  static constexpr Index corners = Index(1) << Dim;
  static constexpr std::uint32_t none = BackgroundCells<Dim>::none;

  struct Weight {
    std::uint32_t cell = 0;
    float value = 0;
  };
  // The cells across the two faces along each axis, or none: in front and behind.
  using Beside = std::array<std::array<std::uint32_t, 2>, Dim>;

  // Sorts the fine cells by coarse position.
  void number_positions(const Level& fine) {
    const Index n = fine.size();
    positions_.resize(n);
    for_each_cell(n, [&](Index c) {
      for (std::size_t k = 0; k < Dim; ++k) positions_[c][k] = fine.cells[c][k] >> 1;
    });
    numbering_.number(positions_, CellOrder::chessboard);
    position_of_.resize(n);
    for_each_cell(n, [&](Index c) { position_of_[c] = numbering_.find(positions_[c]); });
    first_at_position_.assign(numbering_.size() + 2, 0);
    for (const Index place : position_of_) ++first_at_position_[place + 2];
    std::partial_sum(first_at_position_.begin(), first_at_position_.end(),
                     first_at_position_.begin());
    child_.resize(n);
    for (Index c = 0; c < n; ++c) {
      child_[first_at_position_[position_of_[c] + 1]++] = static_cast<std::uint32_t>(c);
    }
  }

  std::span<std::uint32_t> cells_at(Index place) {
    const Index first = first_at_position_[place];
    return std::span(child_.data() + first, first_at_position_[place + 1] - first);
  }

  // joined_[c] is the lowest number of the cells connected with c at the same coarse position, by
  // which the cells of a position are then sorted.
  void join_connected(const Level& fine) {
    joined_.resize(fine.size());
    parts_.resize(numbering_.size());
    for_each_cell(
        numbering_.size(),
        [&](Index place) {
          const auto here = cells_at(place);
          for (const std::uint32_t c : here) joined_[c] = c;
          for (bool changed = here.size() > 1; changed;) {
            changed = false;
            for (const std::uint32_t c : here) {
              for (const CellLink& link : fine.links[c]) {
                if (position_of_[link.cell] != place) continue;
                std::uint32_t& other = joined_[link.cell];
                if (other == joined_[c]) continue;
                joined_[c] = other = std::min(joined_[c], other);
                changed = true;
              }
            }
          }
          Index parts = 0;
          for (const std::uint32_t c : here) parts += joined_[c] == c ? 1 : 0;
          parts_[place] = static_cast<std::uint32_t>(parts);
          if (parts == 1) return;
          std::ranges::sort(here, {}, [&](std::uint32_t c) { return std::pair(joined_[c], c); });
        },
        some_cells);
  }

  void number_cells(Level& coarse) {
    const Index n = joined_.size();
    first_part_.assign(numbering_.size() + 1, 0);
    std::partial_sum(parts_.begin(), parts_.end(), first_part_.begin() + 1);
    coarse.reset(first_part_[numbering_.size()]);
    coarse.reds = first_part_[numbering_.reds()];
    parent_.resize(n);
    first_child_.resize(coarse.size() + 1);
    for_each_cell(numbering_.size(), [&](Index place) {
      Index parent = first_part_[place];
      Index at = first_at_position_[place];
      first_child_[parent] = static_cast<std::uint32_t>(at);
      for (const std::uint32_t c : cells_at(place)) {
        if (joined_[c] == c) {
          if (at > first_at_position_[place]) ++parent;
          first_child_[parent] = static_cast<std::uint32_t>(at);
          coarse.cells[parent] = positions_[c];
        }
        parent_[c] = static_cast<std::uint32_t>(parent);
        ++at;
      }
    });
    first_child_[coarse.size()] = static_cast<std::uint32_t>(n);
  }

  std::span<const std::uint32_t> children_of(Index parent) const {
    return std::span(child_.data() + first_child_[parent],
                     first_child_[parent + 1] - first_child_[parent]);
  }

  void sum_children(const Level& fine, Level& coarse) const {
    for_each_cell(coarse.size(), [&](Index parent) {
      float sum = 0;
      for (const Index c : children_of(parent)) sum += fine.mass[c];
      coarse.mass[parent] = sum;
    });
    coarse.links.build(coarse.size(), [&](Index parent, auto&& add) {
      static thread_local Buffer<CellLink> links;
      links.clear();
      for (const Index c : children_of(parent)) {
        for (const CellLink& link : fine.links[c]) {
          const std::uint32_t other = parent_[link.cell];
          if (other == parent) continue;
          const auto found = std::ranges::find(links, other, &CellLink::cell);
          if (found == links.end()) {
            links.push_back({other, link.conductance / 2});
          } else {
            found->conductance += link.conductance / 2;
          }
        }
      }
      for (const CellLink& link : links) add(link);
    });
  }

  void find_weights(const Level& fine, const Level& coarse) {
    find_beside(coarse);
    rows_.resize(fine.reds);
    const auto find_row = [&](Index c) {
      float sum = 0;
      for (Index corner = 0; corner < corners; ++corner) {
        Weight& weight = rows_[c][corner];
        weight = {parent_[c], 1};
        for (std::size_t k = 0; k < Dim; ++k) weight.value *= (corner >> k) & 1 ? 0.25f : 0.75f;
        if (!follow_links(fine.cells[c], corner, weight.cell)) weight = {};
        sum += weight.value;
      }
      for (Weight& weight : rows_[c]) weight.value /= sum;
    };
    for_each_cell(fine.reds, find_row, some_cells);
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

  // Of two cells across a face, at the end of a wall, the one with the larger conductance.
  void find_beside(const Level& coarse) {
    beside_.resize(coarse.size());
    for_each_cell(
        coarse.size(),
        [&](Index c) {
          std::array<std::array<float, 2>, Dim> largest{};
          for (auto& along : beside_[c]) along.fill(none);
          for (const CellLink& link : coarse.links[c]) {
            for (std::size_t k = 0; k < Dim; ++k) {
              const std::int64_t step = coarse.cells[link.cell][k] - coarse.cells[c][k];
              if (step == 0) continue;
              const std::size_t side = step > 0 ? 1 : 0;
              if (!(link.conductance > largest[k][side])) continue;
              beside_[c][k][side] = link.cell;
              largest[k][side] = link.conductance;
            }
          }
        },
        some_cells);
  }

  // Replaces the parent of a fine cell by the coarse cell at the given corner of the interpolation,
  // following links along one axis after the other, in both orders of the axes; false if there is
  // no path.
  bool follow_links(const GridCell<Dim>& fine, Index corner, std::uint32_t& cell) const {
    for (const bool backwards : {false, true}) {
      std::uint32_t reached = cell;
      for (std::size_t step = 0; step < Dim && reached != none; ++step) {
        const std::size_t k = backwards ? Dim - 1 - step : step;
        if ((corner >> k) & 1) reached = beside_[reached][k][static_cast<std::size_t>(fine[k] & 1)];
      }
      if (reached != none) {
        cell = reached;
        return true;
      }
    }
    return false;
  }

  Buffer<GridCell<Dim>> positions_;           // coarse position, by fine cell
  BackgroundCells<Dim> numbering_;            // of the coarse positions
  Buffer<std::uint32_t> position_of_;         // number of the position, by fine cell
  Buffer<std::uint32_t> first_at_position_;   // in child_
  Buffer<std::uint32_t> joined_;              // by fine cell
  Buffer<std::uint32_t> parts_;               // number of coarse cells, by position
  Buffer<std::uint32_t> first_part_;          // first coarse cell, by position
  Buffer<std::uint32_t> parent_;              // by fine cell
  Buffer<std::uint32_t> first_child_;         // in child_, by coarse cell
  Buffer<std::uint32_t> child_;               // fine cells by coarse cell
  Buffer<Beside> beside_;                     // by coarse cell
  Buffer<std::array<Weight, corners>> rows_;  // of P, by red fine cell
  Buffer<std::uint32_t> first_in_column_;     // by coarse cell
  Buffer<Weight> columns_;                    // of P, the rows of Pᵀ
};

}  // namespace silt
