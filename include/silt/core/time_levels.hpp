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

#include <silt/core/field_storage.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <cstdint>
#include <type_traits>
#include <utility>

namespace silt::detail {

/// Values before a step, and the memory for those after it.
template <class Before, class After>
struct Advance {
  Before before;
  After after;
};

/// The values of what a Column or Rows stores, of the owned particles and the ghosts.
template <class Storage>
class TimeLevels {
 public:
  Storage& now() noexcept { return now_.values; }
  const Storage& now() const noexcept { return now_.values; }

  /// Begins a step, of which nothing is saved yet.
  void save() noexcept { is_kept_ = is_next_ = false; }

  /// Saves the values for restore(), unless that was done since save().
  void keep() {
    if (is_kept_) return;
    other_ = now_;
    is_kept_ = true;
    is_next_ = false;
  }

  /// The values of a field of the owned particles, and the memory for the next ones, all of which
  /// must be written. If the values were kept before, both are the same memory.
  template <Field F>
  auto advance(F field, Index owned) {
    auto before = std::as_const(now_.values).view(field, owned);
    auto present = now_.values.view(field, owned);
    if (is_kept_) return Advance<decltype(before), decltype(present)>{before, present};
    begin_advance();
    advanced_ |= Storage::template bit_of<F>;
    return Advance<decltype(before), decltype(present)>{before, other_.values.view(field, owned)};
  }
  /// The same for all fields of a bundle; every number must be written.
  auto advance_rows() {
    if (!is_kept_) begin_advance();
    advanced_ = ~0u;
    auto* before = std::as_const(now_.values).rows();
    auto* after = is_next_ ? other_.values.rows() : now_.values.rows();
    return Advance<decltype(before), decltype(after)>{before, after};
  }
  /// Whether the next values are written to the other buffer.
  bool is_advancing() const noexcept { return is_next_; }
  /// Makes the next values the present ones. `ghosts` is another number whenever ghosts have
  /// changed; they keep their values, which the other buffer may have from an earlier step.
  void finish_advance(Index owned, std::uint64_t ghosts) {
    if (!is_next_) return;
    now_.values.for_each_field([&]<class F>(F field) {
      if ((advanced_ & Storage::template bit_of<F>) != 0) return;
      const auto from = std::as_const(now_.values).view(field, owned);
      const auto to = other_.values.view(field, owned);
      for_each(owned, [&](Index i) { to[i] = from[i]; });
    });
    if (other_.ghosts != ghosts) other_.values.copy_from(now_.values, owned, now_.values.size());
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
    Storage values;
    std::uint64_t ghosts = 0;  // those of its last finish_advance()

    void swap(Buffer& other) noexcept {
      values.swap(other.values);
      std::swap(ghosts, other.ghosts);
    }
  };
  static constexpr bool is_of_bundle = requires(Storage s) { s.rows(); };
  struct None {};

  void begin_advance() {
    if (is_next_) return;
    if constexpr (is_of_bundle) {
      if (other_.values.is_shared()) other_.swap(spare_);
      if (other_.values.replace_if_shared()) other_.ghosts = 0;
    }
    if (other_.values.size() != now_.values.size()) other_.values.resize(now_.values.size());
    is_next_ = true;
    advanced_ = 0;
  }

  Buffer now_;
  Buffer other_;
  // Takes the place of the other buffer while that is shared.
  [[no_unique_address]] std::conditional_t<is_of_bundle, Buffer, None> spare_;
  bool is_kept_ = true;    // nothing more to save
  bool is_next_ = false;   // the other buffer is for the next values
  unsigned advanced_ = 0;  // of which fields, by bit_of
};

}  // namespace silt::detail
