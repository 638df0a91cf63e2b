// SPDX-License-Identifier: MIT
// A table of pairs of points, in which those at the same places are found.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace silt {

/// A table of pairs of points, x and y, by the cells of a grid in which both are. They are numbered from 0
/// on. All calls have the same distance [m], above 0, within which places are the same.
template <int Dim>
class PlacesOfPairs {
 public:
  using Vec = silt::Vec<Dim>;

  void clear() {
    next_.clear();
    hashes_.clear();
    last_.assign(last_.size(), none);
  }
  /// Adds a pair, with the next number.
  void add(const Vec& x, const Vec& y, double same) {
    std::uint64_t hash = 0;
    const auto at = in_cells(x, y, same);
    for (const double q : at) hash = mixed(hash, std::floor(q));
    if (2 * (next_.size() + 1) > last_.size()) grow();
    hashes_.push_back(hash);
    next_.push_back(none);
    link(static_cast<std::uint32_t>(next_.size() - 1));
  }
  /// Whether f(k) for the number k of a pair of which both points are at the same places, or of some
  /// further ones.
  template <class F>
  bool any_near(const Vec& x, const Vec& y, double same, F&& f) const {
    if (next_.empty()) return false;
    const auto at = in_cells(x, y, same);
    // A place close to a side of its cell may be the same as one beyond it.
    constexpr double margin = 1.01 / cell;
    std::array<double, 2 * Dim> lower;
    unsigned have_two = 0;  // a bit for each coordinate
    for (std::size_t k = 0; k < at.size(); ++k) {
      lower[k] = std::floor(at[k] - margin);
      if (std::floor(at[k] + margin) > lower[k]) have_two |= 1u << k;
    }
    for (unsigned upper = have_two;; upper = (upper - 1) & have_two) {
      std::uint64_t hash = 0;
      for (std::size_t k = 0; k < at.size(); ++k) {
        hash = mixed(hash, lower[k] + double(upper >> k & 1u));
      }
      for (std::uint32_t k = last_[slot(hash)]; k != none; k = next_[k]) {
        if (hashes_[k] == hash && f(k)) return true;
      }
      if (upper == 0) return false;
    }
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr double cell = 1000;  // of the grid, in units of the distance

  // Coordinates of both points in cells. Corners are often at whole numbers of any length.
  static std::array<double, 2 * Dim> in_cells(const Vec& x, const Vec& y, double same) {
    std::array<double, 2 * Dim> at;
    for (int k = 0; k < Dim; ++k) {
      at[std::size_t(k)] = x[k] / (cell * same) + 0.37;
      at[std::size_t(Dim + k)] = y[k] / (cell * same) + 0.37;
    }
    return at;
  }
  static std::uint64_t mixed(std::uint64_t hash, double number) {
    hash ^= std::bit_cast<std::uint64_t>(number + 0.0);  // no −0
    hash *= 0x9e3779b97f4a7c15;
    return hash ^ hash >> 29;
  }
  std::size_t slot(std::uint64_t hash) const { return std::size_t(hash) & (last_.size() - 1); }
  void link(std::uint32_t k) {
    std::uint32_t& last = last_[slot(hashes_[k])];
    next_[k] = last;
    last = k;
  }
  void grow() {
    last_.assign(last_.empty() ? 64 : 2 * last_.size(), none);
    for (std::uint32_t k = 0; k < next_.size(); ++k) link(k);
  }

  Buffer<std::uint64_t> hashes_;  // of the cells of each pair
  Buffer<std::uint32_t> next_;    // pair in the same slot
  Buffer<std::uint32_t> last_;    // pair of each slot
};

}  // namespace silt
