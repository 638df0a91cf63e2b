// SPDX-License-Identifier: MIT
// All fields of a particle container: how they are stored is in field_storage.hpp, how a step
// replaces their values in time_levels.hpp.
#pragma once

#include <silt/core/field_storage.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/time_levels.hpp>
#include <silt/core/types.hpp>

#include <array>
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

  /// All columns and bundles.
  std::span<detail::TimeLevels> all() noexcept { return units_; }

  /// The values of field F of the first n particles.
  template <Field F>
  auto view(F field, Index n) noexcept {
    return StorageWith<F>::view(field, unit_of<F>().now().data(), n);
  }
  template <Field F>
  auto view(F field, Index n) const noexcept {
    return StorageWith<F>::view(field, unit_of<F>().now().data(), n);
  }
  /// The storage of field F: a column, or the rows of a bundle.
  template <Field F>
  auto storage(F) const noexcept {
    return StorageWith<F>(unit_of<F>().now());
  }
  /// Saves field F for restore(); to be called before F is changed in place.
  template <Field F>
  void keep(F) {
    unit_of<F>().keep();
  }
  /// {before, after}: the values of field F of the owned particles, and the memory for the next
  /// ones, all of which must be written; the other fields of a bundle keep their values unless they
  /// are advanced, too. They become the values of F with TimeLevels::finish_advance(). If F was
  /// kept before, both are the same memory.
  template <Field F>
  auto advance(F field, Index owned) {
    const auto levels = unit_of<F>().advance(StorageWith<F>::template bits_of<F>);
    return detail::Advance{StorageWith<F>::view(field, levels.before, owned),
                           StorageWith<F>::view(field, levels.after, owned)};
  }
  /// The same for all fields of the bundle with field F; every number must be written.
  template <Field F>
  auto advance_rows(F) {
    const auto levels = unit_of<F>().advance(~0u);
    return detail::Advance{reinterpret_cast<const Real*>(levels.before),
                           reinterpret_cast<Real*>(levels.after)};
  }
  /// Whether the next values of field F are written to other memory, so that its present ones may
  /// be shared.
  template <Field F>
  bool is_advancing(F) const noexcept {
    return unit_of<F>().is_advancing();
  }
  /// Replaces the values of field F in rows [first, first + owners.size()) by those of the owners.
  template <Field F>
  void copy_from_owners(F, Index first, std::span<const Index> owners) {
    unit_of<F>().now().copy_to_rows(first, owners, StorageWith<F>::template place_of<F>,
                                    sizeof(value_of<F, Dim, Real>));
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
  using StorageWith = std::tuple_element_t<place_of<F>, std::tuple<StorageOf<All>...>>;
  template <class F>
  auto& unit_of() noexcept {
    return units_[place_of<F>];
  }
  template <class F>
  const auto& unit_of() const noexcept {
    return units_[place_of<F>];
  }

  std::array<detail::TimeLevels, sizeof...(All)> units_{
      detail::TimeLevels(StorageOf<All>::type)...};
};

}  // namespace silt
