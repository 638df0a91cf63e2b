// SPDX-License-Identifier: MIT
// Rows of neighbours of different lengths, with 32-bit entries, written in parallel.
//
// The rows of each chunk are in contiguous memory of their own, so that a chunk can be written
// before the lengths of the previous ones are known, and nothing is copied afterwards. With 118
// neighbours in a row, copying would take longer than finding them.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

namespace silt {

/// Whether rows contain every pair twice, at both particles, or once.
enum class Pairs { twice, once };

/// Mean number of particles in the cell of a particle up to which rows are stored: a row then has
/// about twice as many entries on average, and at most 27 times as many.
inline constexpr Index max_row = 512;

/// The neighbours or candidates of every particle, by their indices.
class NeighbourRows {
 public:
  /// Writes the rows of one chunk, one after the other.
  class Writer {
   public:
    /// Returns the address for at least `size` further entries of the next row: its beginning, or
    /// the one that corresponds to `to` if entries up to `to` have been written. Throws if the rows
    /// of a chunk have 2³² entries.
    std::uint32_t* room(Index size) { return room(size, entries_.data() + used_); }
    std::uint32_t* room(Index size, std::uint32_t* to) {
      const auto used = static_cast<Index>(to - entries_.data());
      if (used + size > entries_.size()) grow(used + size);
      return entries_.data() + used;
    }
    /// Ends the row.
    void end_row(const std::uint32_t* end) {
      used_ = static_cast<Index>(end - entries_.data());
      *++end_ = static_cast<std::uint32_t>(used_);
    }

   private:
    friend NeighbourRows;
    Writer(Buffer<std::uint32_t>& entries, std::uint32_t* begin) : entries_(entries), end_(begin) {
      *begin = 0;
    }
    void grow(Index min_size) {
      constexpr Index max_size = std::numeric_limits<std::uint32_t>::max();
      if (min_size > max_size) {
        fail("search: a particle has millions of neighbours; reduce the search radius");
      }
      // Never shrunk, so that later builds neither allocate nor initialise memory.
      entries_.resize(std::min(max_size, min_size + min_size / 4));
    }

    Buffer<std::uint32_t>& entries_;
    std::uint32_t* end_;
    Index used_ = 0;
  };

  /// Calls f(chunk, writer) for every chunk of 0 … rows-1; f writes its rows in order.
  template <class F>
  void build(Index rows, F&& f) {
    const Index chunks = chunk_count(rows);
    rows_ = rows;
    resize_tightly(end_, rows + chunks);
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

  /// Number of entries of all rows.
  Index entries() const noexcept {
    Index sum = 0;
    for (Index row = 0; row < rows_; row += chunk_size) {
      sum += end_[std::min(rows_, row + chunk_size) + row / chunk_size];
    }
    return sum;
  }

 private:
  Index rows_ = 0;
  Buffer<std::uint32_t> end_;                   // by chunk: 0, and the end of each row
  Buffer<Buffer<std::uint32_t>> entries_;       // by chunk
};

/// The interface of NeighbourRows::Writer for rows that are read only once: calls
/// f(set, items[row], row) for each row of a set of rows_together that is not empty.
template <class F>
class RowReader {
 public:
  /// For the set of rows that begins with `first`, which are those of `items`, by place; `memory`
  /// is reused.
  RowReader(F& f, Index first, std::span<const std::uint32_t> items, Buffer<std::uint32_t>& memory)
      : f_(f), set_(first / rows_together), items_(items), row_(first), memory_(memory) {}

  /// As NeighbourRows::Writer::room().
  std::uint32_t* room(Index size) {
    begin_ = 0;
    return room(size, memory_.data());
  }
  std::uint32_t* room(Index size, std::uint32_t* to) {
    const auto used = static_cast<Index>(to - memory_.data());
    if (used + size > memory_.size()) memory_.resize(2 * (used + size));
    return memory_.data() + used;
  }
  /// Ends a row, of which the entries up to `to` have been written.
  void end_row(const std::uint32_t* to) {
    const auto end = static_cast<Index>(to - memory_.data());
    const Index i = items_[row_++];
    const std::span<const std::uint32_t> all = memory_;
    if (end > begin_) f_(set_, i, all.subspan(begin_, end - begin_));
    begin_ = end;
  }

 private:
  F& f_;
  Index set_;
  std::span<const std::uint32_t> items_;
  Index row_;
  Buffer<std::uint32_t>& memory_;
  Index begin_ = 0;
};

}  // namespace silt
