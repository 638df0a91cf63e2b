// SPDX-License-Identifier: MIT
// The contact search of [SahChoi2004]: particles are sorted into square cells with the search
// radius as edge. All neighbours of a particle are in its cell or an adjacent one. These cells are
// a few contiguous ranges of memory (cells.hpp), in which distances are tested with SIMD
// (core/simd.hpp).
//
// Neighbour rows of all particles are built in blocks of particles that share their candidates
// (shared_candidates.hpp).
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/search/crowd.hpp>
#include <silt/search/extent.hpp>
#include <silt/search/ghosts.hpp>
#include <silt/search/neighbour_rows.hpp>
#include <silt/search/shared_candidates.hpp>
#include <silt/search/sorted_cells.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace silt {

/// A NeighbourSearch for particles of similar sizes, [SahChoi2004] (1): O(N), also with a few
/// particles far away.
template <int Dim, class RealType = double>
class UniformGrid {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    Real radius = 0;  ///< pairs closer than this are found [m]; 0: the interaction range
  };

  UniformGrid() = default;
  /// Throws if the radius is negative or not finite.
  explicit UniformGrid(Settings settings) : radius_(settings.radius) {
    require_not_negative("UniformGrid: radius", double(radius_));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius [m] is not positive.
  void set_radius(Real radius) {
    require_positive("UniformGrid: radius", double(radius));
    radius_ = radius;
  }
  /// Margin of the candidates beyond radius() [m], see margin_of() in core/concepts.hpp.
  Real margin() const noexcept { return 0; }

  /// Sorts the owned particles by cell if many are out of order, so that neighbours in space are
  /// close in memory. If particles were added or removed since the last update, sorts if any is out
  /// of order, because a lattice added row by row has few descents. Throws if there is no radius.
  template <class P>
  void sort(P& particles) {
    if (particles.size() < worth_sorting) return;
    // The count of the last update is recent enough.
    const bool is_new = particles.owned_revision() != revision_;
    const Index many = is_new ? 0 : particles.size() / 16;
    if (!is_new && descents_ <= many) return;
    require_positive("UniformGrid: radius", double(radius_));
    const auto x = std::as_const(particles)[position];
    const auto extent = extent_of_points(x);
    if (!extent.is_finite()) return;  // update() throws
    points_.sort(x, extent, radius_);
    owned_ = particles.size();
    if (points_.descents() > many) particles.reorder(order());
  }

  /// Sorts the particles into cells, and makes the ghosts of periodic sides. Throws as make_ghosts
  /// does, if there are 2³² particles or more, and if they are a crowd of grains (crowd.hpp).
  template <class P>
  void update(P& particles) {
    read(particles);
    refuse_crowd(particles);
  }
  /// The first part of update(). Throws if there is no radius, and as make_ghosts() does.
  template <class P>
  void read(P& particles) {
    require_positive("UniformGrid: radius", double(radius_));
    const auto extent = make_ghosts(particles, radius_);
    const auto x = particles.with_ghosts(position);
    owned_ = particles.size();
    revision_ = particles.owned_revision();
    points_.sort_and_copy(x, extent, radius_);
    descents_ = points_.descents();
    resize_tightly(ghost_owners_, x.size() - owned_);
    for (Index g = 0; g < ghost_owners_.size(); ++g) {
      ghost_owners_[g] = particles.owner(owned_ + g);
    }
  }

  /// The second part: throws if too many grains overlap, see check_crowd().
  template <class P>
  void refuse_crowd(const P& particles) const {
    if constexpr (HasFields<P, radius_t>) {
      if (!may_be_crowd(owned_, points_.squares())) return;
      // Every pair is counted at the larger grain.
      const auto R = particles.with_ghosts(silt::radius);
      check_crowd(particles, [&](Index i, FunctionRef<void(Index)> f) {
        const Real diameter = std::min(2 * R[i], radius_);
        points_.for_each_around(points_.at(slot_of(i)), diameter, slot_of(i), [&](Index slot) {
          const Index j = points_.item_of()[slot];
          if (R[j] < R[i] || (R[j] == R[i] && j > i)) f(j);
        });
      });
    }
  }
  /// Whether the rows of all particles would take too much memory, see max_row.
  bool has_long_rows() const {
    return points_.squares() > double(max_row) * (double(owned_) + double(max_row));
  }

  /// Restores the data on which sort() depends, so that a repeated step sorts as the first time.
  void save() noexcept { saved_descents_ = descents_; }
  void restore() noexcept { descents_ = saved_descents_; }

  /// Writes or reads, for a checkpoint (core/transfer.hpp), the positions of the last update and
  /// the data on which sort() depends.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    auto descents = descents_;
    const bool is_known = transfer_update(
        archive, particles, particles.owned_revision() == revision_,
        [&](Index i) { return points_.at(slot_of(i)); }, [&] { update(particles); });
    archive("descents", descents);
    descents_ = descents;
    if (!is_known) revision_ = 0;  // particles were added or removed since
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < radius(); i is owned, r_ij = x_j − x_i.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Real reach = radius_ * radius_;
    const Index own = slot_of(i);
    const Vec x_i = points_.at(own);
    for_each_slot_around(own, [&](Index slot) {
      const Vec r_ij = points_.at(slot) - x_i;
      const Real r2 = r_ij.squaredNorm();
      if (r2 < reach) f(Index{points_.item_of()[slot]}, r_ij, std::sqrt(r2));
    });
  }

  /// f(j) for the candidates j of the owned particle i. A pair of owned particles closer than
  /// radius() is reported at one of the two, a pair of an owned particle and a ghost at the owned
  /// one. Pairs farther apart may be reported as well.
  template <class F>
  void for_each_candidate(Index i, F&& f) const {
    for_each_candidate_slot(slot_of(i), [&](Index slot) { f(Index{points_.item_of()[slot]}); });
  }

  /// Whether j is a ghost and the pair i, j an image of a pair that for_each_pair reports at the
  /// other particle.
  bool is_second_image(Index i, Index j) const noexcept {
    return j >= owned_ && ghost_owners_[j - owned_] <= i;
  }

  /// f(i, j, r_ij, r) for every pair once, in the order of the cells; i is owned, j owned or ghost.
  template <class F>
  void for_each_pair(F&& f) const {
    const Real reach = radius_ * radius_;
    for (Index own = 0; own < points_.size(); ++own) {
      const Index a = points_.item_of()[own];
      if (a >= owned_) continue;
      const Vec x_a = points_.at(own);
      for_each_candidate_slot(own, [&](Index slot) {
        const Index b = points_.item_of()[slot];
        if (is_second_image(a, b)) return;
        const Vec r_ab = points_.at(slot) - x_a;
        const Real r2 = r_ab.squaredNorm();
        if (!(r2 < reach)) return;
        if (a < b) {
          f(a, b, r_ab, std::sqrt(r2));
        } else {
          f(b, a, Vec(-r_ab), std::sqrt(r2));
        }
      });
    }
  }

  /// Fills row slot_of(i) with the neighbours of i, in the order of for_each_neighbour, or with its
  /// candidates, in the order of for_each_candidate. Pairs farther apart than the radius by a
  /// rounding error may be included. Rows of ghosts are empty.
  void build_rows(NeighbourRows& rows, Pairs pairs) const {
    rows.build(points_.size(), [&](Chunk chunk, NeighbourRows::Writer& row) {
      add_rows({.first = chunk.first, .last = chunk.last}, pairs, [](Index) { return true; }, row);
    });
  }

  /// f(set, i, js) for every owned i for which wanted(i) is true and that has neighbours; js are
  /// the indices of its neighbours, as in build_rows. For rows that are read only once. Sets of
  /// rows_together rows are processed in parallel, each by one thread in the order of the cells.
  template <class Wanted, class F>
  void for_each_row(Wanted&& wanted, F&& f) const {
    for_each_range<rows_together>(points_.size(), [&](Index first, Index last) {
      static thread_local Buffer<std::uint32_t> memory;
      RowReader<std::remove_reference_t<F>> row{f, first, points_.item_of(), memory};
      add_rows({.first = first, .last = last}, Pairs::twice, wanted, row);
    });
  }

  /// Slot of particle i, that is, its index in the order of the cells.
  Index slot_of(Index i) const noexcept { return points_.slot_of(i); }

  /// Number of bins of the grid; at most a small multiple of the number of particles.
  Index bins() const noexcept { return points_.start().empty() ? 0 : points_.cells().bins(); }

  /// Owned particles in cell order, for Particles::reorder.
  Buffer<Index> order() const {
    Buffer<Index> order;
    order.reserve(owned_);
    for (const Index i : points_.item_of()) {
      if (i < owned_) order.push_back(i);
    }
    return order;
  }

 private:
  // Fewer particles fit into the cache in any order.
  static constexpr Index worth_sorting = 1024;
  // Number of particles that justifies sharing candidates, and maximum number of cells in a block.
  static constexpr Index shared_by = 12;
  static constexpr std::int64_t longest_block = 12;
  // Entries for which space is requested at once.
  static constexpr Index largest_room = Index{1} << 17;

  bool has_ghosts() const noexcept { return !ghost_owners_.empty(); }

  // A pair of owned particles is reported at the one in the lower slot, others at the owned one.
  bool is_reported_at(Index own, Index j) const { return j >= owned_ || own < slot_of(j); }

  template <class F>
  void for_each_slot_around(Index own, F&& f) const {
    points_.for_each_around(points_.at(own), radius_, own, f);
  }

  template <class F>
  void for_each_candidate_slot(Index own, F&& f) const {
    if (has_ghosts() || points_.cells().shared()) {
      for_each_slot_around(own, [&](Index slot) {
        if (is_reported_at(own, points_.item_of()[slot])) f(slot);
      });
    } else {
      points_.for_each_forward(own, radius_, f);
    }
  }

  // The slots [first, last).
  struct Slots {
    Index first;
    Index last;
  };

  // Writes the rows of the wanted particles, and empty ones for all others and for ghosts.
  template <class Wanted, class Row>
  void add_rows(Slots slots, Pairs pairs, const Wanted& wanted, Row& row) const {
    // Static for its memory only; the contents are replaced for every block.
    static thread_local SharedCandidates<Dim, Real> candidates;
    const auto has_row = [&](Index slot) {
      const Index i = points_.item_of()[slot];
      return i < owned_ && wanted(i);
    };
    for (Index slot = slots.first; slot < slots.last;) {
      if (points_.cells().shared()) {
        add_row(slot, pairs, has_row(slot), row);
        ++slot;
      } else {
        slot = add_rows_of_block(slot, slots.last, pairs, has_row, candidates, row);
      }
    }
  }

  // Writes the rows of the block that begins at this slot; returns the end of the block.
  template <class HasRow, class Row>
  Index add_rows_of_block(Index first, Index limit, Pairs pairs, const HasRow& has_row,
                          SharedCandidates<Dim, Real>& candidates, Row& row) const {
    const auto items = points_.item_of();
    const auto start = points_.start();
    // As many cells in a row as are needed to have enough particles for sharing.
    const Index bin = points_.cells().bin_in_extent(points_.at(first));
    const Index longest = points_.cells().max_block(points_.at(first), longest_block);
    Index length = 1;
    while (length < longest && start[bin + length] < first + shared_by) ++length;
    const Index last = std::min<Index>(start[bin + length], limit);
    Index rows = 0;
    for (Index slot = first; slot < last; ++slot) rows += has_row(slot);

    candidates.begin(points_.columns(), items.data(), first, last, radius_);
    const auto add = [&](Index from, Index to) { candidates.add(start[from], start[to]); };
    const bool forward = pairs == Pairs::once && !has_ghosts();
    if (rows > 0 && forward) {
      points_.cells().for_each_range_forward(bin, length, add);
    } else if (rows > 0) {
      points_.cells().for_each_range_around(bin, length, add);
    }
    candidates.end();
    // Space for all rows at once takes less time, but in a crowd most of it would remain unused.
    const bool at_once = rows * candidates.size() <= largest_room;
    std::uint32_t* to =
        row.room((at_once ? rows : Index{1}) * candidates.size() + simd::most_lanes<float>);
    for (Index slot = first; slot < last; ++slot) {
      if (has_row(slot)) {
        if (!at_once) to = row.room(candidates.size() + simd::most_lanes<float>);
        std::uint32_t* const begin = to;
        to = forward ? candidates.template near<true>(slot, begin)
                     : candidates.template near<false>(slot, begin);
        if (pairs == Pairs::once && !forward) to = remove_others(slot, begin, to);
      }
      row.end_row(to);
    }
    return last;
  }

  std::uint32_t* remove_others(Index own, std::uint32_t* begin, std::uint32_t* end) const {
    return std::remove_if(begin, end, [&](std::uint32_t j) { return !is_reported_at(own, j); });
  }

  // Writes one row without sharing. If distant cells share bins, the particles of a block may be
  // far apart.
  template <class Row>
  void add_row(Index slot, Pairs pairs, bool has_row, Row& row) const {
    const Index i = points_.item_of()[slot];
    std::uint32_t* to = row.room(1);
    const auto add = [&](Index j) {
      to = row.room(1, to);
      *to++ = static_cast<std::uint32_t>(j);
    };
    if (has_row && pairs == Pairs::once) {
      for_each_candidate(i, add);
    } else if (has_row) {
      for_each_slot_around(slot, [&](Index other) { add(points_.item_of()[other]); });
    }
    row.end_row(to);
  }

  Real radius_ = 0;
  Index owned_ = 0;
  std::uint64_t revision_ = 0;  // of the particles at the last update
  Index descents_ = 0;          // of their cells at the last update, ghosts included
  Index saved_descents_ = 0;
  SortedCells<Dim, Real> points_;
  Buffer<Index> ghost_owners_;
};

}  // namespace silt
