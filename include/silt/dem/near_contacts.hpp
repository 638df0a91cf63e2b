// SPDX-License-Identifier: MIT
// The pairs that touch or soon may. They are found anew only when grains have moved; until then a step
// just goes through them:
//
//   contact    0   1   2 …           pairs, then (from a multiple of chunk_size) grains at walls
//   first    [ 3   3   5 …           the one with the lower id
//   second   [ 9   4   9 …           the other, owned or ghost; the number of the wall
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
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace silt::dem {

class NearContacts {
 public:
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

  /// Contacts, with the gap before those with walls.
  Index size() const noexcept { return walls_begin_ + walls_; }
  bool is_of_wall(Index contact) const noexcept { return contact >= walls_begin_; }
  /// Those of a chunk of size(): all pairs, or all with walls, without the gap.
  Chunk without_gap(Chunk chunk) const noexcept {
    if (!is_of_wall(chunk.first)) chunk.last = std::min(chunk.last, pairs_);
    return chunk;
  }
  /// Places of the two; may be read up to seven beyond a chunk.
  std::uint32_t first(Index contact) const noexcept { return first_[contact]; }
  std::uint32_t second(Index contact) const noexcept { return second_[contact]; }
  const std::uint32_t* firsts(Index from) const noexcept { return &first_[from]; }
  const std::uint32_t* seconds(Index from) const noexcept { return &second_[from]; }
  /// Their ids when the contacts were found.
  Id first_id(Index contact) const noexcept { return ids_[first_[contact]]; }
  Id second_id(Index contact) const noexcept {
    return is_of_wall(contact) ? wall_id(second_[contact]) : ids_[second_[contact]];
  }

  /// f(contact) for each.
  template <class F>
  void for_each_contact(F&& f) const {
    for (Index c = 0; c < pairs_; ++c) f(c);
    for (Index c = walls_begin_; c < size(); ++c) f(c);
  }

  /// Contacts of owned grain i.
  std::span<const Part> of(Index i) const noexcept {
    return std::span(parts_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

  /// Finds all anew: pairs_at(i, add(Pair)) and walls_at(i, add(number)) tell those found at owned
  /// grain i.
  template <class P, class PairsAt, class WallsAt>
  void find_all(const P& grains, PairsAt&& pairs_at, WallsAt&& walls_at) {
    const Index owned = grains.size();
    pair_rows_.build(owned, pairs_at);
    wall_rows_.build(owned, walls_at);
    ids_.resize(grains.total());
    for_each(ids_.size(), [&](Index i) { ids_[i] = grains.id(i); });
    line_up(owned);
    list_parts(grains);
  }

  /// The contact of this pair of ids, the lower one first; `nowhere` if the two are not near. Takes a call
  /// of tabulate() before.
  Index find(Id a, Id b) const noexcept {
    if (a >= places_.size() || places_[a] == none) return nowhere;
    for (const Part part : of(places_[a])) {
      if (!part.is_second() && second_id(part.contact()) == b) return part.contact();
    }
    return nowhere;
  }
  void tabulate() {
    const Index owned = begin_.empty() ? 0 : begin_.size() - 1;
    Id highest = 0;
    for (Index i = 0; i < owned; ++i) highest = std::max(highest, ids_[i]);
    places_.assign(owned == 0 ? 0 : highest + 1, none);
    for_each(owned, [&](Index i) { places_[ids_[i]] = static_cast<std::uint32_t>(i); });
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  void line_up(Index owned) {
    pairs_ = pair_rows_.items().size();
    walls_ = wall_rows_.items().size();
    walls_begin_ = chunk_count(pairs_) * chunk_size;
    if (size() >= Index(1) << 31) {
      fail("dem::Contacts: " + std::to_string(size()) +
           " pairs of grains are near each other, more than 2^31; use fewer grains");
    }
    first_.resize(size() + lanes);
    second_.resize(size() + lanes);
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
    fill_up(size(), first_.size());
  }

  template <class P>
  void list_parts(const P& grains) {
    const Index owned = grains.size();
    begin_.assign(owned + 1, 0);
    const auto for_each_part = [&](auto&& f) {
      for_each_contact([&](Index c) {
        f(grains.owner(first_[c]), c, false);
        if (!is_of_wall(c)) f(grains.owner(second_[c]), c, true);
      });
    };
    for_each_part([&](Index i, Index, bool) { ++begin_[i + 1]; });
    for (Index i = 0; i < owned; ++i) begin_[i + 1] += begin_[i];
    parts_.resize(begin_[owned]);
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

  Index pairs_ = 0;
  Index walls_ = 0;
  Index walls_begin_ = 0;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> second_;
  std::vector<std::uint32_t> begin_;  // by owned grain
  std::vector<Part> parts_;
  std::vector<Id> ids_;                // by place
  std::vector<std::uint32_t> places_;  // by id
  Rows<Pair> pair_rows_;
  Rows<std::uint32_t> wall_rows_;
};

}  // namespace silt::dem
