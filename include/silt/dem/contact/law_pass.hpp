// SPDX-License-Identifier: MIT
// Evaluates the law for the near contacts, one chunk at a time.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_lanes.hpp>
#include <silt/dem/contact/near_contacts.hpp>
#include <silt/dem/contact/touches.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

namespace silt::dem {

/// Goes through the near contacts of a chunk of grains, eight at a time, and stores the law's
/// result for those that touch. ask(eight, contacts, touching) evaluates the law for lane l if bit
/// l is set, and possibly for other lanes. `walls` is a WallsAtTime.
///
/// A group of eight in which more than half touch is evaluated directly; otherwise the contacts
/// that touch are collected until there are eight.
template <class P, class Found, class Walls, class Ask>
class LawPass {
  using Real = typename P::Real;
  using Lanes = typename Found::Lanes;

 public:
  using Eight = std::array<Index, lanes>;

  /// arm_share is the fraction of δ by which the lever arms of two grains are shorter than R; at a
  /// wall it is twice as large.
  LawPass(const P& grains, Found& touches, const Walls& walls, Real arm_share, const Ask& ask)
      : grains_(grains),
        near_(touches.near()),
        walls_(walls),
        seen_(touches.seen()),
        before_(touches.histories_before()),
        columns_(grains),
        arm_share_(arm_share),
        ask_(ask) {}

  /// Returns how many touch.
  Index operator()(const NearContacts::OfChunk& chunk) const {
    return through<false>(chunk.pairs) + through<true>(chunk.walls);
  }

 private:
  // Contacts that touch, one by one, until there are eight.
  struct Collection {
    Eight contacts;
    std::array<std::uint32_t, lanes> first;
    std::array<std::uint32_t, lanes> second;
    Index count = 0;
  };

  template <bool of_walls>
  Index through(NearContacts::Range range) const {
    Lanes eight;
    Collection collected;
    Index row = range.first + Found::first_row;
    Index count = 0;
    std::uint32_t* const at = seen_.at.data();
    for (Index c = range.first; c < range.last; c += lanes) {
      const std::uint32_t* const first = near_.first_places(c);
      const std::uint32_t* const second = near_.second_places(c);
      const unsigned touching =
          look_at<of_walls>(eight, first, second) & simd::first_lanes<lanes>(range.last - c);
      const int number = std::popcount(touching);
      count += static_cast<Index>(number);
      if (number > lanes / 2) {
        Eight contacts;
        for (Index lane = 0; lane < lanes; ++lane) contacts[lane] = c + lane;
        meet<of_walls>(eight, first, second, contacts, touching, row);
        for (Index lane = 0; lane < lanes; ++lane) {
          const bool touches = (touching >> lane & 1) != 0;
          at[c + lane] = touches ? static_cast<std::uint32_t>(row + lane) : Found::none;
        }
        row += lanes;
        continue;
      }
      std::fill_n(at + c, lanes, Found::none);
      for (unsigned left = touching; left != 0; left &= left - 1) {
        const auto lane = static_cast<Index>(std::countr_zero(left));
        collected.contacts[collected.count] = c + lane;
        collected.first[collected.count] = first[lane];
        collected.second[collected.count] = second[lane];
        if (++collected.count == lanes) {
          meet_collected<of_walls>(eight, collected, row);
          row += lanes;
        }
      }
    }
    if (collected.count > 0) meet_collected<of_walls>(eight, collected, row);
    return count;
  }

  template <bool of_walls>
  [[gnu::always_inline]] unsigned look_at(Lanes& eight, const std::uint32_t* first,
                                          const std::uint32_t* second) const {
    if constexpr (of_walls) {
      return eight.look_at_walls(columns_, first, second,
                                 [this](std::uint32_t place, const typename P::Vec& x) {
                                   return walls_.nearest(NearContacts::wall_at(place), x);
                                 });
    } else {
      return eight.look_at(columns_, first, second);
    }
  }

  template <bool of_walls>
  [[gnu::noinline]] void meet_collected(Lanes& eight, Collection& collected, Index row) const {
    for (Index lane = collected.count; lane < lanes; ++lane) {
      collected.contacts[lane] = collected.contacts[0];
      collected.first[lane] = collected.first[0];
      collected.second[lane] = collected.second[0];
    }
    look_at<of_walls>(eight, collected.first.data(), collected.second.data());
    meet<of_walls>(eight, collected.first.data(), collected.second.data(), collected.contacts,
                   simd::first_lanes<lanes>(collected.count), row);
    for (Index lane = 0; lane < collected.count; ++lane) {
      seen_.at[collected.contacts[lane]] = static_cast<std::uint32_t>(row + lane);
    }
    collected.count = 0;
  }

  // Evaluates contacts after look_at(); `row` is the first of their rows.
  template <bool of_walls>
  [[gnu::always_inline]] void meet(Lanes& eight, const std::uint32_t* first,
                                   const std::uint32_t* second, const Eight& contacts,
                                   unsigned touching, Index row) const {
    if constexpr (of_walls) {
      if constexpr (Walls::move) {
        eight.meet_walls(columns_, first, second, 2 * arm_share_, [this](std::uint32_t place) {
          return walls_.velocity(NearContacts::wall_at(place));
        });
      } else {
        eight.meet_walls(columns_, first, second, 2 * arm_share_, nullptr);
      }
    } else {
      const unsigned coincident = eight.coincident() & touching;
      if (coincident != 0) refuse(contacts[static_cast<Index>(std::countr_zero(coincident))]);
      eight.meet(columns_, first, second, arm_share_);
    }
    eight.recall([&](int lane) { return before_.of(contacts[static_cast<Index>(lane)]); });
    ask_(eight, contacts, touching);
    eight.give(seen_.row(row), seen_.history(row));
  }

  [[noreturn, gnu::cold, gnu::noinline]] void refuse(Index c) const {
    fail("dem::Contacts: the centres of grains " + std::to_string(near_.first_id(c)) + " and " +
             std::to_string(near_.second_id(c)) + " coincide; place them apart",
         {.particle = grains_.owner(near_.first(c)), .id = near_.first_id(c)});
  }

  const P& grains_;
  const NearContacts& near_;
  const Walls& walls_;
  typename Found::Seen& seen_;
  typename Found::Histories before_;
  typename Lanes::Columns columns_;
  Real arm_share_;
  const Ask& ask_;
};

}  // namespace silt::dem
