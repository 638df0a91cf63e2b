// SPDX-License-Identifier: MIT
// Where the pressure is zero, [HwangLeePark2010] (13), (17).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <ratio>

namespace silt::mps {

/// Surroundings of a particle against those in the full lattice.
struct Fullness {
  double density = 0;     ///< n_i / n0 [-]
  double neighbours = 0;  ///< N_i / N0 [-]
};

/// Measures of a place in a flow.
template <class RealType>
struct SurfaceScale {
  RealType spacing = 0;  ///< l0 [m]
  RealType n0 = 0;       ///< (5) [-]
};

/// Says from its surroundings whether a particle lies on the free surface.
template <class S>
concept SurfaceByFullness = requires(const S surface, Fullness fullness) {
  { surface.holds(fullness) } -> std::same_as<bool>;
};
/// The same, out of where its neighbours stand: for_each(f) calls f(r_ij, w, counts), where `counts`
/// is false for what must not hide the surface from fluid: walls.
template <class S>
concept SurfaceByPlaces = requires(const S surface, Fullness fullness, SurfaceScale<double> scale) {
  {
    surface.template holds<2, double>(fullness, scale, [](auto&& f) { f(Vec<2>(), 0.0, true); })
  } -> std::same_as<bool>;
};
template <class S>
concept FreeSurface =
    (SurfaceByFullness<S> || SurfaceByPlaces<S>)&&requires(const S surface) { surface.check(); };

/// n_i < β n0 (13).
template <class Beta>
struct DensityBelow {
  double beta = double(Beta::num) / double(Beta::den);  ///< β [-] in (0, 1]

  void check() const { require_between("DensitySurface: beta", beta, {0, 1}); }
  bool holds(const Fullness& fullness) const { return fullness.density < beta; }
};

/// β is open in the paper; 0.97 is usual. At re = 3.1 l0 that includes the second row of particles
/// below a flat surface, where n = 0.93 n0.
using DensitySurface = DensityBelow<std::ratio<97, 100>>;
/// The outermost row only.
using OutermostRow = DensityBelow<std::ratio<9, 10>>;

/// N_i < β' N0 (17), Tanaka and Masunaga (2010).
struct CountSurface {
  double beta = 0.85;  ///< β' [-] in (0, 1]; open in the paper, 0.85 is usual

  void check() const { require_between("CountSurface: beta", beta, {0, 1}); }
  bool holds(const Fullness& fullness) const { return fullness.neighbours < beta; }
};

/// Both conditions together: what the paper adopts.
template <SurfaceByFullness A, SurfaceByFullness B>
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
