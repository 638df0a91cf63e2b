// SPDX-License-Identifier: MIT
// Where the pressure is zero, [HwangLeePark2010] (13), (17).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <ratio>

namespace silt::mps {

/// Surroundings of a particle against those in the full lattice.
struct LocalDensity {
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
concept SurfaceByDensity = requires(const S surface, LocalDensity local_density) {
  { surface.is_on_surface(local_density) } -> std::same_as<bool>;
};
/// The same, out of where its neighbours stand: for_each(f) calls f(r_ij, w, counts), where `counts`
/// is false for what must not hide the surface from fluid: walls.
template <class S>
concept SurfaceByPositions = requires(const S surface, LocalDensity local_density, SurfaceScale<double> scale) {
  {
    surface.template is_on_surface<2, double>(local_density, scale, [](auto&& f) { f(Vec<2>(), 0.0, true); })
  } -> std::same_as<bool>;
};
template <class S>
concept FreeSurface =
    (SurfaceByDensity<S> || SurfaceByPositions<S>)&&requires(const S surface) { surface.check(); };

/// n_i < β n0 (13).
template <class Beta>
struct DensityBelow {
  double beta = double(Beta::num) / double(Beta::den);  ///< β [-] in (0, 1]

  void check() const { require_between("DensitySurface: beta", beta, {0, 1}); }
  bool is_on_surface(const LocalDensity& local_density) const { return local_density.density < beta; }
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
  bool is_on_surface(const LocalDensity& local_density) const { return local_density.neighbours < beta; }
};

/// Both conditions together: what the paper adopts.
template <SurfaceByDensity A, SurfaceByDensity B>
struct BothSurfaces {
  A first{};
  B second{};

  void check() const {
    first.check();
    second.check();
  }
  bool is_on_surface(const LocalDensity& local_density) const {
    return first.is_on_surface(local_density) && second.is_on_surface(local_density);
  }
};

}  // namespace silt::mps
