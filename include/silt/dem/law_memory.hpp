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
struct LawMemory {
  using type = NoMemory;
  static constexpr int words = 0;
  static type from(const Real*) { return {}; }
  static void put(const type&, Real*) {}
};
template <class Law, int Dim, class Real>
  requires LawWithMemory<Law, Dim, Real>
struct LawMemory<Law, Dim, Real> {
  using type = typename Law::template Memory<Dim, Real>;
  static constexpr int words =
      static_cast<int>((sizeof(type) + sizeof(Real) - 1) / sizeof(Real));
  static type from(const Real* row) {
    type memory{};
    std::memcpy(static_cast<void*>(&memory), row, sizeof memory);
    return memory;
  }
  static void put(const type& memory, Real* row) {
    std::memcpy(row, static_cast<const void*>(&memory), sizeof memory);
  }
};

namespace detail {
// A scalar of odd size: among such, anything else shows in the size of the whole.
struct OddScalar {
  float parts[3];
};
// The memory's Reals, with the padding that the alignment of a vector may put behind them.
template <class Memory, class Scalar, class OfOddScalars>
inline constexpr bool holds_only =
    sizeof(OfOddScalars) % sizeof(OddScalar) == 0 &&
    (sizeof(OfOddScalars) / sizeof(OddScalar) * sizeof(Scalar) + alignof(Memory) - 1) /
            alignof(Memory) * alignof(Memory) ==
        sizeof(Memory);
template <class Law, int Dim, class Real>
concept RemembersRealsOnly =
    !LawWithMemory<Law, Dim, Real> ||
    (holds_only<typename Law::template Memory<Dim, Real>, Real,
                typename Law::template Memory<Dim, OddScalar>> &&
     sizeof(typename Law::template Memory<Dim, Lane<Real>>) ==
         sizeof(typename Law::template Memory<Dim, Real>));
}  // namespace detail

/// The law is written for any scalar, and remembers nothing but Reals: the same code then works on
/// eight contacts at once.
template <class Law, int Dim, class Real>
concept LawInLanes =
    ContactLaw<Law, Dim, Lane<Real>> && detail::RemembersRealsOnly<Law, Dim, Real>;

/// The law tells the energy [J] in its springs.
template <class Law, int Dim, class Real>
concept TellsEnergy = requires(const Law law, const Contact<Dim, Real> contact,
                               const typename LawMemory<Law, Dim, Real>::type memory) {
  { law.elastic_energy(contact, memory) } -> std::convertible_to<double>;
};

}  // namespace silt::dem
