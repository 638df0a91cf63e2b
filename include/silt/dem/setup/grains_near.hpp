// SPDX-License-Identifier: MIT
// The grains near a region to which others are added. They are found once for many steps of an
// inflow.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace silt::dem::detail {

/// Grains that may overlap one that is added within bounds. All are looked at only when they may
/// have changed or moved far.
template <int Dim, class Real>
class GrainsNear {
 public:
  /// `largest` is the radius of the largest grain to be added [m].
  GrainsNear(const Box<Dim, Real>& bounds, double largest)
      : bounds_(bounds), largest_(Real(largest)) {}

  /// Their indices, also of grains whose position or radius is not valid. Those of grains that are
  /// no longer near may be among them.
  template <class P>
  std::span<const Index> find(const P& grains) {
    const bool is_known = rows_ == grains.rows_revision() &&
                          constants_ == grains.constants_revision() &&
                          grains.travel().is_within(double(largest_), since_);
    if (!is_known) {
      near_.clear();
      number_ = 0;
    }
    const auto x = grains[position];
    const auto R = grains[radius];
    const auto added = silt::detail::reduce_chunks<Buffer<Index>>(
        grains.size() - number_, {},
        [&](Chunk chunk, Buffer<Index>& result) {
          for (Index i = number_ + chunk.first; i < number_ + chunk.last; ++i) {
            // The grain, and the distance that it may travel.
            if (may_be_within(x[i], R[i] + 2 * largest_, grains.box())) result.push_back(i);
          }
        },
        [](Buffer<Index>& all, const Buffer<Index>& of_chunk) { all.append(of_chunk); });
    near_.append(added);
    number_ = grains.size();
    if (!is_known) {
      rows_ = grains.rows_revision();
      constants_ = grains.constants_revision();
      since_ = grains.travel();
    }
    return near_;
  }

 private:
  // Whether x or an image of it is closer to the bounds than this [m].
  bool may_be_within(const Vec<Dim, Real>& x, Real distance, const Box<Dim, Real>& box) const {
    if (!(distance > 0)) return true;
    for (int k = 0; k < Dim; ++k) {
      Real from_lower = x[k] - (bounds_.lower[k] - distance);
      Real from_upper = bounds_.upper[k] + distance - x[k];
      if (box.periodic[static_cast<std::size_t>(k)]) {
        const Real side = box.upper[k] - box.lower[k];
        const Real rounding = 8 * std::numeric_limits<Real>::epsilon() * (std::abs(x[k]) + side);
        const Real width = from_lower + from_upper;
        from_lower -= side * std::floor((from_lower + rounding) / side) - rounding;
        from_upper = width - from_lower + 2 * rounding;
      }
      if (from_lower < 0 || from_upper < 0) return false;
    }
    return true;
  }

  Box<Dim, Real> bounds_;
  Real largest_;
  Buffer<Index> near_;
  Index number_ = 0;        // of grains that were looked at
  std::uint64_t rows_ = 0;  // revisions of the grains then
  std::uint64_t constants_ = 0;
  Travel since_;
};

}  // namespace silt::dem::detail
