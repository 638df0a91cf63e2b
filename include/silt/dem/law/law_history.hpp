// SPDX-License-Identifier: MIT
// The history of a contact as an array of numbers, and concepts that depend on it.
#pragma once

#include <silt/core/lane.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>

#include <concepts>
#include <cstring>

namespace silt::dem {

/// The history of a law as an array of `words` Reals; empty for a law without history. from(row)
/// reads it from the array, put(history, row) writes it there.
template <class Law, int Dim, class Real>
struct LawHistory {
  using type = NoHistory;
  static constexpr int words = 0;
  static type from(const Real*) { return {}; }
  static void put(const type&, Real*) {}
};
template <class Law, int Dim, class Real>
  requires LawWithHistory<Law, Dim, Real>
struct LawHistory<Law, Dim, Real> {
  using type = typename Law::template History<Dim, Real>;
  static constexpr int words = static_cast<int>((sizeof(type) + sizeof(Real) - 1) / sizeof(Real));
  static type from(const Real* row) {
    type history{};
    std::memcpy(static_cast<void*>(&history), row, sizeof history);
    return history;
  }
  static void put(const type& history, Real* row) {
    std::memcpy(row, static_cast<const void*>(&history), sizeof history);
  }
};

namespace detail {
// A scalar of unusual size: members of any other type show in the size of the whole struct.
struct OddScalar {
  float parts[3];
};
// The history has only Reals, apart from padding for the alignment of its vectors at the end.
template <class History, class Scalar, class OfOddScalars>
inline constexpr bool holds_only =
    sizeof(OfOddScalars) % sizeof(OddScalar) == 0 &&
    (sizeof(OfOddScalars) / sizeof(OddScalar) * sizeof(Scalar) + alignof(History) - 1) /
            alignof(History) * alignof(History) ==
        sizeof(History);
template <class Law, int Dim, class Real>
concept HistoryIsRealsOnly = !LawWithHistory<Law, Dim, Real> ||
                             (holds_only<typename Law::template History<Dim, Real>, Real,
                                         typename Law::template History<Dim, OddScalar>> &&
                              sizeof(typename Law::template History<Dim, Lane<Real>>) ==
                                  sizeof(typename Law::template History<Dim, Real>));
}  // namespace detail

/// The law accepts any scalar type and its history consists of Reals only: the same code can then
/// evaluate eight contacts at once.
template <class Law, int Dim, class Real>
concept LawInLanes = ContactLaw<Law, Dim, Lane<Real>> && detail::HistoryIsRealsOnly<Law, Dim, Real>;

/// The law provides the energy [J] stored in its springs.
template <class Law, int Dim, class Real>
concept GivesEnergy = requires(const Law law, const Contact<Dim, Real> contact,
                               const typename LawHistory<Law, Dim, Real>::type history) {
  { law.elastic_energy(contact, history) } -> std::convertible_to<double>;
};

}  // namespace silt::dem
