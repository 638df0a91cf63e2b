// SPDX-License-Identifier: MIT
// How the values of fields lie in memory. A field is stored as a column of its own, or side by side
// with others in a Bundle:
//
//   mass                               [ m0 m1 m2 … ]
//   Bundle<position_t, radius_t, …>    [ x0 y0 z0 R0 … | x1 y1 z1 R1 … | … ]
//
// A loop over all particles is faster over columns, access to single particles, as by the contacts
// of grains, is faster in a bundle, because their values share a cache line.
#pragma once

#include <silt/core/cache_aligned.hpp>
#include <silt/core/field_view.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

/// Fields stored side by side in this order, one row of numbers for each particle. Their values
/// must consist of Reals.
template <Field... Fs>
struct Bundle {};

/// Whether T is a Bundle.
template <class T>
inline constexpr bool is_bundle = false;
template <Field... Fs>
inline constexpr bool is_bundle<Bundle<Fs...>> = true;

/// A field, or a Bundle of fields.
template <class T>
concept FieldOrBundle = Field<T> || is_bundle<T>;

namespace detail {

template <class T, class F>
inline constexpr bool bundle_has = false;
template <Field... Fs, class F>
inline constexpr bool bundle_has<Bundle<Fs...>, F> = (std::same_as<F, Fs> || ...);

// From fields and bundles: the fields, and what is stored, that is, the bundles and the other
// fields.
template <class... All>
struct StorageList {
  template <class F>
  static constexpr bool in_bundle = (bundle_has<All, F> || ...);
  template <bool chosen, class T>
  using If = std::conditional_t<chosen, std::tuple<T>, std::tuple<>>;
  using List = decltype(std::tuple_cat(std::declval<If<!is_bundle<All>, All>>()...));
  using Units = decltype(std::tuple_cat(std::declval<If<!in_bundle<All>, All>>()...));
};

// The values of one field.
template <int Dim, class Real, Field F>
class Column {
  using Value = value_of<F, Dim, Real>;
  static_assert(!std::same_as<Value, bool>,
                "silt::Particles: a column of bool is not contiguous; use std::uint8_t");

 public:
  template <class Other>
  static constexpr bool has = std::same_as<F, Other>;
  /// A bit for each field stored here.
  template <class>
  static constexpr unsigned bit_of = 1;

  Index size() const noexcept { return values_.size(); }
  void reserve(Index n) { values_.reserve(n); }
  void resize(Index n) {
    if (n > values_.capacity()) values_.reserve(n + n / 16);
    values_.resize(n, zero_of<Value>());
  }
  void push_zero() { values_.push_back(zero_of<Value>()); }
  void push_copy(Index i) {
    const Value value = values_[i];
    values_.push_back(value);
  }
  void copy(Index from, Index to) { values_[to] = values_[from]; }
  void copy_from(const Column& other, Index first, Index last) {
    std::copy(other.values_.begin() + std::ptrdiff_t(first),
              other.values_.begin() + std::ptrdiff_t(last),
              values_.begin() + std::ptrdiff_t(first));
  }
  void swap(Column& other) noexcept { values_.swap(other.values_); }

  std::span<Value> view(F, Index n) noexcept { return {values_.data(), n}; }
  std::span<const Value> view(F, Index n) const noexcept { return {values_.data(), n}; }
  template <class Visit>
  void for_each_field(Visit&& visit) const {
    visit(F{});
  }

 private:
  std::vector<Value> values_;
};

template <int Dim, class Real, class B>
class Rows;
// The values of several fields, by particle.
template <int Dim, class Real, Field... Fs>
class Rows<Dim, Real, Bundle<Fs...>> {
  template <class F>
  static constexpr Index numbers_of = sizeof(value_of<F, Dim, Real>) / sizeof(Real);
  static_assert(((sizeof(value_of<Fs, Dim, Real>) % sizeof(Real) == 0) && ...),
                "silt::Bundle: a field does not consist of Reals");

 public:
  template <class F>
  static constexpr bool has = (std::same_as<F, Fs> || ...);
  /// Numbers per particle.
  static constexpr Index width = (numbers_of<Fs> + ...);
  /// First number of a field in a row.
  template <class F>
  static constexpr Index offset = [] {
    Index sum = 0;
    bool found = false;
    ((found = found || std::same_as<F, Fs>, sum += found ? 0 : numbers_of<Fs>), ...);
    return sum;
  }();
  /// A bit for each field stored here.
  template <class F>
  static constexpr unsigned bit_of = 1u << offset<F>;
  static_assert(width <= 32, "silt::Bundle: more than 32 numbers");
  static_assert(((offset<Fs> * sizeof(Real) % alignof(value_of<Fs, Dim, Real>) == 0 &&
                  width * sizeof(Real) % alignof(value_of<Fs, Dim, Real>) == 0) &&
                 ...),
                "silt::Bundle: in this order, a vector is not aligned");

  using Numbers = std::vector<Real, CacheAligned<Real>>;

  Rows() = default;
  Rows(Rows&& other) { swap(other); }
  Rows& operator=(Rows&& other) {
    swap(other);
    return *this;
  }
  Rows(const Rows& other) : numbers_(std::make_shared<Numbers>(*other.numbers_)) {}
  Rows& operator=(const Rows& other) {
    replace_if_shared();
    *numbers_ = *other.numbers_;
    return *this;
  }

  /// The numbers, which must not be changed while they are shared.
  std::shared_ptr<const Numbers> share() const { return numbers_; }
  bool is_shared() const noexcept {
    if (numbers_.use_count() > 1) return true;
    // The last other owner may have read them in another thread.
    std::atomic_thread_fence(std::memory_order_acquire);
    return false;
  }
  /// Whether the numbers were replaced by none.
  bool replace_if_shared() {
    if (!is_shared()) return false;
    numbers_ = std::make_shared<Numbers>();
    return true;
  }

  Index size() const noexcept { return numbers_->size() / width; }
  void reserve(Index n) { numbers_->reserve(n * width); }
  void resize(Index n) { resize_tightly(*numbers_, n * width); }
  void push_zero() { numbers_->resize(numbers_->size() + width); }
  void push_copy(Index i) {
    push_zero();
    copy(i, size() - 1);
  }
  void copy(Index from, Index to) {
    std::copy_n(numbers_->data() + from * width, width, numbers_->data() + to * width);
  }
  void copy_from(const Rows& other, Index first, Index last) {
    std::copy(other.numbers_->data() + first * width, other.numbers_->data() + last * width,
              numbers_->data() + first * width);
  }
  void swap(Rows& other) noexcept { numbers_.swap(other.numbers_); }

  template <class F>
  FieldView<value_of<F, Dim, Real>, Real, width> view(F, Index n) noexcept {
    return {beyond<F>(reinterpret_cast<std::byte*>(numbers_->data())), n};
  }
  template <class F>
  FieldView<const value_of<F, Dim, Real>, Real, width> view(F, Index n) const noexcept {
    return {beyond<F>(reinterpret_cast<const std::byte*>(numbers_->data())), n};
  }
  template <class Visit>
  void for_each_field(Visit&& visit) const {
    (visit(Fs{}), ...);
  }

  /// Number k of particle i is rows()[width i + k].
  Real* rows() noexcept { return numbers_->data(); }
  const Real* rows() const noexcept { return numbers_->data(); }

 private:
  // The field in the first row. An offset of the null pointer, of empty storage, is undefined for
  // pointers, but not for integers.
  template <class F, class Byte>
  static Byte* beyond(Byte* rows) noexcept {
    return reinterpret_cast<Byte*>(reinterpret_cast<std::uintptr_t>(rows) +
                                   offset<F> * sizeof(Real));
  }

  std::shared_ptr<Numbers> numbers_ = std::make_shared<Numbers>();
};

template <int Dim, class Real, class S>
struct StorageOf {
  using type = Column<Dim, Real, S>;
};
template <int Dim, class Real, Field... Fs>
struct StorageOf<Dim, Real, Bundle<Fs...>> {
  using type = Rows<Dim, Real, Bundle<Fs...>>;
};

}  // namespace detail

}  // namespace silt
