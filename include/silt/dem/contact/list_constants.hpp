// SPDX-License-Identifier: MIT
// The constants of the grains (radius, mass, moment of inertia, material) with which a list of
// contacts was built. Steps do not change them; if the user does, the list has to be rebuilt.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/shared_array.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace silt::dem::detail {

/// Copies of the constants of all grains, those of the halo included.
template <class Real>
struct ListConstants {
  SharedArray<Real> radii;               ///< [m]
  SharedArray<Real> masses;              ///< [kg]
  SharedArray<Real> inertias;            ///< [kg m²]
  SharedArray<std::uint32_t> materials;  ///< indices in dem::Materials

  /// Those of the first n grains, in the memory of `before` where they are the same.
  template <class P>
  void keep(const P& grains, Index n, const ListConstants& before = {}) {
    *this = before;
    for_each_column(grains, [n](auto& values, const auto& now) {
      values.assign(now.begin(), now.begin() + std::ptrdiff_t(n), values);
    });
  }
  /// Reserves memory for those that were added since, so that add() does not throw.
  template <class P>
  void make_room(const P& grains) {
    for_each_column(grains, [](auto& values, const auto& now) { values.reserve_own(now.size()); });
  }
  /// Adds those of grains that were added since.
  template <class P>
  void add(const P& grains) {
    for_each_column(grains, [](auto& values, const auto& now) {
      for (Index i = values.size(); i < now.size(); ++i) values.push_back(now[i]);
    });
  }

  /// Compares all values that are kept. Further grains may have been added.
  template <class P>
  bool are_those_of(const P& grains) const {
    return radii.size() <= grains.local() &&
           first_where(radii.size(), differ_from(grains)) == no_index;
  }

  /// A function of the grain i: whether it has other constants. For as many grains.
  template <class P>
  auto differ_from(const P& grains) const {
    return [this, R = grains.with_halo(radius), m = grains.with_halo(mass),
            I = grains.with_halo(inertia), numbers = grains.with_halo(material)](Index i) {
      return R[i] != radii[i] || m[i] != masses[i] || I[i] != inertias[i] ||
             numbers[i] != materials[i];
    };
  }

 private:
  // f(values, values of the grains now)
  template <class P, class F>
  void for_each_column(const P& grains, F&& f) {
    f(radii, grains.with_halo(radius));
    f(masses, grains.with_halo(mass));
    f(inertias, grains.with_halo(inertia));
    f(materials, grains.with_halo(material));
  }
};

/// Whether the grains have other constants than the list. Any access to them that is not const
/// begins a new constants_revision() of the grains, even if it changes nothing; then their values
/// decide. `known` is the last revision with the values of the list; updated.
template <class P, class List>
bool have_constants_changed(const P& grains, const List& list, std::uint64_t& known) {
  const std::uint64_t revision = grains.constants_revision();
  if (known == revision) return false;
  if (!list.constants.are_those_of(grains)) return true;
  known = revision;
  return false;
}

/// Finds constants that were changed without a new constants_revision(): through a view that was
/// obtained before an earlier step. What was computed from all of them, such as the search radius,
/// is then out of date. A step compares every sixteenth block of grains: to read the constants of
/// all would take up to a tenth of it.
template <class P, class List>
class UnnoticedChanges {
  static constexpr Index period = 16;

 public:
  /// `lifetime` is the ListLifetime of the list.
  template <class Lifetime>
  UnnoticedChanges(const P& grains, const List& list, const Lifetime& lifetime)
      : constants_(list.constants),
        is_changed_(constants_.differ_from(grains)),
        is_comparable_(list.rows_revision == grains.rows_revision() &&
                       constants_.radii.size() == grains.local() &&
                       lifetime.constants_revision == grains.constants_revision()),
        turn_(lifetime.steps % period) {}

  /// Compares grains [first, last) if it is the turn of their block. May be called by several
  /// threads.
  void operator()(Index block, Index first, Index last) {
    if (block % period == turn_) compare(first, last);
  }
  void compare(Index first, Index last) {
    if (!is_comparable_) return;
    bool is_any = false;
    for (Index i = first; i < last; ++i) is_any |= is_changed_(i);
    if (!is_any) return;
    while (!is_changed_(first)) ++first;
    Index lowest = lowest_.load(std::memory_order_relaxed);
    while (first < lowest && !lowest_.compare_exchange_weak(lowest, first)) {
    }
  }

  /// Throws if one was found, naming the grain with the lowest index. The grains then have a new
  /// constants_revision(), so that the next step is for the constants as they are.
  void check(P& grains) const {
    const Index i = lowest_.load();
    if (i == no_index) return;
    grains[radius];  // access that is not const
    const auto reject = [&](const char* name, auto before, auto now, const char* unit) {
      if (before == now) return;
      fail({"dem::Contacts: ", name, " changed from ", before, " to ", now, unit,
            " through a view that was obtained too early, before a step that has been made "
            "since; obtain it again after every step, by simulation.particles()[",
            name, "]"},
           {.particle = i, .id = grains.id(i)});
    };
    const P& now = grains;
    reject("radius", constants_.radii[i], now[radius][i], " m");
    reject("mass", constants_.masses[i], now[mass][i], " kg");
    reject("inertia", constants_.inertias[i], now[inertia][i], " kg m²");
    reject("material", constants_.materials[i], now[material][i], "");
  }

 private:
  const ListConstants<typename P::Real>& constants_;
  decltype(constants_.differ_from(std::declval<const P&>())) is_changed_;
  bool is_comparable_;
  Index turn_;
  std::atomic<Index> lowest_ = no_index;
};

/// Throws if one of all grains has constants other than those of the list that went unnoticed.
template <class P, class List, class Lifetime>
void refuse_unnoticed_changes(P& grains, const List& list, const Lifetime& lifetime) {
  UnnoticedChanges changes(std::as_const(grains), list, lifetime);
  for_each_range(grains.size(), [&](Index first, Index last) { changes.compare(first, last); });
  changes.check(grains);
}

}  // namespace silt::dem::detail
