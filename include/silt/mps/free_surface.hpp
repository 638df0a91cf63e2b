// SPDX-License-Identifier: MIT
// Where the pressure is zero, [HwangLeePark2010] (13), (17).
#pragma once

#include <silt/core/error.hpp>

#include <concepts>

namespace silt::mps {

/// Surroundings of a particle against those in the full lattice.
struct Fullness {
  double density = 0;     ///< n_i / n0 [-]
  double neighbours = 0;  ///< N_i / N0 [-]
};

/// Says from its surroundings whether a particle lies on the free surface.
template <class S>
concept FreeSurface = requires(const S surface, Fullness fullness) {
  { surface.holds(fullness) } -> std::same_as<bool>;
  surface.check();
};

/// n_i < β n0 (13).
struct DensitySurface {
  double beta = 0.97;  ///< β [-] in (0, 1]; open in the paper, 0.97 is usual

  void check() const { require_between("DensitySurface: beta", beta, {0, 1}); }
  bool holds(const Fullness& fullness) const { return fullness.density < beta; }
};

/// N_i < β' N0 (17), Tanaka and Masunaga (2010).
struct CountSurface {
  double beta = 0.85;  ///< β' [-] in (0, 1]; open in the paper, 0.85 is usual

  void check() const { require_between("CountSurface: beta", beta, {0, 1}); }
  bool holds(const Fullness& fullness) const { return fullness.neighbours < beta; }
};

/// Both conditions together: what the paper adopts.
template <FreeSurface A, FreeSurface B>
struct BothSurfaces {
  A first{};
  B second{};

  void check() const {
    first.check();
    second.check();
  }
  bool holds(const Fullness& fullness) const {
    return first.holds(fullness) && second.holds(fullness);
  }
};

}  // namespace silt::mps
