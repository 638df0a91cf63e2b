// SPDX-License-Identifier: MIT
// Points sorted into cells, so that all points near a given one are in a few ranges of memory. See
// cells.hpp for the cells, bin_sort.hpp for the sort.
//
//   slots      0    1    2    3  …       points in cell order
//   x          x3   x0   x7   x1 …       one column per coordinate, for SIMD
//   item       3    0    7    1  …       their indices before sorting
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/search/bin_sort.hpp>
#include <silt/search/cells.hpp>
#include <silt/search/extent.hpp>
#include <silt/search/points.hpp>
#include <silt/search/slots_near.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace silt {

/// Points with their cells.
template <int Dim, class Real>
class SortedCells {
 public:
  using Vec = silt::Vec<Dim, Real>;
  using Extent = silt::Extent<Dim, Real>;
  using Points = silt::Points<Dim, Real>;
  /// Called for slots, many at once.
  using UseSlots = FunctionRef<void(std::span<const std::uint32_t>)>;

  /// Sorts points in this finite extent into cells whose edge is `reach` [m]. Throws if there are
  /// 2³² or more.
  void sort(const Points& x, const Extent& extent, Real reach) {
    sort(x, extent, reach, [](Chunk) {});
  }

  /// The same, and copies the points [m] into their slots.
  void sort_and_copy(const Points& x, const Extent& extent, Real reach) {
    for (auto& column : x_) resize_tightly(column, x.size() + simd::most_lanes<Real>);
    const auto copy = [&](Index item, Index slot) {
      const Vec point = x[item];
      for (std::size_t k = 0; k < Dim; ++k) x_[k][slot] = point[static_cast<int>(k)];
    };
    // Points that are in order already are copied while they are in cache.
    sort(x, extent, reach, [&](Chunk chunk) {
      for (Index i = chunk.first; i < chunk.last; ++i) copy(i, i);
    });
    if (descents() == 0) return;
    for_each(x.size(), [&](Index slot) { copy(item_of()[slot], slot); });
  }

  Index size() const noexcept { return order_.size(); }
  /// Number of points in a lower bin than the previous point.
  Index descents() const noexcept { return order_.descents(); }
  /// Sum of m² over all bins with m points [-]; if none has 31 or more, it may be 0 instead.
  double squares() const { return order_.squares(); }
  const Cells<Dim, Real>& cells() const noexcept { return cells_; }
  /// First slot of each bin, and the number of points.
  std::span<const std::uint32_t> start() const noexcept { return order_.start(); }
  /// The point in each slot.
  std::span<const std::uint32_t> item_of() const noexcept { return order_.item_of(); }
  /// The slot of a point.
  Index slot_of(Index item) const noexcept { return order_.slot_of()[item]; }

  /// The point in a slot [m]. Only after sort_and_copy().
  Vec at(Index slot) const {
    Vec x;
    for (std::size_t k = 0; k < Dim; ++k) x[static_cast<int>(k)] = x_[k][slot];
    return x;
  }
  /// Coordinates by slot; they may be read up to one register beyond their end.
  simd::Columns<Dim, Real> columns() const {
    simd::Columns<Dim, Real> columns;
    for (std::size_t k = 0; k < Dim; ++k) columns[k] = x_[k].data();
    return columns;
  }

  /// f(slot) for every slot except `own` closer to x than `distance` [m]; slots farther by a
  /// rounding error may be included.
  template <class F>
  void for_each_around(const Vec& x, Real distance, Index own, F&& f) const {
    find_around(x, distance, own, [&f](std::span<const std::uint32_t> slots) {
      for (const Index slot : slots) f(slot);
    });
  }
  /// The same, with one call for many slots.
  void find_around(const Vec& x, Real distance, Index own, UseSlots use) const {
    Near near(columns(), x, distance, own, use);
    const auto collect = [&](Index first, Index last) {
      near.collect(start()[first], start()[last]);
    };
    if (distance <= reach_) {
      cells_.for_each_range_around(cells_.bin_of(x), 1, collect);
    } else {
      cells_.for_each_range_within(x, distance, collect);
    }
    near.flush();
  }

  /// The same for the slots after `own`, around its point, if `distance` [m] does not exceed the
  /// edge of a cell and no bins are shared.
  template <class F>
  void for_each_forward(Index own, Real distance, F&& f) const {
    find_forward(own, distance, [&f](std::span<const std::uint32_t> slots) {
      for (const Index slot : slots) f(slot);
    });
  }
  /// The same, with one call for many slots.
  void find_forward(Index own, Real distance, UseSlots use) const {
    const Vec x = at(own);
    Near near(columns(), x, distance, own, use);
    cells_.for_each_range_forward(cells_.bin_in_extent(x), 1, [&](Index first, Index last) {
      near.collect(std::max<Index>(start()[first], own + 1), start()[last]);
    });
    near.flush();
  }

 private:
  // in_order(chunk) is called for chunks of points that are in order, see BinSort.
  void sort(const Points& x, const Extent& extent, Real reach, FunctionRef<void(Chunk)> in_order) {
    if (x.size() >= std::numeric_limits<std::uint32_t>::max()) {
      fail({"search: ", x.size(),
            " particles and ghosts exceed the limit of 2^32 - 2; reduce their number"});
    }
    reach_ = reach;
    cells_.set_up(extent, x.size(), reach);
    const auto bins_of = [&](Chunk chunk, std::uint32_t* bin) {
      if (cells_.shared()) {
        for (Index i = chunk.first; i < chunk.last; ++i) {
          *bin++ = static_cast<std::uint32_t>(cells_.bin_of(x[i]));
        }
      } else {
        for (Index i = chunk.first; i < chunk.last; ++i) *bin++ = cells_.bin_in_extent(x[i]);
      }
    };
    order_.sort(x.size(), cells_.bins(), bins_of, in_order);
  }

  // A branch on the distance would be mispredicted and take longer than computing it. Slots are
  // therefore collected without a branch and passed on in batches.
  struct Near {
    static constexpr Index capacity = 256;
    static constexpr Index piece = 128;

    Near(const simd::Columns<Dim, Real>& columns, const Vec& middle, Real distance, Index own_slot,
         UseSlots use_slots)
        : x(columns), own(static_cast<std::uint32_t>(own_slot)), use(use_slots) {
      for (std::size_t k = 0; k < Dim; ++k) centre[k] = middle[static_cast<int>(k)];
      reach = squared(distance) * (1 + 8 * std::numeric_limits<Real>::epsilon());
    }

    void collect(Index first, Index last) {
      for (; first < last; first += piece) {
        if (count > capacity - piece) flush();
        const Index end = std::min(last, first + piece);
        const auto* const end_of_near =
            find(x, first, end, centre, reach, own, slots_near.data() + count);
        count = static_cast<Index>(end_of_near - slots_near.data());
      }
    }
    void flush() {
      if (count > 0) use({slots_near.data(), count});
      count = 0;
    }

    simd::Columns<Dim, Real> x;
    std::uint32_t own;
    UseSlots use;
    detail::SlotsNear<Dim, Real>* find = detail::slots_near<Dim, Real>();
    std::array<Real, Dim> centre;
    Real reach;
    std::array<std::uint32_t, capacity + simd::most_lanes<Real>> slots_near;
    Index count = 0;
  };

  Real reach_ = 0;
  Cells<Dim, Real> cells_;
  BinSort order_;
  std::array<Buffer<Real>, Dim> x_;  // by slot
};

}  // namespace silt
