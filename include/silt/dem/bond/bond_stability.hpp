// SPDX-License-Identifier: MIT
// The time step at which bonds alone are stable.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/bond/bond_indices.hpp>
#include <silt/dem/bond/parallel_bond.hpp>
#include <silt/dem/contact/stable_time_step.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace silt::dem::detail {

/// R_a/(R_a + R_b) [-]: the position between the centres at which the bond's force acts.
template <class P>
typename P::Real arm_of_a(const P& grains, const BondEnds& ends) {
  const auto R = grains[radius][ends.a];
  return R / (R + grains[radius][ends.b]);
}

template <class P>
BeamSection section_at(const P& grains, const BondEnds& ends, const ParallelBond& law) {
  const auto R = grains[radius];
  return section_of<P::dimension>(law, double(std::min(R[ends.a], R[ends.b])));
}

/// The stability limit of the bonds, and the grain that has it. Rotations hardly change it, and broken
/// bonds do not lower it: it is found again when bonds are added, or when a radius, mass or moment of
/// inertia has changed.
class BondStability {
 public:
  double time_step() const noexcept { return time_step_; }  ///< [s]
  Id grain() const noexcept { return grain_; }

  /// Bonds were added.
  void forget() noexcept {
    is_known_ = false;
    constants_revision_ = 0;
  }
  /// Finds the limit again if it is not that of these grains.
  template <class P, class B>
  void update(const P& grains, const std::vector<B>& bonds, const BondIndices& indices,
              const ParallelBond& law) {
    if (constants_revision_ == grains.constants_revision() &&
        owned_revision_ == grains.owned_revision()) {
      return;
    }
    const std::uint64_t constants = checksum_of_constants(grains);
    if (!is_known_ || constants != constants_) {
      find(grains, bonds, indices, law);
      constants_ = constants;
      is_known_ = true;
    }
    constants_revision_ = grains.constants_revision();
    owned_revision_ = grains.owned_revision();
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("stable_time_step", time_step_);
    archive("least_stable", grain_);
    archive("is_stability_known", is_known_);
    archive("constants", constants_);
    if constexpr (Archive::reads) constants_revision_ = owned_revision_ = 0;
  }

 private:
  template <class P, class B>
  void find(const P& grains, const std::vector<B>& bonds, const BondIndices& indices,
            const ParallelBond& law) {
    using Real = typename P::Real;
    time_step_ = std::numeric_limits<double>::infinity();
    grain_ = 0;
    for (Index i = 0; i < grains.size(); ++i) {
      FrequencyBound bound(P::dimension);
      for (const Index k : indices.of(i)) {
        const BondEnds ends = indices.ends(k);
        const Real m_a = grains[mass][ends.a];
        const Real m_b = grains[mass][ends.b];
        const Real share = arm_of_a(grains, ends);
        bound.add(
            three_components(bonds[k].normal),
            springs_of(law, section_at(grains, ends, law)).stiffness(law.beta),
            {.mass_over_inertia = double(grains[mass][i]) / double(grains[inertia][i]),
             .arm = double((ends.a == i ? share : 1 - share) * bonds[k].length)},
            share_of(double(grains[mass][i]), double(m_a / (m_a + m_b) * m_b), Shares::equal));
      }
      const double stable = bound.stable_time_step();
      if (!(stable < time_step_)) continue;
      time_step_ = stable;
      grain_ = grains.id(i);
    }
  }

  // Of the radii, masses and moments of inertia of all grains, in any order in memory.
  template <class P>
  static std::uint64_t checksum_of_constants(const P& grains) {
    std::uint64_t sum = 0;
    for (Index i = 0; i < grains.size(); ++i) {
      std::uint64_t of_grain = grains.id(i);
      for (const auto value : {grains[radius][i], grains[mass][i], grains[inertia][i]}) {
        of_grain = (of_grain ^ std::bit_cast<std::uint64_t>(double(value))) * 0x9e3779b97f4a7c15;
        of_grain ^= of_grain >> 32;
      }
      sum += of_grain;
    }
    return sum;
  }

  double time_step_ = std::numeric_limits<double>::infinity();
  Id grain_ = 0;
  bool is_known_ = false;
  std::uint64_t constants_ = 0;           // checksum of those with which it was found
  std::uint64_t constants_revision_ = 0;  // of the grains with this checksum
  std::uint64_t owned_revision_ = 0;
};

}  // namespace silt::dem::detail
