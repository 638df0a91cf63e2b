// SPDX-License-Identifier: MIT
// The points near a given one among those in a range of slots.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_SEARCH_SLOTS_NEAR
#define SILT_SEARCH_SLOTS_NEAR

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <cstdint>

namespace silt::detail {

/// Writes the slots in [first, last) whose points x are within √reach of the centre to `to`, except
/// `own`, and returns their end. Reads and writes up to one register beyond the ends.
template <int Dim, class Real>
using SlotsNear = std::uint32_t*(const simd::Columns<Dim, Real>& x, Index first, Index last,
                                 const std::array<Real, Dim>& centre, Real reach, std::uint32_t own,
                                 std::uint32_t* to);

}  // namespace silt::detail

#define SILT_KERNELS <silt/search/slots_near.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::detail {

template <int Dim, class Real>
SlotsNear<Dim, Real>* slots_near() {
  return SILT_FOR_PROCESSOR(slots_near<Dim, Real>);
}

}  // namespace silt::detail

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

template <int Dim, class Real>
std::uint32_t* slots_near(const silt::simd::Columns<Dim, Real>& x, Index first, Index last,
                          const std::array<Real, Dim>& centre, Real reach, std::uint32_t own,
                          std::uint32_t* to) {
  constexpr int N = simd::lanes<Real>;
  const auto slots = [](Index s) { return simd::count_from<N>(s); };
  return simd::compress_near<N>(x, first, last, centre, reach, slots, own, to);
}

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
