// SPDX-License-Identifier: MIT
// From one level of the multigrid on background cells to the next, with edges twice as long.
//
//     +---+---+---+---+        A wall runs through the middle. The four cells of a place on the next
//     | a | a # b | b |        level that are connected become one cell there; those that a wall
//     +---+---+---+---+        keeps apart become two at one place, so that no level mixes what lies
//     | a | a # b | b |        on its two sides.
//     +---+---+---+---+
//
// Masses are summed; a link has half the sum of the conductances it is made of. Values come back by
// linear interpolation between the centres that can be reached over links: 9/16, 3/16, 3/16, 1/16.
#pragma once

#include <silt/core/types.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_level.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace silt {

template <int Dim>
class CellCoarsening {
 public:
  using Level = CellLevel<Dim>;

  /// Makes `coarse` the next level above `fine`, but for its diagonal; false where it would hardly
  /// be smaller.
  bool lay(const Level& fine, Level& coarse) {
    const Index n = fine.size();
    places_.resize(n);
    for_each_cell(n, [&](Index c) {
      for (std::size_t k = 0; k < Dim; ++k) places_[c][k] = fine.cells[c][k] >> 1;
    });
    numbering_.number(places_, CellOrder::chessboard);
    join_connected(fine);
    number_cells(coarse);
    if (coarse.size() * 4 > n * 3) return false;
    sum_children(fine, coarse);
    find_shares(fine, coarse);
    return true;
  }

  /// b = Pᵀ r
  void restrict_to(std::span<float> b, std::span<const float> r) const {
    for_each_cell(b.size(), [&](Index parent) {
      float sum = 0;
      for (Index k = first_below_[parent]; k < first_below_[parent + 1]; ++k) {
        sum += below_[k].share * r[below_[k].cell];
      }
      b[parent] = sum;
    });
  }

  /// x += P coarse
  void add_interpolated(std::span<const float> coarse, std::span<float> x) const {
    for_each_cell(x.size(), [&](Index c) {
      for (const Share& above : above_[c]) x[c] += above.share * coarse[above.cell];
    });
  }

 private:
  using Link = typename Level::Link;
  static constexpr Index corners = Index(1) << Dim;
  static constexpr std::uint32_t nothing = BackgroundCells<Dim>::none;

  struct Share {
    std::uint32_t cell = 0;
    float share = 0;
  };

  // joined_[c] is the lowest of the cells that c is connected with at its place.
  void join_connected(const Level& fine) {
    joined_.resize(fine.size());
    std::iota(joined_.begin(), joined_.end(), 0u);
    for (bool changed = true; changed;) {
      changed = false;
      for (Index c = 0; c < fine.size(); ++c) {
        for (const Link& link : fine.links[c]) {
          if (joined_[link.cell] >= joined_[c] || places_[link.cell] != places_[c]) continue;
          joined_[c] = joined_[link.cell];
          changed = true;
        }
      }
    }
  }

  void number_cells(Level& coarse) {
    const Index n = joined_.size();
    first_at_.assign(numbering_.size() + 1, 0);
    for (Index c = 0; c < n; ++c) {
      if (joined_[c] == c) ++first_at_[numbering_.find(places_[c]) + 1];
    }
    std::partial_sum(first_at_.begin(), first_at_.end(), first_at_.begin());
    coarse.reset(first_at_.back());
    coarse.reds = first_at_[numbering_.reds()];
    parent_.resize(n);
    for (Index c = 0; c < n; ++c) {
      if (joined_[c] == c) {
        parent_[c] = first_at_[numbering_.find(places_[c])]++;
        coarse.cells[parent_[c]] = places_[c];
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
      static thread_local std::vector<Link> links;
      links.clear();
      for (const Index c : children_of(parent)) {
        for (const Link& link : fine.links[c]) {
          const std::uint32_t other = parent_[link.cell];
          if (other == parent) continue;
          const auto known = std::ranges::find(links, other, &Link::cell);
          if (known == links.end()) {
            links.push_back({other, link.conductance / 2});
          } else {
            known->conductance += link.conductance / 2;
          }
        }
      }
      for (const Link& link : links) add(link);
    });
  }

  void find_shares(const Level& fine, const Level& coarse) {
    above_.resize(fine.size());
    for_each_cell(fine.size(), [&](Index c) {
      float sum = 0;
      for (Index corner = 0; corner < corners; ++corner) {
        Share& above = above_[c][corner];
        above = {parent_[c], 1};
        for (std::size_t k = 0; k < Dim; ++k) above.share *= (corner >> k) & 1 ? 0.25f : 0.75f;
        if (!walk(coarse, fine.cells[c], corner, above.cell)) above = {};
        sum += above.share;
      }
      for (Share& above : above_[c]) above.share /= sum;
    });
    first_below_.assign(coarse.size() + 2, 0);
    for_each_share([&](Index, const Share& above) { ++first_below_[above.cell + 2]; });
    std::partial_sum(first_below_.begin(), first_below_.end(), first_below_.begin());
    below_.resize(first_below_.back());
    for_each_share([&](Index c, const Share& above) {
      below_[first_below_[above.cell + 1]++] = {static_cast<std::uint32_t>(c), above.share};
    });
  }

  template <class F>
  void for_each_share(F&& f) const {
    for (Index c = 0; c < above_.size(); ++c) {
      for (const Share& above : above_[c]) {
        if (above.share > 0) f(c, above);
      }
    }
  }

  // From the parent of a fine cell to the corner that lies towards its side, over one link after
  // the other, in one order of the axes or the other; false if no way leads there.
  static bool walk(const Level& coarse, const GridCell<Dim>& fine, Index corner, std::uint32_t& cell) {
    for (const bool backwards : {false, true}) {
      std::uint32_t at = cell;
      for (std::size_t step = 0; step < Dim && at != nothing; ++step) {
        const std::size_t k = backwards ? Dim - 1 - step : step;
        if ((corner >> k) & 1) at = beside(coarse, at, k, (fine[k] & 1) != 0 ? 1 : -1);
      }
      if (at != nothing) {
        cell = at;
        return true;
      }
    }
    return false;
  }

  // The cell across a face; where a wall ends and there are two, the one that conducts better.
  static std::uint32_t beside(const Level& coarse, Index cell, std::size_t axis, std::int64_t way) {
    std::uint32_t best = nothing;
    float most = 0;
    for (const Link& link : coarse.links[cell]) {
      if (coarse.cells[link.cell][axis] != coarse.cells[cell][axis] + way) continue;
      if (link.conductance > most) {
        best = link.cell;
        most = link.conductance;
      }
    }
    return best;
  }

  std::vector<GridCell<Dim>> places_;       // on the coarse level, by fine cell
  BackgroundCells<Dim> numbering_;          // of these places
  std::vector<std::uint32_t> joined_;       // by fine cell
  std::vector<std::uint32_t> first_at_;     // by place
  std::vector<std::uint32_t> parent_;       // by fine cell
  std::vector<std::uint32_t> first_child_;  // by coarse cell
  std::vector<std::uint32_t> child_;
  std::vector<std::array<Share, corners>> above_;  // by fine cell
  std::vector<std::uint32_t> first_below_;         // by coarse cell: Pᵀ
  std::vector<Share> below_;
};

}  // namespace silt
