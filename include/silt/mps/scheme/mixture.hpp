// SPDX-License-Identifier: MIT
// Schemes for the fluid of a mixture: it fills the share ε of the volume, and exchanges momentum
// with the second phase. A particle has the mass ρ l0^Dim, and with the second phase the bulk
// volume l0^Dim/ε, by which it is weighted in all sums over neighbours:
//
//   n_i = Σ_j w_ij/ε_j + c(1/ε_i) = n0,     ∇·u = −(1/ε) Dε/Dt,     Du/Dt = −∇P/ρ + ν∇²u + g + a
//
// c is the particle's own share, beyond that in n0, see OwnDensity. a is the exchange. Model A of
// [Gidaspow1994]: the fluid carries ε ∇P of the pressure gradient, the second phase the rest.
#pragma once

#include <silt/mps/scheme/recommended.hpp>

namespace silt::mps {

/// A scheme for particles with the fields of FluidInMixture.
template <class Base = Recommended>
struct InMixture : Base {
  static constexpr bool is_in_mixture = true;  ///< by which the flow knows it
};

}  // namespace silt::mps
