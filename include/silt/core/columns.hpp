// SPDX-License-Identifier: MIT
// The columns of a container, one for each field, and how a step that fails is undone in them.
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

/// One vector of values for each of the fields, all equally long: first those of owned particles,
/// then those of ghosts. A step is a transaction: save() before it, restore() if it throws. What is
/// neither kept nor advanced in between is not brought back: constants need not be, and what a step
/// derives is as far as it came.
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

  /// Keeps field F as it is for restore(), before it is changed in place.
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
  /// Values of field F of the owned particles, and the place for the next ones, all of which must
  /// be written; they take the former's place with arrive(). The two are one and the same where F
  /// was kept before.
  template <Field F>
  auto advance(Index owned) {
    using Value = value_of<F, Dim, Real>;
    auto& now = of<F>();
    auto& next = saved<F>();
    if (next.kept) return Advance<Value>{{now.data(), owned}, {now.data(), owned}};
    resize_sparingly(next.values, now.size());
    next.is_next = true;
    return Advance<Value>{{now.data(), owned}, {next.values.data(), owned}};
  }
  /// All fields that advance have their next values.
  void arrive(Index owned) { (arrive<Fields>(owned), ...); }

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
    bool kept = true;      // there is nothing more to save
    bool is_next = false;  // it holds what comes, rather than what was
  };

  template <class F>
  auto& saved() noexcept {
    return std::get<Saved<F>>(saved_);
  }

  template <class F>
  void restore(Index owned) noexcept {
    // Ghosts may have come or gone since; they are made anew by the next search.
    const auto& before = saved<F>();
    if (before.kept) std::copy_n(before.values.begin(), owned, of<F>().begin());
  }

  // Ghosts stay as they are.
  template <class F>
  void arrive(Index owned) {
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
