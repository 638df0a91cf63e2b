// SPDX-License-Identifier: MIT
// All fields of a particle container: how they are stored is in field_storage.hpp, how a step
// replaces their values in time_levels.hpp.
#pragma once

#include <silt/core/field_storage.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/time_levels.hpp>
#include <silt/core/types.hpp>

#include <cstdint>
#include <span>
#include <tuple>

namespace silt {

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
  /// Whether F is one of the fields.
  template <class F>
  static constexpr bool has = (StorageOf<All>::template has<F> || ...);

  /// The values of field F of the first n particles.
  template <Field F>
  auto view(F field, Index n) noexcept {
    return unit_of<F>().now().view(field, n);
  }
  template <Field F>
  auto view(F field, Index n) const noexcept {
    return unit_of<F>().now().view(field, n);
  }
  /// The storage of field F: a column, or the rows of a bundle.
  template <Field F>
  const auto& storage(F) const noexcept {
    return unit_of<F>().now();
  }

  /// f(storage) for each.
  template <class F>
  void for_each(F&& f) {
    std::apply([&](auto&... unit) { (f(unit.now()), ...); }, units_);
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
          auto sorted = std::tuple{sorted_copy(unit.now())...};
          std::apply([&](auto&... each) { (unit.now().swap(each), ...); }, sorted);
        },
        units_);
  }

  void save() noexcept {
    std::apply([](auto&... unit) { (unit.save(), ...); }, units_);
  }
  /// Saves field F for restore(); to be called before F is changed in place.
  template <Field F>
  void keep(F) {
    unit_of<F>().keep();
  }
  /// {before, after}: the values of field F of the owned particles, and the memory for the next
  /// ones, all of which must be written; the other fields of a bundle keep their values unless they
  /// are advanced, too. They become the values of F with finish_advance(). If F was kept before,
  /// both are the same memory.
  template <Field F>
  auto advance(F field, Index owned) {
    return unit_of<F>().advance(field, owned);
  }
  /// The same for all fields of the bundle with field F; every number must be written.
  template <Field F>
  auto advance_rows(F) {
    return unit_of<F>().advance_rows();
  }
  /// Whether the next values of field F are written to other memory, so that its present ones may
  /// be shared.
  template <Field F>
  bool is_advancing(F) const noexcept {
    return unit_of<F>().is_advancing();
  }
  /// Makes the next values of all fields passed to advance() their values. `ghosts` is another
  /// number whenever ghosts have changed.
  void finish_advance(Index owned, std::uint64_t ghosts) {
    std::apply([=](auto&... unit) { (unit.finish_advance(owned, ghosts), ...); }, units_);
  }
  void restore(Index owned) noexcept {
    std::apply([owned](auto&... unit) { (unit.restore(owned), ...); }, units_);
  }

 private:
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
  const auto& unit_of() const noexcept {
    return std::get<place_of<F>>(units_);
  }

  std::tuple<detail::TimeLevels<StorageOf<All>>...> units_;
};

}  // namespace silt
