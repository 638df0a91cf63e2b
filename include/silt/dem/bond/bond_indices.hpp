// SPDX-License-Identifier: MIT
// The indices of the grains of each bond, the bonds of each grain, and their stable time step.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/bond/parallel_bond.hpp>
#include <silt/dem/contact/stable_time_step.hpp>
#include <silt/dem/law/contact.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace silt::dem {

/// Indices of a bond's two grains; `no_index` for a removed grain.
struct BondEnds {
  Index a;
  Index b;
};
template <class P, class B>
BondEnds ends_of(const P& grains, const B& bond) {
  return {grains.index_of(bond.a), grains.index_of(bond.b)};
}

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

/// Updated when bonds or grains are added, removed or reordered.
class BondIndices {
 public:
  template <class P>
  bool are_valid_for(const P& grains) const {
    return is_valid_ && grains.revision() == revision_;
  }
  void invalidate() noexcept { is_valid_ = false; }

  /// Removes the bonds of removed grains from the list and finds the grains of the others.
  template <class P, class B>
  void find(const P& grains, std::vector<B>& bonds) {
    std::erase_if(bonds, [&](const B& bond) {
      const BondEnds ends = ends_of(grains, bond);
      return ends.a == no_index || ends.b == no_index;
    });
    ends_.clear();
    first_.assign(grains.size() + 1, 0);
    for (const B& bond : bonds) {
      const BondEnds ends = ends_of(grains, bond);
      ends_.push_back(ends);
      ++first_[ends.a + 1];
      ++first_[ends.b + 1];
    }
    for (Index i = 0; i < grains.size(); ++i) first_[i + 1] += first_[i];
    numbers_.resize(2 * bonds.size());
    next_.assign(first_.begin(), first_.end() - 1);
    for (Index k = 0; k < bonds.size(); ++k) {
      numbers_[next_[ends_[k].a]++] = k;
      numbers_[next_[ends_[k].b]++] = k;
    }
    revision_ = grains.revision();
    is_valid_ = true;
  }

  const BondEnds& ends(Index bond) const noexcept { return ends_[bond]; }
  /// Indices of the bonds of grain i, in ascending order.
  std::span<const Index> of(Index i) const noexcept {
    return std::span(numbers_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

 private:
  std::vector<BondEnds> ends_;
  std::vector<Index> first_;  // by grain
  std::vector<Index> numbers_;
  std::vector<Index> next_;
  std::uint64_t revision_ = 0;
  bool is_valid_ = false;
};

/// Stability limit of the bonds alone, and the grain that has it.
struct BondStability {
  double time_step = std::numeric_limits<double>::infinity();  ///< [s]
  Id grain = 0;
};
template <class P, class B>
BondStability stability_of(const P& grains, const std::vector<B>& bonds, const BondIndices& indices,
                           const ParallelBond& law) {
  using Real = typename P::Real;
  BondStability least;
  for (Index i = 0; i < grains.size(); ++i) {
    FrequencyBound<P::dimension, Real> bound;
    for (const Index k : indices.of(i)) {
      const BondEnds ends = indices.ends(k);
      const Real m_a = grains[mass][ends.a];
      const Real m_b = grains[mass][ends.b];
      Contact<P::dimension, Real> contact;
      contact.normal = bonds[k].normal;
      contact.effective_mass = m_a / (m_a + m_b) * m_b;
      const Real share = arm_of_a(grains, ends);
      bound.add(contact, springs_of(law, section_at(grains, ends, law)).stiffness(law.beta),
                {.mass = double(grains[mass][i]),
                 .inertia = double(grains[inertia][i]),
                 .arm = double((ends.a == i ? share : 1 - share) * bonds[k].length)});
    }
    const double stable = bound.stiffest().stable_time_step();
    if (stable < least.time_step) least = {.time_step = stable, .grain = grains.id(i)};
  }
  return least;
}

}  // namespace silt::dem
