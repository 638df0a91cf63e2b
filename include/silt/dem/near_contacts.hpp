// SPDX-License-Identifier: MIT
// The pairs that touch or soon may, with what the law remembers of each. They are found anew only when
// grains have moved; until then a step just goes through them, eight at a time:
//
//   contact    0   1   2 …           pairs, then (from a multiple of eight) grains at walls
//   first    [ 3   3   5 …           the one with the lower id
//   second   [ 9   4   9 …           the other, owned or ghost; the number of the wall
//   memory   [ words of contacts 0–7 | of 8–15 | …
//
// Each grain has a list of its contacts, sorted by the partner's id, walls last: its sums run in
// that order, so that neither the search nor the order in memory shows in them.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/pair_memory.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/grain_columns.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

template <class RealType, int words>
class NearContacts {
 public:
  using Real = RealType;
  using Words = std::array<Real, words>;

  /// A contact as one of its grains sees it.
  class Part {
   public:
    Part() = default;
    Part(Index contact, bool is_second)
        : number_(static_cast<std::uint32_t>(2 * contact) + static_cast<std::uint32_t>(is_second)) {}
    Index contact() const { return number_ / 2; }
    bool is_second() const { return number_ % 2 == 1; }

   private:
    std::uint32_t number_;
  };
  struct Pair {
    std::uint32_t first;
    std::uint32_t second;
  };

  /// Contacts, those that fill up the last eights included.
  Index size() const noexcept { return first_.size(); }
  Index groups() const noexcept { return first_.size() / lanes; }
  bool is_of_walls(Index group) const noexcept { return group * lanes >= walls_begin_; }
  /// How many of the eight are contacts.
  int filled(Index group) const noexcept {
    const Index begin = group * lanes;
    const Index end = is_of_walls(group) ? walls_begin_ + walls_ : pairs_;
    return static_cast<int>(std::min<Index>(lanes, end - begin));
  }
  const std::uint32_t* first(Index group) const noexcept { return &first_[group * lanes]; }
  const std::uint32_t* second(Index group) const noexcept { return &second_[group * lanes]; }

  bool is_contact(Index c) const noexcept {
    return c < pairs_ || (c >= walls_begin_ && c < walls_begin_ + walls_);
  }
  Index first_place(Index c) const noexcept { return first_[c]; }
  Index second_place(Index c) const noexcept { return second_[c]; }

  Real* memory(Index group) noexcept { return memory_.data() + group * lanes * words; }
  const Real* memory(Index group) const noexcept { return memory_.data() + group * lanes * words; }
  /// Where the memory of the next step is put, to be made the current one by a swap.
  Real* next_memory(Index group) noexcept { return next_memory_.data() + group * lanes * words; }
  void make_room_for_next_memory() { next_memory_.resize(memory_.size()); }
  void swap_memory() noexcept { memory_.swap(next_memory_); }

  /// Contacts of owned grain i.
  std::span<const Part> of(Index i) const noexcept {
    return std::span(parts_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

  /// One that will be asked for soon, after those of a grain.
  Part soon_after(std::span<const Part> parts) const noexcept { return *(parts.data() + 16); }

  /// Id of the grain at a place when the contacts were found.
  Id id(std::uint32_t place) const noexcept { return ids_[place]; }
  Id first_id(Index contact) const noexcept { return ids_[first_[contact]]; }
  Id second_id(Index contact) const noexcept {
    return contact < walls_begin_ ? ids_[second_[contact]] : wall_id(second_[contact]);
  }

  /// Finds all anew: pairs_at(i, add(Pair)) and walls_at(i, add(number)) tell those found at owned
  /// grain i. recall(first id, second id, words) puts what is known of a pair in place of `fresh`.
  template <class P, class PairsAt, class WallsAt, class Recall>
  void find_all(const P& grains, PairsAt&& pairs_at, WallsAt&& walls_at, const Words& fresh,
                Recall&& recall) {
    const Index owned = grains.size();
    pair_rows_.build(owned, pairs_at);
    wall_rows_.build(owned, walls_at);
    ids_.resize(grains.total());
    for_each(ids_.size(), [&](Index i) { ids_[i] = grains.id(i); });
    line_up(owned);
    list_parts(grains);
    fill_memory(fresh, recall);
  }

  /// Puts what is remembered of the pair of ids, the lower one first, into `own`, if they are near.
  /// Takes a call of tabulate() before.
  void recall(Id a, Id b, Words& own) const noexcept {
    const Index place = place_of(a);
    if (place == nowhere) return;
    for (const Part part : of(place)) {
      if (part.is_second() || second_id(part.contact()) != b) continue;
      const Real* const known = memory_of(part.contact());
      for (int k = 0; k < words; ++k) own[static_cast<std::size_t>(k)] = known[k * lanes];
    }
  }
  void tabulate() {
    const Index owned = begin_.empty() ? 0 : begin_.size() - 1;
    Id highest = 0;
    for (Index i = 0; i < owned; ++i) highest = std::max(highest, ids_[i]);
    places_.assign(owned == 0 ? 0 : highest + 1, none);
    for_each(owned, [&](Index i) { places_[ids_[i]] = static_cast<std::uint32_t>(i); });
  }

 private:
  Real* memory_of(Index contact) noexcept { return memory(contact / lanes) + contact % lanes; }
  const Real* memory_of(Index contact) const noexcept {
    return memory(contact / lanes) + contact % lanes;
  }

  static Index full_eights(Index n) { return (n + lanes - 1) / lanes * lanes; }

  void line_up(Index owned) {
    pairs_ = pair_rows_.items().size();
    walls_ = wall_rows_.items().size();
    walls_begin_ = full_eights(pairs_);
    const Index all = walls_begin_ + full_eights(walls_);
    if (all >= Index(1) << 31) {
      fail("dem::Contacts: " + std::to_string(all) +
           " pairs of grains are near each other, more than 2^31; use fewer grains");
    }
    first_.resize(all);
    second_.resize(all);
    for_each(pairs_, [&](Index c) {
      first_[c] = pair_rows_.items()[c].first;
      second_[c] = pair_rows_.items()[c].second;
    });
    for_each(owned, [&](Index i) {
      const Index row = wall_rows_.first()[i];
      for (Index k = row; k < wall_rows_.first()[i + 1]; ++k) {
        first_[walls_begin_ + k] = static_cast<std::uint32_t>(i);
        second_[walls_begin_ + k] = wall_rows_.items()[k];
      }
    });
    const auto fill_up = [&](Index from, Index to) {
      for (Index c = from; c < to; ++c) first_[c] = second_[c] = 0;
    };
    fill_up(pairs_, walls_begin_);
    fill_up(walls_begin_ + walls_, all);
  }

  template <class P>
  void list_parts(const P& grains) {
    const Index owned = grains.size();
    begin_.assign(owned + 1, 0);
    const auto for_each_part = [&](auto&& f) {
      for (Index c = 0; c < pairs_; ++c) {
        f(grains.owner(first_[c]), c, false);
        f(grains.owner(second_[c]), c, true);
      }
      for (Index c = walls_begin_; c < walls_begin_ + walls_; ++c) f(first_[c], c, false);
    };
    for_each_part([&](Index i, Index, bool) { ++begin_[i + 1]; });
    for (Index i = 0; i < owned; ++i) begin_[i + 1] += begin_[i];
    parts_.resize(begin_[owned]);
    parts_.resize(begin_[owned] + 17, Part(0, false));  // room to look ahead
    for_each_part([&](Index i, Index c, bool is_second) { parts_[begin_[i]++] = {c, is_second}; });
    for (Index i = owned; i > 0; --i) begin_[i] = begin_[i - 1];
    begin_[0] = 0;
    for_each(owned, [&](Index i) {
      const auto partner = [&](Part part) {
        return part.is_second() ? first_id(part.contact()) : second_id(part.contact());
      };
      std::sort(parts_.begin() + begin_[i], parts_.begin() + begin_[i + 1],
                [&](Part a, Part b) { return partner(a) < partner(b); });
    });
  }

  template <class Recall>
  void fill_memory(const Words& fresh, Recall&& recall) {
    memory_.resize(size() * words);
    for_each(groups(), [&](Index g) {
      for (int lane = 0; lane < lanes; ++lane) {
        Words own = fresh;
        const Index c = g * lanes + static_cast<Index>(lane);
        if (lane < filled(g)) recall(first_id(c), second_id(c), own);
        for (int k = 0; k < words; ++k) memory_of(c)[k * lanes] = own[static_cast<std::size_t>(k)];
      }
    });
  }

  static constexpr std::uint32_t none = ~std::uint32_t(0);
  Index place_of(Id id) const noexcept {
    return id < places_.size() && places_[id] != none ? places_[id] : nowhere;
  }

  Index pairs_ = 0;
  Index walls_ = 0;
  Index walls_begin_ = 0;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> second_;
  std::vector<Real> memory_;
  std::vector<Real> next_memory_;
  std::vector<std::uint32_t> begin_;  // by owned grain
  std::vector<Part> parts_;
  std::vector<Id> ids_;  // by place
  std::vector<std::uint32_t> places_;  // by id
  Rows<Pair> pair_rows_;
  Rows<std::uint32_t> wall_rows_;
};

}  // namespace silt::dem
