// SPDX-License-Identifier: MIT
// The columns of a particle container, one for each field, and rolling them back after a failed
// step.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace silt {

/// One vector of values for each field, all of the same length: first the owned particles, then the
/// ghosts. A failed step is rolled back with save() before it and restore() after. restore()
/// recovers the fields passed to keep() or advance() in between; all others keep their present
/// values.
template <int Dim, class Real, Field... Fields>
class Columns {
 public:
  template <Field F>
  auto& of() noexcept {
    return std::get<Column<F>>(now_).values;
  }
  template <Field F>
  const auto& of() const noexcept {
    return std::get<Column<F>>(now_).values;
  }
  /// f(vector, field) for every column.
  template <class F>
  void for_each(F&& f) {
    (f(of<Fields>(), Fields{}), ...);
  }

  void save() noexcept { ((saved<Fields>().kept = saved<Fields>().is_next = false), ...); }

  /// Saves field F for restore(); to be called before F is changed in place.
  template <Field F>
  void keep() {
    auto& before = saved<F>();
    if (before.kept) return;
    before.values = of<F>();
    before.kept = true;
    before.is_next = false;
  }

  template <class Value>
  struct Advance {
    std::span<const Value> before;
    std::span<Value> after;
  };
  /// The values of field F of the owned particles, and the memory for the next ones, all of which
  /// must be written. They become the values of F with finish_advance(). If F was kept before, both
  /// are the same memory.
  template <Field F>
  auto advance(Index owned) {
    using Value = value_of<F, Dim, Real>;
    auto& now = of<F>();
    auto& next = saved<F>();
    if (next.kept) return Advance<Value>{{now.data(), owned}, {now.data(), owned}};
    resize_tightly(next.values, now.size());
    next.is_next = true;
    return Advance<Value>{{now.data(), owned}, {next.values.data(), owned}};
  }
  /// Makes the next values of all fields passed to advance() their values.
  void finish_advance(Index owned) { (finish_advance<Fields>(owned), ...); }

  void restore(Index owned) noexcept {
    (restore<Fields>(owned), ...);
    save();
  }

 private:
  template <class F>
  struct Column {
    static_assert(!std::same_as<value_of<F, Dim, Real>, bool>,
                  "silt::Particles: a column of bool is not contiguous; use std::uint8_t");
    std::vector<value_of<F, Dim, Real>> values;
  };
  template <class F>
  struct Saved : Column<F> {
    bool kept = true;      // nothing more to save
    bool is_next = false;  // holds the next values, not the saved ones
  };

  template <class F>
  auto& saved() noexcept {
    return std::get<Saved<F>>(saved_);
  }

  template <class F>
  void restore(Index owned) noexcept {
    // Owned particles only: the ghosts may differ, and the next search recreates them.
    const auto& before = saved<F>();
    if (before.kept) std::copy_n(before.values.begin(), owned, of<F>().begin());
  }

  // The ghosts keep their values.
  template <class F>
  void finish_advance(Index owned) {
    auto& now = of<F>();
    auto& other = saved<F>();
    if (!other.is_next) return;
    const auto ghosts = static_cast<std::ptrdiff_t>(owned);
    std::copy(now.begin() + ghosts, now.end(), other.values.begin() + ghosts);
    now.swap(other.values);
    other.is_next = false;
    other.kept = true;
  }

  std::tuple<Column<Fields>...> now_;
  std::tuple<Saved<Fields>...> saved_;
};

}  // namespace silt
