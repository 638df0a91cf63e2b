// SPDX-License-Identifier: MIT
// The list of pairs that touch or may soon touch. It is rebuilt only after grains have moved; other
// steps just go through it:
//
//   contact    0   1   2 …           those of a chunk of grains: pairs, then grains at walls
//   first    [ 3   3   5 …           the one with the lower id
//   second   [ 9   4   9 …           the other, owned or ghost; the number of the wall
//
// A pair belongs to the chunk of the grain with the lower index. The pairs of a chunk, and its
// contacts with walls, are each padded to a multiple of eight.
//
// Each grain has a list of its contacts, sorted by the partner's id, walls last. Forces are summed
// in this order, so that they depend neither on the search nor on the order in memory.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/pair_history.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace silt::dem {

class NearContacts {
 public:
  /// A contact from the side of one of its grains.
  class Part {
   public:
    Part() = default;
    Part(Index contact, bool is_second)
        : number_(static_cast<std::uint32_t>(2 * contact) + static_cast<std::uint32_t>(is_second)) {
    }
    Index contact() const { return number_ / 2; }
    bool is_second() const { return number_ % 2 == 1; }
    /// Sign of the force on this grain relative to that on the first grain.
    template <class Real>
    Real sign() const {
      static constexpr Real signs[] = {1, -1};
      return signs[number_ % 2];
    }

   private:
    std::uint32_t number_;
  };
  struct Pair {
    std::uint32_t first;
    std::uint32_t second;
  };

  /// Number of contacts, including padding.
  Index size() const noexcept { return first_.size(); }
  bool is_of_wall(Index contact) const noexcept { return second_[contact] >= wall_bit; }
  /// Indices of the two grains, or of the wall's element.
  std::uint32_t first(Index contact) const noexcept { return first_[contact]; }
  std::uint32_t second(Index contact) const noexcept { return wall_at(second_[contact]); }
  /// The same for eight contacts; walls are marked by wall_bit.
  const std::uint32_t* first_places(Index contact) const noexcept { return &first_[contact]; }
  const std::uint32_t* second_places(Index contact) const noexcept { return &second_[contact]; }
  static std::uint32_t wall_at(std::uint32_t place) noexcept { return place & ~wall_bit; }
  /// Their ids at the rebuild.
  Id first_id(Index contact) const noexcept { return ids_[first_[contact]]; }
  Id second_id(Index contact) const noexcept {
    return is_of_wall(contact) ? wall_id(second(contact)) : ids_[second_[contact]];
  }

  /// Contacts [first, last); first is a multiple of eight.
  struct Range {
    Index first;
    Index last;
  };
  /// Those of a chunk of grains.
  struct OfChunk {
    Range pairs;
    Range walls;
    ChunkSpan needs;  ///< chunks that contain all contacts of these grains
    /// All, including padding.
    Range all() const { return {pairs.first, full_eights(walls.last)}; }
  };
  const OfChunk& of_chunk(Index number) const noexcept { return chunks_[number]; }

  /// f(contact) for each.
  template <class F>
  void for_each_contact(F&& f) const {
    for (const OfChunk& chunk : chunks_) {
      for (const Range range : {chunk.pairs, chunk.walls}) {
        for (Index c = range.first; c < range.last; ++c) f(c);
      }
    }
  }

  /// f(contact) for each, grain by grain as they lie in memory, and at each in the order of the
  /// partners' ids, which is independent of the search.
  template <class F>
  void for_each_contact_by_grain(F&& f) const {
    for (Index i = 0; i + 1 < begin_.size(); ++i) {
      for (const Part part : of(i)) {
        if (!part.is_second()) f(part.contact());
      }
    }
  }

  /// Contacts of owned grain i.
  std::span<const Part> of(Index i) const noexcept {
    return std::span(parts_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

  /// Contacts of owned grains [first, last), grain by grain.
  std::span<const Part> of(Index first, Index last) const noexcept {
    return std::span(parts_).subspan(begin_[first], begin_[last] - begin_[first]);
  }

  /// Results of the search, grain by grain, before they are put into one list.
  struct Found {
    Rows<Pair> pairs;
    Rows<std::uint32_t> walls;
    std::vector<std::vector<Pair>> strays;  ///< pairs of other chunks, by the chunk that found them
    std::vector<Index> lined_up;            ///< pairs put into the list so far, by chunk
  };
  /// Rebuilds the list: pairs_at(i, add) and walls_at(i, add) call add for each pair and each wall
  /// element found at owned grain i. The memory of `found` is reused.
  template <class P, class PairsAt, class WallsAt>
  void find_all(const P& grains, PairsAt&& pairs_at, WallsAt&& walls_at, Found& found) {
    const Index owned = grains.size();
    found.strays.resize(chunk_count(owned));
    for (auto& strays : found.strays) strays.clear();
    found.pairs.build(owned, [&](Index i, auto&& add) {
      const Index here = i / chunk_size;
      pairs_at(i, [&](const Pair& pair) {
        home_of(pair, grains) == here ? add(pair) : found.strays[here].push_back(pair);
      });
    });
    found.walls.build(owned, walls_at);
    resize_tightly(ids_, grains.total());
    for_each(ids_.size(), [&](Index i) { ids_[i] = grains.id(i); });
    line_up(grains, found);
    list_parts(grains);
  }

  /// The contact of this pair of ids, the lower one first; `no_index` if they are not near.
  /// Requires a previous call of tabulate().
  Index find(Id a, Id b) const noexcept {
    if (a >= places_.size() || places_[a] == none) return no_index;
    for (const Part part : of(places_[a])) {
      if (!part.is_second() && second_id(part.contact()) == b) return part.contact();
    }
    return no_index;
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
  static constexpr Index prefetched = 64;
  static constexpr std::uint32_t wall_bit = std::uint32_t(1) << 31;

  static constexpr Index full_eights(Index n) { return (n + lanes - 1) / lanes * lanes; }

  // The chunk of the grain with the lower index: after the chunks 0 … k have been evaluated, all
  // contacts of their grains are available.
  template <class P>
  static Index home_of(const Pair& pair, const P& grains) {
    return std::min(grains.owner(pair.first), grains.owner(pair.second)) / chunk_size;
  }

  template <class P>
  void line_up(const P& grains, Found& found) {
    const Index owned = grains.size();
    const Index number_of_chunks = chunk_count(owned);
    const auto count_at = [&](const auto& rows, Index number) {
      return rows.first()[std::min(owned, (number + 1) * chunk_size)] -
             rows.first()[number * chunk_size];
    };
    const auto for_each_stray = [&](auto&& f) {
      for (const auto& strays : found.strays) {
        for (const Pair& pair : strays) f(home_of(pair, grains), pair);
      }
    };
    auto& lined_up = found.lined_up;
    lined_up.assign(number_of_chunks, 0);
    for_each_stray([&](Index home, const Pair&) { ++lined_up[home]; });
    chunks_.resize(number_of_chunks);
    Index size = 0;
    for (Index number = 0; number < number_of_chunks; ++number) {
      OfChunk& chunk = chunks_[number];
      const Index found_here = count_at(found.pairs, number);
      chunk.pairs = {size, size + found_here + lined_up[number]};
      chunk.walls.first = full_eights(chunk.pairs.last);
      chunk.walls.last = chunk.walls.first + count_at(found.walls, number);
      chunk.needs = {number, number};
      lined_up[number] = found_here;
      size = chunk.all().last;
    }
    if (size >= wall_bit) {
      fail("dem::Contacts: there are " + std::to_string(size) +
           " near contacts, more than 2^31; use fewer grains");
    }
    // Prefetching reads a few places beyond the end.
    resize_tightly(first_, size);
    resize_tightly(second_, size + prefetched);
    std::fill(second_.begin() + static_cast<std::ptrdiff_t>(size), second_.end(), 0u);
    const auto put = [&](Index contact, const Pair& pair) {
      first_[contact] = pair.first;
      second_[contact] = pair.second;
    };
    for_each_chunk(owned, [&](Chunk its) {
      const OfChunk& chunk = chunks_[its.number];
      const Range all = chunk.all();
      for (Index c = all.first; c < all.last; ++c) put(c, {0, 0});
      Index pair = chunk.pairs.first;
      Index wall = chunk.walls.first;
      for (Index i = its.first; i < its.last; ++i) {
        for (const Pair& each : found.pairs[i]) put(pair++, each);
        for (const std::uint32_t number : found.walls[i]) {
          put(wall++, {static_cast<std::uint32_t>(i), number | wall_bit});
        }
      }
    });
    for_each_stray([&](Index home, const Pair& pair) {
      put(chunks_[home].pairs.first + lined_up[home]++, pair);
    });
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
    resize_tightly(parts_, begin_[owned]);
    for_each_part([&](Index i, Index c, bool is_second) { parts_[begin_[i]++] = {c, is_second}; });
    for (Index i = owned; i > 0; --i) begin_[i] = begin_[i - 1];
    begin_[0] = 0;
    for_each_chunk(owned, [&](Chunk chunk) {
      Index lowest = size();
      Index highest = 0;
      for (Index i = chunk.first; i < chunk.last; ++i) {
        sort_parts(i);
        for (const Part part : of(i)) {
          lowest = std::min(lowest, part.contact());
          highest = std::max(highest, part.contact());
        }
      }
      if (begin_[chunk.first] == begin_[chunk.last]) return;
      chunks_[chunk.number].needs = {chunk_of(lowest), chunk_of(highest)};
    });
  }

  void sort_parts(Index i) {
    const auto partner = [&](Part part) {
      return part.is_second() ? first_id(part.contact()) : second_id(part.contact());
    };
    std::sort(parts_.begin() + begin_[i], parts_.begin() + begin_[i + 1],
              [&](Part a, Part b) { return partner(a) < partner(b); });
  }

  // Number of the chunk that a contact belongs to.
  Index chunk_of(Index contact) const {
    const auto behind =
        std::upper_bound(chunks_.begin(), chunks_.end(), contact,
                         [](Index c, const OfChunk& chunk) { return c < chunk.pairs.first; });
    return static_cast<Index>(behind - chunks_.begin()) - 1;
  }

  std::vector<OfChunk> chunks_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> second_;
  std::vector<std::uint32_t> begin_;  // by owned grain
  std::vector<Part> parts_;
  std::vector<Id> ids_;                // by index
  std::vector<std::uint32_t> places_;  // by id
};

}  // namespace silt::dem
