// SPDX-License-Identifier: MIT
// How a particle container stores its fields, and rolls them back after a failed step.
//
// A field is stored as a column of its own, or side by side with others in a Bundle:
//
//   mass                               [ m0 m1 m2 … ]
//   Bundle<position_t, radius_t, …>    [ x0 y0 z0 R0 … | x1 y1 z1 R1 … | … ]
//
// A loop over all particles is faster over columns, access to single particles, as by the contacts
// of grains, is faster in a bundle, because their values share a cache line.
#pragma once

#include <silt/core/field_view.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
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

// Memory that begins at a cache line.
template <class T>
struct CacheAligned {
  using value_type = T;
  CacheAligned() = default;
  template <class Other>
  CacheAligned(const CacheAligned<Other>&) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(64)));
  }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, std::align_val_t(64)); }
  friend bool operator==(const CacheAligned&, const CacheAligned&) { return true; }
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
  void swap(Column& other) noexcept {
    values_.swap(other.values_);
    std::swap(ghosts, other.ghosts);
  }

  std::span<Value> view(F, Index n) noexcept { return {values_.data(), n}; }
  std::span<const Value> view(F, Index n) const noexcept { return {values_.data(), n}; }
  template <class Visit>
  void for_each_field(Visit&& visit) const {
    visit(F{});
  }

  std::uint64_t ghosts = 0;  ///< see Columns::finish_advance; set by it

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
  Rows(const Rows& other)
      : ghosts(other.ghosts), numbers_(std::make_shared<Numbers>(*other.numbers_)) {}
  Rows& operator=(const Rows& other) {
    replace_if_shared();
    *numbers_ = *other.numbers_;
    ghosts = other.ghosts;
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
  void replace_if_shared() {
    if (!is_shared()) return;
    numbers_ = std::make_shared<Numbers>();
    ghosts = 0;
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
  void swap(Rows& other) noexcept {
    numbers_.swap(other.numbers_);
    std::swap(ghosts, other.ghosts);
  }

  template <class F>
  FieldView<value_of<F, Dim, Real>, Real, width> view(F, Index n) noexcept {
    return {reinterpret_cast<std::byte*>(numbers_->data()) + offset<F> * sizeof(Real), n};
  }
  template <class F>
  FieldView<const value_of<F, Dim, Real>, Real, width> view(F, Index n) const noexcept {
    return {reinterpret_cast<const std::byte*>(numbers_->data()) + offset<F> * sizeof(Real), n};
  }
  template <class Visit>
  void for_each_field(Visit&& visit) const {
    (visit(Fs{}), ...);
  }

  /// Number k of particle i is rows()[width i + k].
  Real* rows() noexcept { return numbers_->data(); }
  const Real* rows() const noexcept { return numbers_->data(); }

  std::uint64_t ghosts = 0;  ///< see Columns::finish_advance; set by it

 private:
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

/// The fields of all particles, first the owned ones, then the ghosts. A failed step is rolled back
/// with save() before it and restore() after. restore() recovers the fields passed to keep() or
/// advance() in between, and those in the same bundles; all others keep their present values.
template <int Dim, class Real, class Units>
class Columns;
template <int Dim, class Real, FieldOrBundle... All>
class Columns<Dim, Real, std::tuple<All...>> {
  template <class S>
  using StorageOf = typename detail::StorageOf<Dim, Real, S>::type;

 public:
  template <class F>
  static constexpr bool has = (StorageOf<All>::template has<F> || ...);

  /// The values of field F of the first n particles.
  template <Field F>
  auto view(F field, Index n) noexcept {
    return now<F>().view(field, n);
  }
  template <Field F>
  auto view(F field, Index n) const noexcept {
    return now<F>().view(field, n);
  }
  /// The storage of field F: a column, or the rows of a bundle.
  template <Field F>
  const auto& storage(F) const noexcept {
    return now<F>();
  }

  /// f(storage) for each.
  template <class F>
  void for_each(F&& f) {
    std::apply([&](auto&... unit) { (f(unit.now), ...); }, units_);
  }
  template <class F>
  void for_each(F&& f) const {
    std::apply([&](const auto&... unit) { (f(unit.now), ...); }, units_);
  }
  /// Moves row order[i] to row i. If it throws, nothing has changed.
  void reorder(std::span<const Index> order) {
    const auto sorted_copy = [order](const auto& storage) {
      auto sorted = storage;
      storage.for_each_field([&](auto field) {
        const auto from = storage.view(field, storage.size());
        const auto to = sorted.view(field, sorted.size());
        silt::for_each(order.size(), [&](Index i) { to[i] = from[order[i]]; });
      });
      return sorted;
    };
    std::apply(
        [&](auto&... unit) {
          auto sorted = std::tuple{sorted_copy(unit.now)...};
          std::apply([&](auto&... each) { (unit.now.swap(each), ...); }, sorted);
        },
        units_);
  }

  void save() noexcept {
    std::apply([](auto&... unit) { ((unit.kept = unit.is_next = false), ...); }, units_);
  }

  /// Saves field F for restore(); to be called before F is changed in place.
  template <Field F>
  void keep(F) {
    auto& unit = unit_of<F>();
    if (unit.kept) return;
    unit.other = unit.now;
    unit.kept = true;
    unit.is_next = false;
  }

  template <class Before, class After>
  struct Advance {
    Before before;
    After after;
  };
  /// The values of field F of the owned particles, and the memory for the next ones, all of which
  /// must be written; the other fields of a bundle keep their values unless they are advanced, too.
  /// They become the values of F with finish_advance(). If F was kept before, both are the same
  /// memory.
  template <Field F>
  auto advance(F field, Index owned) {
    auto& unit = unit_of<F>();
    auto before = std::as_const(unit.now).view(field, owned);
    auto present = unit.now.view(field, owned);
    if (unit.kept) return Advance<decltype(before), decltype(present)>{before, present};
    unit.begin_advance();
    unit.advanced |= unit.now.template bit_of<F>;
    return Advance<decltype(before), decltype(present)>{before, unit.other.view(field, owned)};
  }
  /// The same for all fields of the bundle with field F; every number must be written.
  struct AdvanceRows {
    const Real* before;
    Real* after;
  };
  template <Field F>
  AdvanceRows advance_rows(F) {
    auto& unit = unit_of<F>();
    if (!unit.kept) unit.begin_advance();
    unit.advanced = ~0u;
    return {std::as_const(unit.now).rows(), unit.is_next ? unit.other.rows() : unit.now.rows()};
  }
  /// Whether the next values of field F are written to other memory, so that its present ones may
  /// be shared.
  template <Field F>
  bool is_advancing(F) const noexcept {
    return std::get<place_of<F>>(units_).is_next;
  }
  /// Makes the next values of all fields passed to advance() their values. `ghosts` is another
  /// number whenever ghosts have changed.
  void finish_advance(Index owned, std::uint64_t ghosts) {
    std::apply([=](auto&... unit) { (unit.finish_advance(owned, ghosts), ...); }, units_);
  }

  void restore(Index owned) noexcept {
    // Owned particles only: the ghosts may differ, and the next search recreates them.
    std::apply(
        [owned](auto&... unit) {
          ((unit.kept ? unit.now.copy_from(unit.other, 0, owned) : void()), ...);
        },
        units_);
    save();
  }

 private:
  template <class Storage>
  struct Unit {
    static constexpr bool is_of_bundle = requires(Storage s) { s.rows(); };
    struct None {};
    Storage now;
    Storage other;  // the saved values, or the next ones
    // Takes the place of `other` while that is shared.
    [[no_unique_address]] std::conditional_t<is_of_bundle, Storage, None> spare;
    bool kept = true;       // nothing more to save
    bool is_next = false;   // `other` holds the next values
    unsigned advanced = 0;  // of which fields, by bit_of

    void begin_advance() {
      if (is_next) return;
      if constexpr (is_of_bundle) {
        if (other.is_shared()) other.swap(spare);
        other.replace_if_shared();
      }
      if (other.size() != now.size()) other.resize(now.size());
      is_next = true;
      advanced = 0;
    }

    // The ghosts keep their values, which `other` may still have from an earlier step.
    void finish_advance(Index owned, std::uint64_t ghosts) {
      if (!is_next) return;
      now.for_each_field([&]<class F>(F field) {
        if ((advanced & Storage::template bit_of<F>) != 0) return;
        const auto from = std::as_const(now).view(field, owned);
        const auto to = other.view(field, owned);
        silt::for_each(owned, [&](Index i) { to[i] = from[i]; });
      });
      if (other.ghosts != ghosts) other.copy_from(now, owned, now.size());
      now.ghosts = other.ghosts = ghosts;
      now.swap(other);
      is_next = false;
      kept = true;
    }
  };

  template <class F>
  static constexpr Index place_of = [] {
    Index place = 0;
    Index k = 0;
    ((place = StorageOf<All>::template has<F> ? k : place, ++k), ...);
    return place;
  }();
  template <class F>
  auto& unit_of() noexcept {
    return std::get<place_of<F>>(units_);
  }
  template <class F>
  auto& now() noexcept {
    return std::get<place_of<F>>(units_).now;
  }
  template <class F>
  const auto& now() const noexcept {
    return std::get<place_of<F>>(units_).now;
  }

  std::tuple<Unit<StorageOf<All>>...> units_;
};

}  // namespace silt
