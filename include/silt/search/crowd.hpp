// SPDX-License-Identifier: MIT
// Refuses grains that are placed on top of each other. Grains side by side have a dozen contacts at
// most, on average and for any sizes; n grains at one point have n²/2, and memory and time would
// grow likewise.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>

#include <atomic>
#include <limits>

namespace silt {

/// Pairs of overlapping grains for each grain, on average, that are not refused.
inline constexpr Index max_overlaps = 64;

/// Whether so many particles are so crowded that it is worth counting overlaps; `squares` is the
/// sum of m² over all cells with m particles.
inline bool may_be_crowd(Index particles, double squares) {
  return squares > 32 * (double(particles) + 128);
}

/// Throws if grains overlap with more than max_overlaps others on average. near(i, f) calls f(j),
/// where j may be a ghost, for the grains near grain i, so that every overlapping pair is reported
/// at one of the two.
template <class P>
  requires HasFields<P, radius_t>
[[gnu::cold]] void check_crowd(const P& grains,
                               FunctionRef<void(Index, FunctionRef<void(Index)>)> near) {
  const auto x = grains.with_ghosts(position);
  const auto R = grains.with_ghosts(radius);
  const auto for_each_overlap = [&](Index i, FunctionRef<void(Index, double)> f) {
    near(i, [&](Index j) {
      const double reach = double(R[i]) + double(R[j]);
      const double r2 = double((x[j] - x[i]).squaredNorm());
      if (r2 < reach * reach) f(j, r2 / (reach * reach));
    });
  };
  // Of many grains, a sample is enough for an average.
  const Index stride = grains.size() < 1024 ? 1 : 17;
  const Index samples = (grains.size() + stride - 1) / stride;
  const Index limit = samples * max_overlaps + 4096;
  std::atomic<Index> found = 0;
  for_each(samples, [&](Index k) {
    if (found.load(std::memory_order_relaxed) > limit) return;
    Index own = 0;
    for_each_overlap(k * stride, [&](Index, double) { ++own; });
    found.fetch_add(own, std::memory_order_relaxed);
  });
  if (found <= limit) return;

  for (Index i = 0; i < grains.size(); i += stride) {
    Index overlaps = 0;
    Index closest = i;
    double least = std::numeric_limits<double>::infinity();
    for_each_overlap(i, [&](Index j, double apart) {
      ++overlaps;
      if (apart >= least) return;
      least = apart;
      closest = grains.owner(j);
    });
    if (overlaps <= max_overlaps) continue;
    fail({"search: more than ", max_overlaps, " overlaps per grain: the grains with ids ",
          grains.id(i), " and ", grains.id(closest), ", at ", to_text(x[i]), " and ",
          to_text(x[closest]), " m with radii ", double(R[i]), " and ", double(R[closest]),
          " m, overlap, and so do many others; place them apart"},
         {.particle = i, .id = grains.id(i)});
  }
}

}  // namespace silt
