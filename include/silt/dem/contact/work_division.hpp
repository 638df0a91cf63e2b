// SPDX-License-Identifier: MIT
// How the blocks of grains are divided among threads, and where the loads of contacts are kept.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/deferred_grains.hpp>
#include <silt/dem/contact/grain_rows.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace silt::dem::detail {

/// Each thread processes consecutive blocks: it evaluates the contacts of a block and
/// then sums the forces on its grains, except those with contacts that belong to blocks of other
/// threads. These are deferred until such threads have evaluated theirs. No result depends on the
/// division.
class WorkDivision {
 public:
  /// Adapts it to a list and a number of threads, unless it already is.
  void fit(const ContactList& list, Index threads) {
    threads = std::min(threads, std::max<Index>(list.blocks(), 1));
    if (&list == list_ && threads == this->threads()) {
      if (list.grains() != order_.size()) add(list);
      return;
    }
    list_ = nullptr;  // until all is done
    divide(list, threads);
    resize_tightly(slot_of_group_, list.groups_of_grains());
    resize_tightly(row_of_side_, list.sides().size());
    is_deferred_.assign(list.grains(), 0);
    deferred_.clear(threads);
    slots_.assign(threads + 1, 0);
    for_each_task(threads, [&](Index t) { find_deferred(list, t); });
    for_each_task(threads, [&](Index t) { slots_[t + 1] = assign_slots(list, t); });
    for (Index t = 0; t < threads; ++t) slots_[t + 1] += slots_[t];
    for_each_task(threads, [&](Index t) {
      for (Index g = group_of(list, first_block_[t]); g < group_of(list, first_block_[t + 1]);
           ++g) {
        slot_of_group_[g] += static_cast<std::uint32_t>(slots_[t]);
      }
    });
    number_added_groups(list);
    resize_tightly(order_, list.grains());
    for_each_range(list.grains(), [&](Index first, Index last) { order(list, first, last); });
    for_each(list.grains(), [&](Index i) { find_rows(list, list.begin(i), list.end(i)); });
    list_ = &list;
  }
  /// Forgets the list.
  void reset() { list_ = nullptr; }

  Index threads() const noexcept { return first_block_.empty() ? 0 : first_block_.size() - 1; }
  /// The first block of a thread.
  Index first_block(Index thread) const noexcept { return first_block_[thread]; }
  bool is_deferred(Index grain) const noexcept { return is_deferred_[grain] != 0; }
  /// f(first, last) for short ranges of the grains of [first, last) that are not deferred.
  template <class F>
  void for_each_ready(Index first, Index last, F&& f) const {
    while (first < last) {
      if (is_deferred(first)) {
        ++first;
        continue;
      }
      Index end = first + 1;
      while (end < last && end < first + range_size && !is_deferred(end)) ++end;
      f(first, end);
      first = end;
    }
  }
  /// Those that are.
  DeferredGrains& deferred() noexcept { return deferred_; }

  /// f(grain) for the grains [first, last) of a range, by number of contacts if the range is whole:
  /// a processor then predicts the number better.
  template <class F>
  void for_each_in_order(Index first, Index last, F&& f) const {
    const bool is_whole = first % range_size == 0 && last % range_size == 0;
    for (Index k = first; k < last; ++k) f(is_whole ? first + order_[k] : k);
  }

  /// Number of groups of eight rows.
  Index slots() const noexcept { return slots_.back(); }
  Index slot_of(Index group) const noexcept { return slot_of_group_[group]; }
  Index row_of(Index contact) const noexcept {
    return slot_of(contact / lanes) * lanes + contact % lanes;
  }
  /// For each side in the list: eight times the number of its row, plus one for the second grain.
  const std::uint32_t* row_of_side() const noexcept { return row_of_side_.data(); }

 private:
  // Grains were added to the list, see ContactList::add().
  void add(const ContactList& list) {
    const ContactList* const same = std::exchange(list_, nullptr);  // until all is done
    first_block_.back() = list.blocks();
    is_deferred_.resize(list.grains(), 0);
    const Index first = order_.size() / range_size * range_size;
    resize_tightly(order_, list.grains());
    for (Index i = first; i < list.grains(); i += range_size) {
      order(list, i, std::min(i + range_size, list.grains()));
    }
    number_added_groups(list);
    const Index known = row_of_side_.size();
    resize_tightly(row_of_side_, list.sides().size());
    find_rows(list, known, list.sides().size());
    list_ = same;
  }

  // Their slots are not used again: any grain may read them.
  void number_added_groups(const ContactList& list) {
    Index group = slot_of_group_.size();
    resize_tightly(slot_of_group_, list.groups());
    while (group < list.groups())
      slot_of_group_[group++] = static_cast<std::uint32_t>(slots_.back()++);
  }

  // Of the sides [first, last).
  void find_rows(const ContactList& list, Index first, Index last) {
    for (Index s = first; s < last; ++s) {
      const ContactList::Side side = list.sides()[s];
      row_of_side_[s] = static_cast<std::uint32_t>(8 * row_of(side.contact()) + side.is_second());
    }
  }

  // Equal shares of the work, where a grain takes as long as two contacts.
  void divide(const ContactList& list, Index threads) {
    Buffer<Index> work(list.blocks() + 1, 0);
    for (Index b = 0; b < list.blocks(); ++b) {
      const auto [pairs, walls] = list.block(b);
      work[b + 1] =
          work[b] + 2 * block_size + (pairs.last - pairs.first) + (walls.last - walls.first);
    }
    first_block_.resize(threads + 1);
    for (Index t = 0; t <= threads; ++t) {
      const auto first = std::lower_bound(work.begin(), work.end(), work.back() * t / threads);
      first_block_[t] = static_cast<Index>(first - work.begin());
    }
  }

  static Index group_of(const ContactList& list, Index block) {
    return block < list.blocks() ? list.block(block).all().first / lanes : list.groups_of_grains();
  }

  void find_deferred(const ContactList& list, Index t) {
    DeferredRanges& deferred = deferred_.of(t);
    deferred.clear(threads());
    deferred.add_thread(t);
    const Index first = first_block_[t];
    const Index last = std::min(first_block_[t + 1] * block_size, list.grains());
    for (Index begin = first * block_size; begin < last; begin += DeferredRanges::size) {
      const Index end = std::min(begin + DeferredRanges::size, last);
      bool are_deferred = false;
      for (Index i = begin; i < end; ++i) {
        for (const ContactList::Side side : list.of(i)) {
          const Index block = list.block_of(side.contact());
          if (list.is_added(side.contact()) || block >= first) continue;
          are_deferred = true;
          deferred.add_thread(thread_of(block));
        }
      }
      if (!are_deferred) continue;
      std::fill_n(is_deferred_.begin() + std::ptrdiff_t(begin), end - begin, char(1));
      deferred.add(begin, end);
    }
  }
  Index thread_of(Index block) const {
    const auto next = std::upper_bound(first_block_.begin(), first_block_.end(), block);
    return static_cast<Index>(next - first_block_.begin()) - 1;
  }

  void order(const ContactList& list, Index first, Index last) {
    constexpr Index most = 15;
    std::array<Index, most + 2> begin{};
    const auto count = [&](Index i) { return std::min(list.count(i), most); };
    for (Index i = first; i < last; ++i) ++begin[count(i) + 1];
    for (Index k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
    for (Index i = first; i < last; ++i) {
      order_[first + begin[count(i)]++] = static_cast<std::uint8_t>(i - first);
    }
  }

  // Numbers the slots of one thread from 0 on; returns how many there are. A slot is used again
  // after the last block that reads it.
  Index assign_slots(const ContactList& list, Index t) {
    const Index first_block = first_block_[t];
    const Index last_block = first_block_[t + 1];
    Buffer<Buffer<std::uint32_t>> released(last_block - first_block);
    Buffer<std::uint32_t> free;
    Index count = 0;
    for (Index b = first_block; b < last_block; ++b) {
      const ContactList::Range all = list.block(b).all();
      for (Index c = all.first; c < all.last; c += lanes) {
        std::uint32_t slot = 0;
        if (free.empty()) {
          slot = static_cast<std::uint32_t>(count++);
        } else {
          slot = free.back();
          free.pop_back();
        }
        slot_of_group_[c / lanes] = slot;
        Index last_read = b;
        for (Index lane = 0; lane < lanes; ++lane) {
          last_read = std::max(last_read, last_reader(list, c + lane, last_block));
        }
        if (last_read < last_block) released[last_read - first_block].push_back(slot);
      }
      free.append(released[b - first_block]);
    }
    return count;
  }
  // The last block in which the row of a contact is read; `never` if after all blocks.
  Index last_reader(const ContactList& list, Index c, Index never) const {
    Index i = list.first(c);
    if (!list.is_owned(list.first(c))) i = list.second(c);
    if (is_deferred_[i]) return never;
    if (list.is_of_wall(c)) return i / block_size;
    const std::uint32_t j = list.second(c);
    if (!list.is_owned(j)) return i / block_size;
    return is_deferred_[j] ? never : std::min(never, std::max<Index>(i, j) / block_size);
  }

  const ContactList* list_ = nullptr;  // for comparison only
  Buffer<Index> first_block_;          // by thread
  Buffer<std::uint32_t> slot_of_group_;
  Buffer<Index> slots_;  // before those of each thread
  Buffer<std::uint32_t> row_of_side_;
  Buffer<std::uint8_t> order_;                   // by range of grains, the offsets from the first
  Buffer<char> is_deferred_;                     // by grain
  DeferredGrains deferred_;
};

}  // namespace silt::dem::detail
