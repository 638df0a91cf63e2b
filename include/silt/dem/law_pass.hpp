// SPDX-License-Identifier: MIT
// The near contacts through the law, a chunk at a time.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact_lanes.hpp>
#include <silt/dem/near_contacts.hpp>
#include <silt/dem/touches.hpp>
#include <silt/dem/walls.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

namespace silt::dem {

/// Looks at the near contacts of a chunk of grains, eight at a time, and keeps the law's answer for those that touch.
/// ask(eight, contacts, touching) asks it: for lane l if bit l is set; the others may be asked as well.
///
/// Eight of which most touch are asked as they lie; where few do, they are collected to full eights.
template <class P, class Found, class Walls, class Ask>
class LawPass {
  using Real = typename P::Real;
  using Lanes = typename Found::Lanes;

 public:
  using Memory = std::array<Real, static_cast<std::size_t>(Lanes::padded_words)>;
  using Eight = std::array<Index, lanes>;

  /// `fresh` is the memory of a new contact; arm_share is the share of δ by which the lever arms of two
  /// grains are shorter than R, half of what it is at a wall.
  LawPass(const P& grains, Found& touches, const Walls& walls, const Memory& fresh, Real arm_share,
          const Ask& ask)
      : grains_(grains),
        near_(touches.near()),
        walls_(walls),
        seen_(touches.seen()),
        before_(touches.memories_before()),
        columns_(grains),
        fresh_(fresh),
        arm_share_(arm_share),
        ask_(&ask) {}

  /// Returns how many touch.
  Index operator()(const NearContacts::OfChunk& chunk) {
    const auto all = chunk.all();
    std::fill(seen_.at.begin() + std::ptrdiff_t(all.first),
              seen_.at.begin() + std::ptrdiff_t(all.last), Found::none);
    return through(chunk.pairs, false) + through(chunk.walls, true);
  }

 private:
  Index through(NearContacts::Range range, bool of_walls) {
    of_walls_ = of_walls;
    next_row_ = range.first;
    count_ = 0;
    for (Index c = range.first; c < range.last; c += lanes) {
      const Index filled = std::min<Index>(lanes, range.last - c);
      const std::uint32_t* const first = near_.first_places(c);
      const std::uint32_t* const second = near_.second_places(c);
      const unsigned touching = look_at(first, second) & ((1u << filled) - 1);
      if (std::popcount(touching) > lanes / 2) {
        Eight contacts;
        for (Index lane = 0; lane < lanes; ++lane) contacts[lane] = c + std::min(lane, filled - 1);
        meet(first, second, contacts, touching);
      } else {
        for (unsigned left = touching; left != 0; left &= left - 1) {
          collect(c + static_cast<Index>(std::countr_zero(left)));
        }
      }
    }
    if (collected_ > 0) meet_collected();
    return count_;
  }

  unsigned look_at(const std::uint32_t* first, const std::uint32_t* second) {
    if (!of_walls_) return eight_.look_at(columns_, first, second);
    return eight_.look_at_walls(columns_, first, second,
                                [this](std::uint32_t place, const typename P::Vec& x) {
                                  return walls_.template nearest<P::dimension, Real>(
                                      NearContacts::wall_at(place), x);
                                });
  }

  void collect(Index contact) {
    collection_[collected_++] = contact;
    if (collected_ == lanes) meet_collected();
  }
  void meet_collected() {
    std::fill(collection_.begin() + std::ptrdiff_t(collected_), collection_.end(), collection_[0]);
    std::array<std::uint32_t, lanes> first;
    std::array<std::uint32_t, lanes> second;
    for (Index lane = 0; lane < lanes; ++lane) {
      first[lane] = *near_.first_places(collection_[lane]);
      second[lane] = *near_.second_places(collection_[lane]);
    }
    look_at(first.data(), second.data());
    meet(first.data(), second.data(), collection_, (1u << collected_) - 1);
    collected_ = 0;
  }

  // Contacts that were just looked at.
  void meet(const std::uint32_t* first, const std::uint32_t* second, const Eight& contacts,
            unsigned touching) {
    if (of_walls_) {
      eight_.at_walls(columns_, first, 2 * arm_share_);
    } else {
      check_centres(contacts, touching);
      eight_.between(columns_, first, second, arm_share_);
    }
    eight_.recall([&](int lane) {
      return before_.of(contacts[static_cast<Index>(lane)], fresh_.data());
    });
    (*ask_)(eight_, contacts, touching);
    eight_.give(seen_.row(next_row_), seen_.memory(next_row_));
    for (Index lane = 0; lane < lanes; ++lane) {
      if ((touching >> lane & 1) != 0) {
        seen_.at[contacts[lane]] = static_cast<std::uint32_t>(next_row_ + lane);
      }
    }
    next_row_ += lanes;
    count_ += static_cast<Index>(std::popcount(touching));
  }

  void check_centres(const Eight& contacts, unsigned touching) const {
    const int lane = eight_.coincident(touching);
    if (lane == lanes) return;
    const Index c = contacts[static_cast<Index>(lane)];
    fail("dem::Contacts: the centres of grains " + std::to_string(near_.first_id(c)) + " and " +
             std::to_string(near_.second_id(c)) + " coincide; place them apart",
         {.particle = grains_.owner(near_.first(c)), .id = near_.first_id(c)});
  }

  const P& grains_;
  const NearContacts& near_;
  const Walls& walls_;
  typename Found::Seen& seen_;
  typename Found::Memories before_;
  typename Lanes::Columns columns_;
  Memory fresh_;
  Real arm_share_;
  const Ask* ask_;
  Lanes eight_;
  Eight collection_{};
  Index collected_ = 0;
  Index next_row_ = 0;
  Index count_ = 0;
  bool of_walls_ = false;
};

}  // namespace silt::dem
