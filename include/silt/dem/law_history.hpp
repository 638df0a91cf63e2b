// SPDX-License-Identifier: MIT
// What a law remembers of a contact, as numbers in a row, and what may be asked of a law that does.
#pragma once

#include <silt/core/lane.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>

#include <concepts>
#include <cstring>

namespace silt::dem {

/// What a law remembers, as a row of Reals; none for a law without memory.
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
  static constexpr int words =
      static_cast<int>((sizeof(type) + sizeof(Real) - 1) / sizeof(Real));
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
// A scalar of odd size: among such, anything else shows in the size of the whole.
struct OddScalar {
  float parts[3];
};
// The memory's Reals, with the padding that the alignment of a vector may put behind them.
template <class History, class Scalar, class OfOddScalars>
inline constexpr bool holds_only =
    sizeof(OfOddScalars) % sizeof(OddScalar) == 0 &&
    (sizeof(OfOddScalars) / sizeof(OddScalar) * sizeof(Scalar) + alignof(History) - 1) /
            alignof(History) * alignof(History) ==
        sizeof(History);
template <class Law, int Dim, class Real>
concept RemembersRealsOnly =
    !LawWithHistory<Law, Dim, Real> ||
    (holds_only<typename Law::template History<Dim, Real>, Real,
                typename Law::template History<Dim, OddScalar>> &&
     sizeof(typename Law::template History<Dim, Lane<Real>>) ==
         sizeof(typename Law::template History<Dim, Real>));
}  // namespace detail

/// The law is written for any scalar, and remembers nothing but Reals: the same code then works on
/// eight contacts at once.
template <class Law, int Dim, class Real>
concept LawInLanes =
    ContactLaw<Law, Dim, Lane<Real>> && detail::RemembersRealsOnly<Law, Dim, Real>;

/// The law tells the energy [J] in its springs.
template <class Law, int Dim, class Real>
concept TellsEnergy = requires(const Law law, const Contact<Dim, Real> contact,
                               const typename LawHistory<Law, Dim, Real>::type history) {
  { law.elastic_energy(contact, history) } -> std::convertible_to<double>;
};

}  // namespace silt::dem
