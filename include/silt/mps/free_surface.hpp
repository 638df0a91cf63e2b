// SPDX-License-Identifier: MIT
// Free-surface criteria, [HwangLeePark2010] (13), (17); on the free surface P = 0.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <ratio>

namespace silt::mps {

/// Number density and neighbour count of a particle, relative to the full lattice.
struct LocalDensity {
  double density = 0;     ///< n_i / n0 [-]
  double neighbours = 0;  ///< N_i / N0 [-]
};

/// Reference scales for free-surface criteria.
template <class RealType>
struct SurfaceScale {
  RealType spacing = 0;  ///< l0 [m]
  RealType n0 = 0;       ///< (5) [-]
};

/// Decides from its local density whether a particle lies on the free surface.
template <class S>
concept SurfaceByDensity = requires(const S criterion, LocalDensity local_density) {
  { criterion.is_on_surface(local_density) } -> std::same_as<bool>;
};
/// Decides from the positions of its neighbours: for_each(f) calls f(r_ij, w, covers), where
/// `covers` is false for neighbours that must not cover the surface of the fluid: walls.
template <class S>
concept SurfaceByPositions =
    requires(const S criterion, LocalDensity local_density, SurfaceScale<double> scale) {
      {
        criterion.template is_on_surface<2, double>(local_density, scale,
                                                    [](auto&& f) { f(Vec<2>(), 0.0, true); })
      } -> std::same_as<bool>;
    };
template <class S>
concept FreeSurface = (SurfaceByDensity<S> || SurfaceByPositions<S>) &&
                      requires(const S criterion) { criterion.check(); };

/// n_i < β n0 (13).
template <class Beta>
struct DensityBelow {
  double beta = double(Beta::num) / double(Beta::den);  ///< β [-] in (0, 1]

  void check() const { require_between("DensitySurface: beta", beta, {0, 1}); }
  bool is_on_surface(const LocalDensity& local) const { return local.density < beta; }
};

/// The paper does not give β; 0.97 is usual. At re = 3.1 l0 this includes the second row of
/// particles below a flat surface, where n = 0.93 n0.
using DensitySurface = DensityBelow<std::ratio<97, 100>>;
/// Only the outermost row of particles below a flat surface.
using OutermostRow = DensityBelow<std::ratio<9, 10>>;

/// N_i < β' N0 (17), Tanaka and Masunaga (2010).
struct CountSurface {
  double beta = 0.85;  ///< β' [-] in (0, 1]; not given in the paper, 0.85 is usual

  void check() const { require_between("CountSurface: beta", beta, {0, 1}); }
  bool is_on_surface(const LocalDensity& local) const { return local.neighbours < beta; }
};

/// Both conditions must hold, as adopted in the paper.
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
