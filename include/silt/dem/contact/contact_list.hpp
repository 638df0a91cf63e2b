// SPDX-License-Identifier: MIT
// The list of pairs that touch or may soon touch. It is rebuilt only after grains have moved; other
// steps just go through it:
//
//   contact    0   1   2 …           those of a block of grains: pairs, then grains at walls
//   first    [ 3   3   5 …           index of the grain with the lower id, times index_scale
//   second   [ 9   4   9 …           index of the other, or the element of a wall, likewise
//
// A pair belongs to the block of the grain with the lower index; one of the two may be of the halo,
// whose indices are the highest. The pairs of a block, and its
// contacts with walls, are each padded to a multiple of eight: contacts are evaluated in groups of
// eight. Contacts of grains that are added later are further blocks behind all others, see add().
//
// Each grain has a list of its contacts, sorted by the partner's id, walls last. Forces are summed
// in this order, so that they depend neither on the search nor on the order in memory.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/wall/wall_set.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

namespace silt::dem::detail {

/// Grains whose contacts are evaluated together; then their forces are summed.
inline constexpr Index block_size = 256;
inline Index block_count(Index grains) { return (grains + block_size - 1) / block_size; }

class ContactList {
 public:
  /// A contact from the side of one of its grains.
  class Side {
   public:
    Side() = default;
    Side(Index contact, bool is_second)
        : number_(static_cast<std::uint32_t>(2 * contact) + static_cast<std::uint32_t>(is_second)) {
    }
    Index contact() const { return number_ / 2; }
    bool is_second() const { return number_ % 2 == 1; }

   private:
    std::uint32_t number_;
  };
  struct Pair {
    std::uint32_t first;
    std::uint32_t second;
  };

  /// Number of contacts, including padding.
  Index size() const noexcept { return first_.size(); }
  Index groups() const noexcept { return size() / lanes; }
  /// Number of blocks of grains.
  Index blocks() const noexcept { return blocks_.size(); }
  /// Number of blocks of contacts that were added. They are to be evaluated before all others,
  /// whose grains they touch.
  Index added_blocks() const noexcept { return added_.size(); }
  /// Number of groups in the blocks of grains.
  Index groups_of_grains() const noexcept {
    return added_.empty() ? groups() : added_.front().pairs.first / lanes;
  }
  bool is_added(Index contact) const noexcept { return contact >= groups_of_grains() * lanes; }
  /// Number of owned grains.
  Index grains() const noexcept { return owned_; }
  bool is_owned(std::uint32_t grain) const noexcept { return grain < owned_; }
  bool is_of_wall(Index contact) const noexcept { return second_[contact] >= wall_bit; }
  /// Indices of the two grains, or of the wall's element.
  std::uint32_t first(Index contact) const noexcept { return unscaled(first_[contact]); }
  std::uint32_t second(Index contact) const noexcept { return unscaled(second_[contact]); }
  /// The scaled indices of eight contacts, from which unscaled() returns the index.
  const std::uint32_t* first_of_group(Index contact) const noexcept { return &first_[contact]; }
  const std::uint32_t* second_of_group(Index contact) const noexcept { return &second_[contact]; }
  static std::uint32_t unscaled(std::uint32_t scaled) noexcept {
    return (scaled & ~wall_bit) / index_scale;
  }
  /// The id of a grain when the list was built.
  Id id(Index grain) const noexcept { return ids_[grain]; }
  /// Those of all grains, with the halo.
  std::span<const Id> ids() const noexcept { return ids_; }
  /// The ids of the two.
  Id first_id(Index contact) const noexcept { return ids_[first(contact)]; }
  Id second_id(Index contact) const noexcept {
    return is_of_wall(contact) ? wall_id(second(contact)) : ids_[second(contact)];
  }
  /// The block that a contact belongs to.
  Index block_of(Index contact) const noexcept {
    const std::uint32_t scaled = first_[contact];
    return unscaled(is_of_wall(contact) ? scaled : std::min(scaled, second_[contact])) / block_size;
  }

  /// Contacts [first, last); first is a multiple of eight.
  struct Range {
    Index first;
    Index last;
  };
  /// Those of a block of grains.
  struct Block {
    Range pairs;
    Range walls;
    /// All, including padding.
    Range all() const { return {pairs.first, full_groups(walls.last)}; }
  };
  /// Those that were added have the numbers from blocks() on.
  const Block& block(Index number) const noexcept {
    return number < blocks() ? blocks_[number] : added_[number - blocks()];
  }

  /// f(block, first grain, last grain) for every block, in parallel.
  template <class F>
  void for_each_block(F&& f) const {
    const Index n = grains();
    const Index all = block_count(n);
    const auto tasks = static_cast<Index>(threads_for(n));
    for_each_task(tasks, [&](Index task) {
      for (Index b = all * task / tasks; b < all * (task + 1) / tasks; ++b) {
        f(b, b * block_size, std::min(n, (b + 1) * block_size));
      }
    });
  }
  /// f(contact) for each of a block.
  template <class F>
  void for_each_contact(Index block, F&& f) const {
    const auto [pairs, walls] = this->block(block);
    for (Index c = pairs.first; c < walls.last; ++c) {
      if (c < pairs.last || c >= walls.first) f(c);
    }
  }

  /// f(contact) for each, in parallel.
  template <class F>
  void for_each_contact(F&& f) const {
    for_each_block([&](Index b, Index, Index) { for_each_contact(b, f); });
    for (Index b = blocks(); b < blocks() + added_blocks(); ++b) for_each_contact(b, f);
  }
  /// f(contact) for each, grain by grain as they lie in memory, and at each in the order of the
  /// partners' ids, which is independent of the search: at its first grain, or at the second if
  /// another process owns the first.
  template <class F>
  void for_each_contact_by_grain(F&& f) const {
    for (Index i = 0; i < grains(); ++i) {
      for (const Side side : of(i)) {
        const Index c = side.contact();
        if (!side.is_second() || !is_owned(first(c))) f(c);
      }
    }
  }

  /// Contacts of grain i.
  std::span<const Side> of(Index i) const noexcept { return sides().subspan(begin_[i], count(i)); }
  Index count(Index i) const noexcept { return end_[i] - begin_[i]; }
  /// Those of all grains, where those of grain i begin, and their end.
  std::span<const Side> sides() const noexcept { return sides_; }
  Index begin(Index i) const noexcept { return begin_[i]; }
  Index end(Index i) const noexcept { return end_[i]; }

  /// The pairs found at the grains of a block, before they are put into one list.
  struct PairsOfBlock {
    Index block = 0;
    Buffer<Pair> pairs;
    Buffer<Pair> walls;  ///< a grain and the element of a wall
    Buffer<Pair> of_other_blocks;

    void add_pair(Index first, Index second) {
      const Pair pair{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second)};
      (block_of(pair) == block ? pairs : of_other_blocks).push_back(pair);
    }
    void add_wall(Index grain, Index element) {
      walls.push_back({static_cast<std::uint32_t>(grain), static_cast<std::uint32_t>(element)});
    }
  };
  /// Builds the list for grains with these ids, of which the first `owned` are owned: find(first,
  /// last, pairs) adds the pairs found at the grains [first, last), those of a block.
  void build(std::span<const Id> ids, Index owned,
             FunctionRef<void(Index first, Index last, PairsOfBlock&)> find) {
    ids_.assign(ids.begin(), ids.end());
    owned_ = owned;
    added_.clear();
    {
      // Not kept for the next list: the steps in between would have this memory for nothing.
      Buffer<PairsOfBlock> by_block(block_count(owned_));
      for_each_block([&](Index b, Index first, Index last) {
        by_block[b].block = b;
        find(first, last, by_block[b]);
      });
      concatenate(by_block);
    }
    list_sides();
  }

  /// Adds grains with these ids behind the others, and their contacts as a further block; those
  /// before keep their numbers. If it throws, nothing has changed.
  void add(std::span<const Id> ids, const PairsOfBlock& found) {
    const Index grain = owned_;
    Block block;
    block.pairs = {size(), size() + found.pairs.size()};
    block.walls.first = full_groups(block.pairs.last);
    block.walls.last = block.walls.first + found.walls.size();
    const Index end = block.all().last;
    check_size(owned_ + ids.size(), end);
    Buffer<SideOf> new_sides = sides_of(block, found);
    const Index moved = count_with(new_sides);
    reserve_tightly(ids_, owned_ + ids.size());
    reserve_tightly(begin_, owned_ + ids.size());
    reserve_tightly(end_, owned_ + ids.size());
    reserve_tightly(blocks_, block_count(owned_ + ids.size()));
    reserve_one_more(added_);
    reserve_tightly(sides_, sides_.size() + moved);
    reserve_tightly(first_, end);
    reserve_tightly(second_, end);
    Buffer<std::pair<Id, Side>> by_partner;
    by_partner.reserve(moved);

    ids_.append(ids);
    owned_ += ids.size();
    const auto end_of_sides = static_cast<std::uint32_t>(sides_.size());
    begin_.resize(owned_, end_of_sides);
    end_.resize(owned_, end_of_sides);
    const Index end_of_blocks = groups_of_grains() * lanes;
    blocks_.resize(block_count(owned_),
                   {{end_of_blocks, end_of_blocks}, {end_of_blocks, end_of_blocks}});
    first_.resize(end, static_cast<std::uint32_t>(grain) * index_scale);
    second_.resize(end, static_cast<std::uint32_t>(grain) * index_scale);
    put_all(block.pairs.first, found.pairs, 0);
    put_all(block.walls.first, found.walls, wall_bit);
    if (end > block.pairs.first) added_.push_back(block);
    // The sides of a grain that gets more move behind all others.
    for (auto next = new_sides.begin(); next != new_sides.end();) {
      const Index i = next->grain;
      const auto begin = static_cast<std::uint32_t>(sides_.size());
      for (Index s = begin_[i]; s < end_[i]; ++s) sides_.push_back(Side(sides_[s]));
      for (; next != new_sides.end() && next->grain == i; ++next) sides_.push_back(next->side);
      begin_[i] = begin;
      end_[i] = static_cast<std::uint32_t>(sides_.size());
      sort_sides(i, by_partner);
    }
  }
  /// groups() after add().
  Index groups_with(const PairsOfBlock& found) const {
    return groups() + (full_groups(found.pairs.size()) + full_groups(found.walls.size())) / lanes;
  }

  /// The contact of this pair of ids, the lower one first; `no_index` if they are not in the list.
  /// index_of(id) is the index of a grain when the list was built, or any number if there was none.
  template <class IndexOf>
  Index find(Id a, Id b, IndexOf&& index_of) const {
    const auto find_at = [&](Index i, Id id, Id partner) {
      if (i >= grains() || ids_[i] != id) return no_index;
      for (const Side side : of(i)) {
        const Index c = side.contact();
        if ((side.is_second() ? first_id(c) : second_id(c)) == partner) return c;
      }
      return no_index;
    };
    const Index found = find_at(index_of(a), a, b);
    // The grain with the lower id may be of the halo.
    return found != no_index || is_wall_id(b) ? found : find_at(index_of(b), b, a);
  }

 private:
  static constexpr std::uint32_t wall_bit = std::uint32_t(1) << 31;
  static_assert(max_wall_elements * index_scale <= wall_bit, "see WallSet");

  static constexpr Index full_groups(Index n) { return (n + lanes - 1) / lanes * lanes; }
  static Index block_of(const Pair& pair) { return std::min(pair.first, pair.second) / block_size; }

  static void check_size(Index grains, Index contacts) {
    if (grains * index_scale < wall_bit && 4 * contacts < wall_bit) return;
    fail({"dem::Contacts: there are ", grains, " grains and ", contacts,
          " near contacts, more than 2^28 of the former or 2^29 of the latter; use fewer grains"});
  }

  void concatenate(const Buffer<PairsOfBlock>& by_block) {
    Buffer<Index> further(by_block.size(), 0);
    for (const PairsOfBlock& each : by_block) {
      for (const Pair& pair : each.of_other_blocks) ++further[block_of(pair)];
    }
    blocks_.resize(by_block.size());
    Index size = 0;
    for (Index b = 0; b < by_block.size(); ++b) {
      Block& block = blocks_[b];
      block.pairs = {size, size + by_block[b].pairs.size() + further[b]};
      block.walls.first = full_groups(block.pairs.last);
      block.walls.last = block.walls.first + by_block[b].walls.size();
      size = block.all().last;
      further[b] = block.pairs.first + by_block[b].pairs.size();
    }
    check_size(ids_.size(), size);
    resize_tightly(first_, size);
    resize_tightly(second_, size);
    for_each_block([&](Index b, Index grain, Index) {
      const Block& block = blocks_[b];
      // Padding: a grain with itself, which is never evaluated.
      const auto [first_contact, last_contact] = block.all();
      for (auto* const column : {&first_, &second_}) {
        std::fill(column->begin() + std::ptrdiff_t(first_contact),
                  column->begin() + std::ptrdiff_t(last_contact),
                  static_cast<std::uint32_t>(grain) * index_scale);
      }
      put_all(block.pairs.first, by_block[b].pairs, 0);
      put_all(block.walls.first, by_block[b].walls, wall_bit);
    });
    for (const PairsOfBlock& each : by_block) {
      for (const Pair& pair : each.of_other_blocks) put(further[block_of(pair)]++, pair);
    }
  }
  [[gnu::noinline]] void put_all(Index contact, const Buffer<Pair>& pairs, std::uint32_t bit) {
    for (const Pair& pair : pairs) {
      put(contact, pair);
      second_[contact++] |= bit;
    }
  }
  void put(Index contact, const Pair& pair) {
    first_[contact] = pair.first * index_scale;
    second_[contact] = pair.second * index_scale;
  }

  struct SideOf {
    std::uint32_t grain;
    Side side;
  };
  // Those of the contacts of a block that is added, by grain.
  static Buffer<SideOf> sides_of(const Block& block, const PairsOfBlock& found) {
    Buffer<SideOf> sides;
    sides.reserve(2 * found.pairs.size() + found.walls.size());
    Index contact = block.pairs.first;
    for (const Pair& pair : found.pairs) {
      sides.push_back({pair.first, Side(contact, false)});
      sides.push_back({pair.second, Side(contact++, true)});
    }
    contact = block.walls.first;
    for (const Pair& pair : found.walls) sides.push_back({pair.first, Side(contact++, false)});
    std::sort(sides.begin(), sides.end(),
              [](const SideOf& a, const SideOf& b) { return a.grain < b.grain; });
    return sides;
  }
  // Their number, together with the other sides of these grains.
  Index count_with(const Buffer<SideOf>& sides) const {
    Index sum = sides.size();
    for (Index k = 0; k < sides.size(); ++k) {
      const Index i = sides[k].grain;
      if ((k == 0 || sides[k - 1].grain != i) && i < owned_) sum += count(i);
    }
    return sum;
  }

  // Each task lists the sides of its own range of grains. Pairs belong to the grain with the lower
  // index: a task meets sides of its own grains and of those of later tasks.
  void list_sides() {
    const Index n = grains();
    const auto tasks = static_cast<Index>(threads_for(n));
    const auto first_block_of = [&](Index task) { return blocks() * task / tasks; };
    const auto first_grain_of = [&](Index task) {
      return std::min(n, first_block_of(task) * block_size);
    };
    Buffer<Buffer<SideOf>> of_later_tasks(tasks);
    // f(grain, side) for those of a task's own contacts, then for those that earlier tasks met.
    const auto for_each_own = [&](Index task, auto&& f) {
      for (Index b = first_block_of(task); b < first_block_of(task + 1); ++b) {
        for_each_contact(b, [&](Index c) {
          f(first(c), Side(c, false));
          if (!is_of_wall(c)) f(second(c), Side(c, true));
        });
      }
    };
    const auto for_each_of_earlier = [&](Index task, auto&& f) {
      for (Index earlier = 0; earlier < task; ++earlier) {
        for (const SideOf& each : of_later_tasks[earlier]) {
          if (each.grain >= first_grain_of(task) && each.grain < first_grain_of(task + 1)) {
            f(each.grain, each.side);
          }
        }
      }
    };
    // First the number of sides, then the end of the sides of each grain, then their beginning.
    resize_tightly(begin_, n);
    resize_tightly(end_, n);
    for_each_task(tasks, [&](Index task) {
      const Index end = first_grain_of(task + 1);
      std::fill(begin_.begin() + std::ptrdiff_t(first_grain_of(task)),
                begin_.begin() + std::ptrdiff_t(end), 0u);
      for_each_own(task, [&](std::uint32_t i, Side side) {
        if (i < end) {
          ++begin_[i];
        } else {
          of_later_tasks[task].push_back({i, side});
        }
      });
    });
    Buffer<std::uint32_t> before(tasks + 1, 0);
    for_each_task(tasks, [&](Index task) {
      for_each_of_earlier(task, [&](std::uint32_t i, Side) { ++begin_[i]; });
      std::uint32_t sum = 0;
      for (Index i = first_grain_of(task); i < first_grain_of(task + 1); ++i) {
        begin_[i] = sum += begin_[i];
      }
      before[task + 1] = sum;
    });
    std::partial_sum(before.begin(), before.end(), before.begin());
    resize_tightly(sides_, before[tasks]);
    for_each_task(tasks, [&](Index task) {
      const Index end = first_grain_of(task + 1);
      for (Index i = first_grain_of(task); i < end; ++i) begin_[i] += before[task];
      const auto add = [&](std::uint32_t i, Side side) {
        if (i < end) sides_[--begin_[i]] = side;
      };
      for_each_own(task, add);
      for_each_of_earlier(task, add);
    });
    for_each_block([&](Index, Index first, Index last) {
      Buffer<std::pair<Id, Side>> by_partner;
      for (Index i = first; i < last; ++i) {
        end_[i] = i + 1 < n ? begin_[i + 1] : static_cast<std::uint32_t>(sides_.size());
        sort_sides(i, by_partner);
      }
    });
  }

  void sort_sides(Index i, Buffer<std::pair<Id, Side>>& by_partner) {
    by_partner.clear();
    for (const Side side : of(i)) {
      const Index c = side.contact();
      by_partner.push_back({side.is_second() ? first_id(c) : second_id(c), side});
    }
    std::sort(by_partner.begin(), by_partner.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    for (Index k = 0; k < by_partner.size(); ++k) sides_[begin_[i] + k] = by_partner[k].second;
  }

  Buffer<Block> blocks_;
  Buffer<Block> added_;
  Buffer<std::uint32_t> first_;
  Buffer<std::uint32_t> second_;
  Buffer<std::uint32_t> begin_;  // by grain
  Buffer<std::uint32_t> end_;
  Buffer<Side> sides_;
  Buffer<Id> ids_;  // with those of the halo
  Index owned_ = 0;
};

}  // namespace silt::dem::detail
