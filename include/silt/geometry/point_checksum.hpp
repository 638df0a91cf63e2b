// SPDX-License-Identifier: MIT
// A number by which a checkpoint recognises other walls.
#pragma once

#include <silt/core/types.hpp>

#include <bit>
#include <cstdint>

namespace silt {

/// Checksum of points: FNV-1a over their coordinates.
class PointChecksum {
 public:
  /// Adds the coordinates of a point.
  template <int Dim, class Real>
  void add(const Vec<Dim, Real>& point) {
    for (int k = 0; k < Dim; ++k) add_number(double(point[k]));
  }
  /// Adds a number; 0 and −0 are the same.
  void add_number(double number) { add(std::bit_cast<std::uint64_t>(number + 0.0)); }
  /// Adds a whole number.
  void add(std::uint64_t number) {
    for (int byte = 0; byte < 8; ++byte)
      sum_ = (sum_ ^ (number >> 8 * byte & 255)) * 1099511628211u;
  }
  /// The checksum of all that was added.
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 14695981039346656037u;
};

}  // namespace silt
