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

#include <silt/core/column.hpp>
#include <silt/core/field_view.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

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

// How a field that has a column of its own lies in it.
template <int Dim, class Real, Field F>
class ColumnOf {
  using Value = value_of<F, Dim, Real>;
  static_assert(alignof(Value) <= array_alignment,
                "silt::Particles: a field's values are overaligned");

 public:
  template <class Other>
  static constexpr bool has = std::same_as<F, Other>;
  static constexpr const RowType& type = row_type_of<Value>;
  /// A bit for each number of a field in a row.
  template <class>
  static constexpr unsigned bits_of = 1;
  template <class>
  static constexpr Index place_of = 0;  // in a row [bytes]

  explicit ColumnOf(const Column&) {}

  static std::span<Value> view(F, std::byte* first, Index n) noexcept {
    return {reinterpret_cast<Value*>(first), n};
  }
  static std::span<const Value> view(F, const std::byte* first, Index n) noexcept {
    return {reinterpret_cast<const Value*>(first), n};
  }
};

template <int Dim, class Real, class B>
class RowsOf;
// How several fields lie in the rows of their bundle.
template <int Dim, class Real, Field... Fs>
class RowsOf<Dim, Real, Bundle<Fs...>> {
  template <class F>
  static constexpr Index numbers_of = sizeof(value_of<F, Dim, Real>) / sizeof(Real);
  static_assert((is_of_numbers<value_of<Fs, Dim, Real>> && ...) &&
                    ((sizeof(value_of<Fs, Dim, Real>) % sizeof(Real) == 0) && ...),
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
  /// A bit for each number of a field in a row.
  template <class F>
  static constexpr unsigned bits_of = ((1u << numbers_of<F>)-1) << offset<F>;
  template <class F>
  static constexpr Index place_of = offset<F> * sizeof(Real);  // in a row [bytes]
  static_assert(width < 32, "silt::Bundle: more than 31 numbers");
  static_assert(((place_of<Fs> % alignof(value_of<Fs, Dim, Real>) == 0 &&
                  width * sizeof(Real) % alignof(value_of<Fs, Dim, Real>) == 0) &&
                 ...),
                "silt::Bundle: in this order, a vector is not aligned");
  static constexpr RowType type{width * sizeof(Real), sizeof(Real)};

  explicit RowsOf(const Column& rows) : rows_(&rows) {}

  /// Number k of particle i is rows()[width i + k].
  const Real* rows() const noexcept { return reinterpret_cast<const Real*>(rows_->data()); }
  /// All numbers.
  std::span<const Real> numbers() const noexcept { return {rows(), width * rows_->size()}; }
  /// The numbers, which must not be changed while they are shared.
  std::shared_ptr<const Real> share() const { return {rows_->share(), rows()}; }

  template <class F>
  static FieldView<value_of<F, Dim, Real>, Real, width> view(F, std::byte* first,
                                                             Index n) noexcept {
    return {beyond<F>(first), n};
  }
  template <class F>
  static FieldView<const value_of<F, Dim, Real>, Real, width> view(F, const std::byte* first,
                                                                   Index n) noexcept {
    return {beyond<F>(first), n};
  }

 private:
  // The field in the first row. An offset of the null pointer, of empty storage, is undefined for
  // pointers, but not for integers.
  template <class F, class Byte>
  static Byte* beyond(Byte* first) noexcept {
    return reinterpret_cast<Byte*>(reinterpret_cast<std::uintptr_t>(first) + place_of<F>);
  }

  const Column* rows_;
};

template <int Dim, class Real, class S>
struct StorageOf {
  using type = ColumnOf<Dim, Real, S>;
};
template <int Dim, class Real, Field... Fs>
struct StorageOf<Dim, Real, Bundle<Fs...>> {
  using type = RowsOf<Dim, Real, Bundle<Fs...>>;
};

}  // namespace detail

}  // namespace silt
