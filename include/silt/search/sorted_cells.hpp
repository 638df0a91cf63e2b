// SPDX-License-Identifier: MIT
// Points sorted into cells, so that whoever is near stands in a few ranges of memory. See cells.hpp
// for the cells, bin_sort.hpp for the sort.
//
//   slots      0    1    2    3  …       points in cell order
//   x          x3   x0   x7   x1 …       one column per coordinate: a register loads many at once
//   item       3    0    7    1  …       their places before
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/search/bin_sort.hpp>
#include <silt/search/cells.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace silt {

template <int Dim, class Real>
class SortedCells {
 public:
  using Vec = silt::Vec<Dim, Real>;

  /// Sorts points into cells whose edge is `reach` [m]. Throws if there are 2³² or more.
  void sort(std::span<const Vec> x, Real reach) {
    if (x.size() >= std::numeric_limits<std::uint32_t>::max()) {
      fail("search: " + std::to_string(x.size()) +
           " particles and ghosts are more than 32 bits can number; divide them");
    }
    reach_ = reach;
    cells_.lay(extent_of(x), x.size(), reach);
    if (cells_.shared()) {
      order_.sort(x.size(), cells_.bins(), [&](Index i) { return cells_.bin_of(x[i]); });
    } else {
      order_.sort(x.size(), cells_.bins(), [&](Index i) { return cells_.bin_of_its_own(x[i]); });
    }
  }

  /// Puts the points that were sorted into their slots.
  void take(std::span<const Vec> x) {
    for (auto& column : x_) column.resize(x.size() + simd::lanes<Real>);
    for_each(x.size(), [&](Index slot) {
      const Vec& point = x[item_of()[slot]];
      for (std::size_t k = 0; k < Dim; ++k) x_[k][slot] = point[static_cast<int>(k)];
    });
  }

  Index size() const noexcept { return order_.size(); }
  /// How often a point lies in a lower bin than the one before it.
  Index descents() const noexcept { return order_.descents(); }
  const Cells<Dim, Real>& cells() const noexcept { return cells_; }
  /// First slot of each bin, and the number of points.
  std::span<const std::uint32_t> start() const noexcept { return order_.start(); }
  std::span<const std::uint32_t> item_of() const noexcept { return order_.item_of(); }
  Index slot_of(Index item) const noexcept { return order_.slot_of()[item]; }

  Vec at(Index slot) const {
    Vec x;
    for (std::size_t k = 0; k < Dim; ++k) x[static_cast<int>(k)] = x_[k][slot];
    return x;
  }
  /// They may be read a register beyond their end.
  simd::Columns<Dim, Real> columns() const {
    simd::Columns<Dim, Real> columns;
    for (std::size_t k = 0; k < Dim; ++k) columns[k] = x_[k].data();
    return columns;
  }

  /// f(slot) for every slot but `own` closer to x than `distance`; slots that are farther by a
  /// rounding may come as well.
  template <class F>
  void for_each_around(const Vec& x, Real distance, Index own, F&& f) const {
    Near near(columns(), x, distance, own);
    const auto note = [&](Index first, Index last) { near.note(start()[first], start()[last], f); };
    if (distance <= reach_) {
      cells_.for_each_range_around(cells_.bin_of(x), 1, note);
    } else {
      cells_.for_each_range_within(x, distance, note);
    }
    near.hand_over(f);
  }

  /// The same for the slots behind `own`, around its point; not beyond a cell, and where no bins
  /// are shared.
  template <class F>
  void for_each_onwards(Index own, Real distance, F&& f) const {
    const Vec x = at(own);
    Near near(columns(), x, distance, own);
    cells_.for_each_range_onwards(cells_.bin_of_its_own(x), 1, [&](Index first, Index last) {
      near.note(std::max<Index>(start()[first], own + 1), start()[last], f);
    });
    near.hand_over(f);
  }

 private:
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

  // Whether a distance is below the radius cannot be predicted, so that a branch would cost more
  // than the distance: what is near is noted without one, and handed over together.
  struct Near {
    static constexpr Index most = 256;
    static constexpr Index piece = 128;

    Near(const simd::Columns<Dim, Real>& columns, const Vec& middle, Real distance, Index own_slot)
        : x(columns), own(static_cast<std::uint32_t>(own_slot)) {
      for (std::size_t k = 0; k < Dim; ++k) centre[k] = middle[static_cast<int>(k)];
      reach = squared(distance) * (1 + 8 * std::numeric_limits<Real>::epsilon());
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

  Real reach_ = 0;
  Cells<Dim, Real> cells_;
  BinSort order_;
  std::array<std::vector<Real>, Dim> x_;  // by slot
  std::vector<std::array<Vec, 2>> corners_;  // of each chunk
};

}  // namespace silt
