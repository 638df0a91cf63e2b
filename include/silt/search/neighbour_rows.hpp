// SPDX-License-Identifier: MIT
// Rows of neighbours: unequal length, 32 bits an entry, written by several threads at once.
//
// Rows of one chunk stand in one piece of memory, each chunk in its own: where it begins need not
// be known before the chunks in front of it are done, and nothing is copied behind. With 118
// neighbours in a row, copying would take longer than finding them.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace silt {

/// What rows of neighbours hold: every pair at both of its particles, or at one of them.
enum class Pairs { twice, once };

class NeighbourRows {
 public:
  /// Adds the rows of one chunk, one after the other.
  class Writer {
   public:
    /// Where to write on: behind the last row, or at `to` within the next. There is room for `most`
    /// entries. Throws if a chunk of rows has 2³² entries.
    std::uint32_t* room(Index most) { return room(most, entries_.data() + used_); }
    std::uint32_t* room(Index most, std::uint32_t* to) {
      const auto used = static_cast<Index>(to - entries_.data());
      if (used + most > entries_.size()) grow(used + most);
      return entries_.data() + used;
    }
    /// The row ends here.
    void end_row(const std::uint32_t* end) {
      used_ = static_cast<Index>(end - entries_.data());
      *++end_ = static_cast<std::uint32_t>(used_);
    }

   private:
    friend NeighbourRows;
    Writer(std::vector<std::uint32_t>& entries, std::uint32_t* begin)
        : entries_(entries), end_(begin) {
      *begin = 0;
    }
    void grow(Index least) {
      constexpr Index most = std::numeric_limits<std::uint32_t>::max();
      if (least > most) {
        fail("search: a particle has millions of neighbours; lower the search radius");
      }
      // Never shrunk, so that a warm build neither allocates nor clears.
      entries_.resize(std::min(most, least + least / 4));
    }

    std::vector<std::uint32_t>& entries_;
    std::uint32_t* end_;
    Index used_ = 0;
  };

  /// f(chunk, writer) ends every row of every chunk of 0 … rows-1, in their order.
  template <class F>
  void build(Index rows, F&& f) {
    const Index chunks = chunk_count(rows);
    rows_ = rows;
    end_.resize(rows + chunks);
    if (entries_.size() < chunks) entries_.resize(chunks);
    for_each_chunk(rows, [&](Chunk chunk) {
      Writer writer(entries_[chunk.number], end_.data() + chunk.first + chunk.number);
      f(chunk, writer);
    });
  }

  Index size() const noexcept { return rows_; }

  std::span<const std::uint32_t> operator[](Index row) const noexcept {
    const Index chunk = row / chunk_size;
    const std::uint32_t* const end = end_.data() + row + chunk;
    return {entries_[chunk].data() + end[0], entries_[chunk].data() + end[1]};
  }

  /// Entries of all rows.
  Index entries() const noexcept {
    Index sum = 0;
    for (Index row = 0; row < rows_; row += chunk_size) {
      sum += end_[std::min(rows_, row + chunk_size) + row / chunk_size];
    }
    return sum;
  }

 private:
  Index rows_ = 0;
  std::vector<std::uint32_t> end_;  // by chunk: 0, and the end of each row
  std::vector<std::vector<std::uint32_t>> entries_;  // by chunk
};

/// What NeighbourRows::Writer is for rows that are kept, for rows that are read once: hands each
/// one that is not empty, as f(chunk, items[row], row).
template <class F>
class RowReader {
 public:
  RowReader(F& f, Chunk chunk, std::span<const std::uint32_t> items,
            std::vector<std::uint32_t>& memory)
      : f_(f), chunk_(chunk.number), items_(items), row_(chunk.first), memory_(memory) {}

  std::uint32_t* room(Index most) {
    begin_ = 0;
    return room(most, memory_.data());
  }
  std::uint32_t* room(Index most, std::uint32_t* to) {
    const auto used = static_cast<Index>(to - memory_.data());
    if (used + most > memory_.size()) memory_.resize(2 * (used + most));
    return memory_.data() + used;
  }
  void end_row(const std::uint32_t* to) {
    const auto end = static_cast<Index>(to - memory_.data());
    const Index i = items_[row_++];
    const std::span<const std::uint32_t> all = memory_;
    if (end > begin_) f_(chunk_, i, all.subspan(begin_, end - begin_));
    begin_ = end;
  }

 private:
  F& f_;
  Index chunk_;
  std::span<const std::uint32_t> items_;
  Index row_;
  std::vector<std::uint32_t>& memory_;
  Index begin_ = 0;
};

}  // namespace silt
