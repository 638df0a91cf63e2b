// SPDX-License-Identifier: MIT
// The values of fields at two time levels, in two buffers. A step writes the next values to the
// other buffer, and then the two change places; or it saves the present ones there, and changes
// them in place. Either way, the other buffer has those before the step, for rolling it back.
//
//                       now                        other
//   advance()         [ before the step          | next values, being written ]
//   finish_advance()  [ after the step           | before the step            ]
//
//   keep()            [ being changed in place   | before the step            ]
#pragma once

#include <silt/core/column.hpp>
#include <silt/core/types.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>

namespace silt::detail {

/// Values before a step, and the memory for those after it.
template <class Before, class After>
struct Advance {
  Before before;
  After after;
};
template <class Before, class After>
Advance(Before, After) -> Advance<Before, After>;

/// The values of a column, or of the rows of a bundle, of the owned particles and the ghosts.
class TimeLevels {
 public:
  // Not inlined, because particles have one for every column.
  [[gnu::noinline]] explicit TimeLevels(const RowType& type)
      : now_{Column(type)}, other_{Column(type)}, spare_{Column(type)} {}
  [[gnu::noinline]] TimeLevels(const TimeLevels&) = default;
  [[gnu::noinline]] TimeLevels(TimeLevels&&) = default;
  [[gnu::noinline]] TimeLevels& operator=(const TimeLevels&) = default;
  [[gnu::noinline]] TimeLevels& operator=(TimeLevels&&) = default;
  [[gnu::noinline]] ~TimeLevels() = default;

  Column& now() noexcept { return now_.values; }
  const Column& now() const noexcept { return now_.values; }

  /// Begins a step, of which nothing is saved yet.
  void save() noexcept { is_kept_ = is_next_ = false; }

  /// Saves the values for restore(), unless that was done since save().
  void keep() {
    if (is_kept_) return;
    other_ = now_;
    is_kept_ = true;
    is_next_ = false;
  }

  /// The values, and the memory for the next ones of these numbers of a row, a bit for each, all of
  /// which must be written. If the values were kept before, both are the same memory.
  Advance<const std::byte*, std::byte*> advance(unsigned numbers) {
    if (is_kept_) return {now().data(), now().data()};
    if (!is_next_) begin_advance();
    advanced_ |= numbers;
    return {now().data(), other_.values.data()};
  }
  /// Whether the next values are written to the other buffer.
  bool is_advancing() const noexcept { return is_next_; }
  /// Makes the next values the present ones. `ghosts` is another number whenever ghosts have
  /// changed; they keep their values, which the other buffer may have from an earlier step.
  void finish_advance(Index owned, std::uint64_t ghosts) {
    if (!is_next_) return;
    const Index width = now().type().size / now().type().number_size;
    for (Index k = 0; k < width; ++k) {
      if ((advanced_ >> k & 1) == 0) other_.values.copy_numbers(now(), k, owned);
    }
    if (other_.ghosts != ghosts) other_.values.copy_from(now(), owned, now().size());
    now_.ghosts = other_.ghosts = ghosts;
    now_.swap(other_);
    is_next_ = false;
    is_kept_ = true;
  }

  /// Recovers the values of the owned particles, if they were saved. The ghosts may differ, and the
  /// next search recreates them.
  void restore(Index owned) noexcept {
    if (is_kept_) now_.values.copy_from(other_.values, 0, owned);
    save();
  }

 private:
  struct Buffer {
    Column values;
    std::uint64_t ghosts = 0;  // those of its last finish_advance()

    void swap(Buffer& other) noexcept {
      values.swap(other.values);
      std::swap(ghosts, other.ghosts);
    }
  };

  void begin_advance() {
    if (other_.values.is_shared()) other_.swap(spare_);
    if (other_.values.is_shared()) other_ = Buffer{Column(now().type())};
    if (other_.values.size() != now().size()) {
      other_.values.reserve(now().capacity());
      other_.values.resize(now().size());
    }
    is_next_ = true;
    advanced_ = 0;
  }

  Buffer now_;
  Buffer other_;
  Buffer spare_;           // takes the place of the other one while that is shared
  bool is_kept_ = true;    // nothing more to save
  bool is_next_ = false;   // the other buffer is for the next values
  unsigned advanced_ = 0;  // of which numbers, by bit
};

}  // namespace silt::detail
