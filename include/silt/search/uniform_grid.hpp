// SPDX-License-Identifier: MIT
// The contact search of [SahChoi2004]: particles sorted into square cells, so that whoever is near
// stands in a few ranges of memory. See cells.hpp for the cells, bin_sort.hpp for the sort.
//
//   slots      0    1    2    3  …       particles in cell order
//   x          x3   x0   x7   x1 …       one column per coordinate: a register loads many at once
//   item       3    0    7    1  …       their places among the particles
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/ghosts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/search/bin_sort.hpp>
#include <silt/search/cells.hpp>
#include <silt/search/neighbour_rows.hpp>
#include <silt/search/shared_candidates.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace silt {

/// What rows of neighbours hold: every pair at both of its particles, or at one of them.
enum class Pairs { twice, once };

template <int Dim, class RealType = double>
class UniformGrid {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    Real radius = 0;  ///< pairs closer than this are found [m]; 0: as far as the interaction reaches
  };

  UniformGrid() = default;
  /// Throws if the radius is negative or not finite.
  explicit UniformGrid(Settings settings) : radius_(settings.radius) {
    require_not_negative("UniformGrid: radius", double(radius_));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius is not positive.
  void set_radius(Real radius) {
    require_positive("UniformGrid: radius", double(radius));
    radius_ = radius;
  }
  /// Candidates reach no farther than radius() [m].
  Real margin() const noexcept { return 0; }

  /// Puts the owned particles in cell order if many of them are out of it, so that neighbours in
  /// space are neighbours in memory.
  template <class P>
  void sort(P& particles) {
    if (particles.size() < worth_sorting) return;
    // What the last update saw is new enough.
    const Index many = particles.size() / 16;
    if (particles.revision() == revision_ && sorted_.descents() <= many) return;
    require_positive("UniformGrid: radius", double(radius_));
    sort_into_cells(particles[position]);
    owned_ = particles.size();
    if (sorted_.descents() > many) particles.reorder(order());
  }

  /// Sorts the particles into cells, and makes the ghosts of periodic sides. Throws as make_ghosts
  /// does, and if there are 2³² particles or more.
  template <class P>
  void update(P& particles) {
    require_positive("UniformGrid: radius", double(radius_));
    make_ghosts(particles, radius_);
    const auto x = particles.with_ghosts(position);
    owned_ = particles.size();
    revision_ = particles.revision();
    sort_into_cells(x);
    for (auto& column : x_) column.resize(x.size() + simd::lanes<Real>);
    for_each(x.size(), [&](Index slot) {
      const Vec& at = x[sorted_.item_of()[slot]];
      for (std::size_t k = 0; k < Dim; ++k) x_[k][slot] = at[static_cast<int>(k)];
    });
    ghost_owners_.resize(x.size() - owned_);
    for (Index g = 0; g < ghost_owners_.size(); ++g) {
      ghost_owners_[g] = particles.owner(owned_ + g);
    }
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < radius(); i is owned, r_ij = x_j − x_i.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Real reach = radius_ * radius_;
    const Index own = slot_of(i);
    const Vec x_i = at(own);
    for_each_slot_around(own, [&](Index slot) {
      const Vec r_ij = at(slot) - x_i;
      const Real r2 = r_ij.squaredNorm();
      if (r2 < reach) f(Index{sorted_.item_of()[slot]}, r_ij, std::sqrt(r2));
    });
  }

  /// f(j) for some j of owned i: every pair of owned particles closer than radius() is met from one of
  /// the two, every owned one and ghost from the owned one. Others may come as well.
  template <class F>
  void for_each_candidate(Index i, F&& f) const {
    const Index own = slot_of(i);
    const auto onwards = [&](Index slot) { f(Index{sorted_.item_of()[slot]}); };
    if (has_ghosts() || cells_.shared()) {
      for_each_slot_around(own, [&](Index slot) {
        if (is_met_from(own, slot)) onwards(slot);
      });
    } else {
      for_each_slot_onwards(own, onwards);
    }
  }

  /// Whether j is a ghost, and i with it the image of a pair that counts from its other particle.
  bool is_second_image(Index i, Index j) const noexcept {
    return j >= owned_ && ghost_owners_[j - owned_] <= i;
  }

  /// f(i, j, r_ij, r) for every pair once; i is owned, j owned or ghost. Pairs come in the order of
  /// the cells.
  template <class F>
  void for_each_pair(F&& f) const {
    const Real reach = radius_ * radius_;
    for (Index own = 0; own < sorted_.size(); ++own) {
      const Index a = sorted_.item_of()[own];
      if (a >= owned_) continue;
      for_each_candidate(a, [&](Index b) {
        if (is_second_image(a, b)) return;
        const Vec r_ab = at(slot_of(b)) - at(own);
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

  /// Makes row slot_of(i) the neighbours of i, in the order of for_each_neighbour, or its
  /// candidates, in that of for_each_candidate. Pairs that are farther apart than the radius by a
  /// rounding may come as well. Rows of ghosts are empty.
  void build_rows(NeighbourRows& rows, Pairs pairs) const {
    rows.build(sorted_.size(), [&](Chunk chunk, NeighbourRows::Writer& row) {
      add_rows(chunk, pairs, [](Index) { return true; }, row);
    });
  }

  /// f(chunk, i, js) for every owned i that is wanted(i), js being the indices of its neighbours as
  /// build_rows finds them: for rows that are read once. Several chunks at a time, each by one
  /// thread and in the order of the cells.
  template <class Wanted, class F>
  void for_each_row(Wanted&& wanted, F&& f) const {
    for_each_chunk(sorted_.size(), [&](Chunk chunk) {
      static thread_local std::vector<std::uint32_t> memory;
      RowReader<std::remove_reference_t<F>> row{f, sorted_.item_of().data(), chunk, memory};
      add_rows(chunk, Pairs::twice, wanted, row);
    });
  }

  /// Place of particle i in the order of the cells.
  Index slot_of(Index i) const noexcept { return sorted_.slot_of()[i]; }

  /// Bins of the grid: at most a small multiple of the number of particles.
  Index bins() const noexcept { return sorted_.start().empty() ? 0 : cells_.bins(); }

  /// Owned particles in cell order: what Particles::reorder takes so that neighbours in space become
  /// neighbours in memory.
  std::vector<Index> order() const {
    std::vector<Index> order;
    order.reserve(owned_);
    for (const Index i : sorted_.item_of()) {
      if (i < owned_) order.push_back(i);
    }
    return order;
  }

 private:
  // Fewer particles fit into a cache in any order.
  static constexpr Index worth_sorting = 1024;
  // Particles that are enough to share candidates, and cells that are still close together.
  static constexpr Index shared_by = 8;
  static constexpr std::int64_t longest_block = 4;

  void sort_into_cells(std::span<const Vec> x) {
    if (x.size() >= std::numeric_limits<std::uint32_t>::max()) {
      fail("UniformGrid: " + std::to_string(x.size()) +
           " particles and ghosts are more than 32 bits can number; divide them");
    }
    cells_.lay(extent_of(x), x.size(), radius_);
    if (cells_.shared()) {
      sorted_.sort(x.size(), cells_.bins(), [&](Index i) { return cells_.bin_of(x[i]); });
    } else {
      sorted_.sort(x.size(), cells_.bins(), [&](Index i) { return cells_.bin_of_its_own(x[i]); });
    }
  }

  typename Cells<Dim, Real>::Extent extent_of(std::span<const Vec> x) {
    if (x.empty()) return {Vec::Zero(), Vec::Zero(), Vec::Zero()};
    corners_.resize(chunk_count(x.size()));
    for_each_chunk(x.size(), [&](Chunk chunk) {
      Vec lower = x[chunk.first];
      Vec upper = lower;
      for (const Vec& at : x.subspan(chunk.first, chunk.last - chunk.first)) {
        lower = lower.cwiseMin(at);
        upper = upper.cwiseMax(at);
      }
      corners_[chunk.number] = {lower, upper};
    });
    auto [lower, upper] = corners_.front();
    for (const auto& corners : corners_) {
      lower = lower.cwiseMin(corners[0]);
      upper = upper.cwiseMax(corners[1]);
    }
    return {lower, upper, x[x.size() / 2]};
  }

  bool has_ghosts() const noexcept { return !ghost_owners_.empty(); }

  Vec at(Index slot) const {
    Vec x;
    for (std::size_t k = 0; k < Dim; ++k) x[static_cast<int>(k)] = x_[k][slot];
    return x;
  }

  simd::Columns<Dim, Real> columns() const {
    simd::Columns<Dim, Real> columns;
    for (std::size_t k = 0; k < Dim; ++k) columns[k] = x_[k].data();
    return columns;
  }

  // Of two slots one meets the other. Ghosts meet nobody; of a pair and its image the one is met
  // whose owned particle has the lower index.
  bool is_met_from(Index own, Index slot) const {
    return is_met(own, sorted_.item_of()[slot]);
  }
  bool is_met(Index own, Index j) const {
    return j >= owned_ || own < slot_of(j);
  }

  // f(slot) for every slot but `own` that lies near it, and for none much beyond the radius.
  template <class F>
  void for_each_slot_around(Index own, F&& f) const {
    Near near(*this, own);
    cells_.for_each_range_around(bin_of(own), 1, [&](Index first, Index last) {
      near.note(sorted_.start()[first], sorted_.start()[last], f);
    });
    near.hand_over(f);
  }
  template <class F>
  void for_each_slot_onwards(Index own, F&& f) const {
    Near near(*this, own);
    cells_.for_each_range_onwards(bin_of(own), 1, [&](Index first, Index last) {
      near.note(std::max<Index>(sorted_.start()[first], own + 1), sorted_.start()[last], f);
    });
    near.hand_over(f);
  }

  Index bin_of(Index slot) const { return cells_.bin_of(at(slot)); }

  // Whether a distance is below the radius cannot be predicted, so that a branch would cost more
  // than the distance: what is near is noted without one, and handed over together.
  struct Near {
    static constexpr Index most = 256;
    static constexpr Index piece = 128;

    Near(const UniformGrid& grid, Index slot)
        : x(grid.columns()), own(static_cast<std::uint32_t>(slot)) {
      for (std::size_t k = 0; k < Dim; ++k) centre[k] = x[k][own];
      reach = squared(grid.radius_) * (1 + 8 * std::numeric_limits<Real>::epsilon());
    }

    template <class F>
    void note(Index first, Index last, F&& f) {
      constexpr int N = simd::lanes<Real>;
      const auto slots = [](Index s) { return simd::count_from<N>(s); };
      for (; first < last; first += piece) {
        if (count > most - piece) hand_over(f);
        const Index end = std::min(last, first + piece);
        const auto* const noted_to =
            simd::compress_near<N>(x, first, end, centre, reach, slots, own, noted.data() + count);
        count = static_cast<Index>(noted_to - noted.data());
      }
    }
    template <class F>
    void hand_over(F&& f) {
      for (Index k = 0; k < count; ++k) f(Index{noted[k]});
      count = 0;
    }

    simd::Columns<Dim, Real> x;
    std::uint32_t own;
    std::array<Real, Dim> centre;
    Real reach;
    std::array<std::uint32_t, most + simd::lanes<Real>> noted;
    Index count = 0;
  };

  // Hands every row to f where NeighbourRows::Writer would keep it.
  template <class F>
  struct RowReader {
    F& f;
    const std::uint32_t* items;
    Chunk chunk;
    std::vector<std::uint32_t>& memory;
    Index slot = chunk.first;
    Index begin = 0;

    std::uint32_t* room(Index most) {
      begin = 0;
      return room(most, memory.data());
    }
    std::uint32_t* room(Index most, std::uint32_t* to) {
      const auto used = static_cast<Index>(to - memory.data());
      if (used + most > memory.size()) memory.resize(2 * (used + most));
      return memory.data() + used;
    }
    void end_row(const std::uint32_t* to) {
      const auto end = static_cast<Index>(to - memory.data());
      const Index i = items[slot++];
      if (end > begin) f(chunk.number, i, std::span<const std::uint32_t>(memory).subspan(begin, end - begin));
      begin = end;
    }
  };

  // Rows of the particles that are wanted, and empty ones for the others and for ghosts.
  template <class Wanted, class Row>
  void add_rows(Chunk chunk, Pairs pairs, const Wanted& wanted, Row& row) const {
    // Its memory stays warm; what it holds is made anew for every block.
    static thread_local SharedCandidates<Dim, Real> candidates;
    const auto has_row = [&](Index slot) {
      const Index i = sorted_.item_of()[slot];
      return i < owned_ && wanted(i);
    };
    for (Index slot = chunk.first; slot < chunk.last;) {
      if (cells_.shared()) {
        add_row(slot, pairs, has_row(slot), row);
        ++slot;
      } else {
        slot = add_rows_of_block(slot, chunk.last, pairs, has_row, candidates, row);
      }
    }
  }

  // Rows of the block that begins with this slot; returns the slot behind it.
  template <class HasRow, class Row>
  Index add_rows_of_block(Index first, Index limit, Pairs pairs, const HasRow& has_row,
                          SharedCandidates<Dim, Real>& candidates, Row& row) const {
    const auto items = sorted_.item_of();
    const auto start = sorted_.start();
    // A few cells in a row, until there are enough particles to share what is found.
    const Index bin = cells_.bin_of_its_own(at(first));
    const Index longest = cells_.block_from(at(first), longest_block);
    Index length = 1;
    while (length < longest && start[bin + length] < first + shared_by) ++length;
    const Index last = std::min<Index>(start[bin + length], limit);
    Index rows = 0;
    for (Index slot = first; slot < last; ++slot) rows += has_row(slot);

    candidates.begin(columns(), items.data(), first, last, radius_);
    const auto add = [&](Index from, Index to) { candidates.add(start[from], start[to]); };
    const bool onwards = pairs == Pairs::once && !has_ghosts();
    if (rows > 0 && onwards) {
      cells_.for_each_range_onwards(bin, length, add);
    } else if (rows > 0) {
      cells_.for_each_range_around(bin, length, add);
    }
    std::uint32_t* to = row.room(rows * candidates.size() + simd::lanes<float>);
    for (Index slot = first; slot < last; ++slot) {
      if (has_row(slot)) {
        std::uint32_t* const begin = to;
        to = candidates.near(slot, onwards, begin);
        if (pairs == Pairs::once && !onwards) to = keep_met(slot, begin, to);
      }
      row.end_row(to);
    }
    return last;
  }

  std::uint32_t* keep_met(Index own, std::uint32_t* begin, std::uint32_t* end) const {
    return std::remove_if(begin, end, [&](std::uint32_t j) { return !is_met(own, j); });
  }

  // One row, without sharing: where far cells share bins, a block is not small.
  template <class Row>
  void add_row(Index slot, Pairs pairs, bool has_row, Row& row) const {
    const Index i = sorted_.item_of()[slot];
    std::uint32_t* to = row.room(1);
    const auto add = [&](Index j) {
      to = row.room(1, to);
      *to++ = static_cast<std::uint32_t>(j);
    };
    if (has_row && pairs == Pairs::once) {
      for_each_candidate(i, add);
    } else if (has_row) {
      for_each_slot_around(slot, [&](Index other) { add(sorted_.item_of()[other]); });
    }
    row.end_row(to);
  }

  Real radius_ = 0;
  Index owned_ = 0;
  std::uint64_t revision_ = 0;  // of the particles at the last update
  Cells<Dim, Real> cells_;
  BinSort sorted_;
  std::array<std::vector<Real>, Dim> x_;  // by slot, and room to read a register beyond
  std::vector<Index> ghost_owners_;
  std::vector<std::array<Vec, 2>> corners_;  // of each chunk
};

}  // namespace silt
