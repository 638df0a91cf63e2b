// SPDX-License-Identifier: MIT
// Evaluates the law for the near contacts, one chunk at a time, in batches: the geometry of 16 times
// eight contacts, then the law for all of them, then their rows. One eight after the other would
// take half as long again, because the law reads what the geometry has just stored.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_geometry.hpp>
#include <silt/dem/contact/law_lanes.hpp>
#include <silt/dem/contact/near_contacts.hpp>

#include <array>
#include <bit>
#include <cstdint>
#include <string>

namespace silt::dem {

/// Goes through the near contacts of a chunk of grains, eight at a time, and stores the law's
/// result for those that touch. evaluate(eights, count, touching, contacts) evaluates the law for
/// lane l of eight e if bit l of touching[e] is set, and possibly for other lanes; contacts[e] are
/// its numbers. `walls` is a WallsAtTime.
///
/// A group of eight in which more than a third touch is evaluated directly; from the others, the
/// contacts that touch are collected until there are eight.
template <class P, class Found, class Walls, class Evaluate>
class LawPass {
  using Real = typename P::Real;
  using Lanes = typename Found::Lanes;
  using Row = typename Lanes::Row;
  static constexpr int eights = 16;

 public:
  using Eight = std::array<std::uint32_t, lanes>;

  /// arm_share is the fraction of δ by which the lever arms of two grains are shorter than R; at a
  /// wall it is twice as large.
  LawPass(const P& grains, Found& touches, const Walls& walls, Real arm_share,
          const Evaluate& evaluate)
      : grains_(grains),
        near_(touches.near()),
        walls_(walls),
        seen_(touches.seen()),
        before_(touches.histories_before()),
        rows_(grains),
        arm_share_(arm_share),
        evaluate_(evaluate) {}

  /// Returns how many touch.
  Index operator()(const NearContacts::OfChunk& chunk) const {
    Batch batch;
    return through<false>(chunk.pairs, batch) + through<true>(chunk.walls, batch);
  }

 private:
  struct Batch {
    std::array<Lanes, eights> lanes{};
    std::array<Eight, eights> contacts;
    std::array<unsigned, eights> touching;
    int count = 0;
    Index row = 0;  // of the first eight
  };
  // Contacts that touch, one by one, until there are eight.
  struct Collection {
    std::array<std::uint32_t, 2 * lanes> contacts;
    std::array<std::uint32_t, 2 * lanes> first;
    std::array<std::uint32_t, 2 * lanes> second;
    Index count = 0;
  };

  template <bool of_walls>
  Index through(NearContacts::Range range, Batch& batch) const {
    Collection collected;
    batch.row = range.first + Found::first_row;
    Index count = 0;
    std::uint32_t* const at = seen_.at.data();
    for (Index c = range.first; c < range.last; c += lanes) {
      const std::uint32_t* const first = near_.first_places(c);
      const std::uint32_t* const second = near_.second_places(c);
      if constexpr (!of_walls) rows_.prefetch(second + prefetched);
      Lanes& next = batch.lanes[static_cast<Index>(batch.count)];
      ContactGeometry<Lanes> geometry;
      const unsigned touching = look_at<of_walls>(geometry, first, second, next) &
                                simd::first_lanes<lanes>(range.last - c);
      const int number = std::popcount(touching);
      count += static_cast<Index>(number);
      if (number * 3 > lanes) {
        compute<of_walls>(geometry, first, second, touching, next);
        Eight& contacts = batch.contacts[static_cast<Index>(batch.count)];
        for (Index lane = 0; lane < lanes; ++lane) {
          contacts[lane] = static_cast<std::uint32_t>(c + lane);
        }
        const auto row = static_cast<std::uint32_t>(next_row(batch));
        for (unsigned lane = 0; lane < lanes; ++lane) {
          at[c + lane] = (row + lane) & (0u - (touching >> lane & 1u));
        }
        close(batch, touching);
        continue;
      }
      std::fill_n(at + c, lanes, Found::none);
      for (unsigned left = touching; left != 0; left &= left - 1) {
        const auto lane = static_cast<Index>(std::countr_zero(left));
        collected.contacts[collected.count] = static_cast<std::uint32_t>(c + lane);
        collected.first[collected.count] = first[lane];
        collected.second[collected.count] = second[lane];
        if (++collected.count == lanes) close_collected<of_walls>(batch, collected);
      }
    }
    if (collected.count > 0) close_collected<of_walls>(batch, collected);
    flush(batch);
    return count;
  }

  static constexpr Index prefetched = 4 * lanes;

  static Index next_row(const Batch& batch) {
    return batch.row + static_cast<Index>(batch.count) * lanes;
  }

  template <bool of_walls>
  [[gnu::always_inline]] unsigned look_at(ContactGeometry<Lanes>& geometry,
                                          const std::uint32_t* first, const std::uint32_t* second,
                                          Lanes& into) const {
    if constexpr (of_walls) {
      return geometry.look_at_walls(
          rows_, first, second,
          [this](std::uint32_t place, const typename P::Vec& x) {
            return walls_.nearest(NearContacts::wall_at(place), x);
          },
          into);
    } else {
      return geometry.look_at_pairs(rows_, first, second);
    }
  }

  // Computes the contacts after look_at().
  template <bool of_walls>
  [[gnu::always_inline]] void compute(const ContactGeometry<Lanes>& geometry,
                                      const std::uint32_t* first, const std::uint32_t* second,
                                      unsigned touching, Lanes& into) const {
    if constexpr (of_walls) {
      if constexpr (Walls::move) {
        geometry.compute_walls(
            rows_, first, second, 2 * arm_share_,
            [this](std::uint32_t place) { return walls_.velocity(NearContacts::wall_at(place)); },
            into);
      } else {
        geometry.compute_walls(rows_, first, second, 2 * arm_share_, nullptr, into);
      }
    } else {
      const unsigned coincident = geometry.coincident() & touching;
      if (coincident != 0) {
        const auto lane = static_cast<Index>(std::countr_zero(coincident));
        refuse(first[lane], second[lane]);
      }
      geometry.compute_pairs(rows_, first, second, arm_share_, into);
    }
  }

  template <bool of_walls>
  [[gnu::noinline]] void close_collected(Batch& batch, Collection& collected) const {
    for (Index lane = collected.count; lane < lanes; ++lane) {
      collected.contacts[lane] = collected.contacts[0];
      collected.first[lane] = collected.first[0];
      collected.second[lane] = collected.second[0];
    }
    const unsigned touching = simd::first_lanes<lanes>(collected.count);
    Lanes& next = batch.lanes[static_cast<Index>(batch.count)];
    ContactGeometry<Lanes> geometry;
    look_at<of_walls>(geometry, collected.first.data(), collected.second.data(), next);
    compute<of_walls>(geometry, collected.first.data(), collected.second.data(), touching, next);
    std::copy_n(collected.contacts.begin(), lanes,
                batch.contacts[static_cast<Index>(batch.count)].begin());
    for (Index lane = 0; lane < collected.count; ++lane) {
      seen_.at[collected.contacts[lane]] = static_cast<std::uint32_t>(next_row(batch) + lane);
    }
    collected.count = 0;
    close(batch, touching);
  }

  void close(Batch& batch, unsigned touching) const {
    batch.touching[static_cast<Index>(batch.count)] = touching;
    if (++batch.count == eights) flush(batch);
  }

  [[gnu::noinline]] void flush(Batch& batch) const {
    for (Index e = 0; e < static_cast<Index>(batch.count); ++e) recall(batch.lanes[e], batch.contacts[e]);
    evaluate_(batch.lanes.data(), batch.count, batch.touching.data(), batch.contacts.data());
    for (int e = 0; e < batch.count; ++e) {
      const Lanes& eight = batch.lanes[static_cast<Index>(e)];
      const Index row = batch.row + static_cast<Index>(e) * lanes;
      for (int k = 0; k < Row::words; k += 4) {
        rows_from(&eight.row[k], seen_.row(row) + k, Row::words);
      }
      for (int k = 0; k < Lanes::padded_words; k += 4) {
        rows_from(&eight.history[k], seen_.history(row) + k, Lanes::padded_words);
      }
    }
    batch.row = next_row(batch);
    batch.count = 0;
  }

  // Loads the histories.
  [[gnu::always_inline]] void recall(Lanes& eight, const Eight& contacts) const {
    constexpr int N = GrainRows<P::dimension, Real>::N;
    for (int p = 0; p < lanes / N; ++p) {
      for (int k = 0; k < Lanes::words; k += 4) {
        simd::Pack<Real, N> four[4];
        columns_from<Real, N>(
            [&](int lane) {
              return before_.of(contacts[static_cast<Index>(p * N + lane)]) + k;
            },
            four);
        for (int m = 0; m < 4; ++m) simd::store<Real, N>(eight.history[k + m] + p * N, four[m]);
      }
    }
  }

  [[noreturn, gnu::cold, gnu::noinline]] void refuse(std::uint32_t i, std::uint32_t j) const {
    fail("dem::Contacts: the centres of grains " + std::to_string(grains_.id(i)) + " and " +
             std::to_string(grains_.id(j)) + " coincide; place them apart",
         {.particle = grains_.owner(i), .id = grains_.id(i)});
  }

  const P& grains_;
  const NearContacts& near_;
  const Walls& walls_;
  typename Found::Seen& seen_;
  typename Found::Histories before_;
  GrainRows<P::dimension, Real> rows_;
  Real arm_share_;
  const Evaluate& evaluate_;
};

}  // namespace silt::dem
