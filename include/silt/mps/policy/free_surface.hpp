// SPDX-License-Identifier: MIT
// Free-surface criteria, [HwangLeePark2010] (13), (17); on the free surface P = 0.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>

namespace silt::mps {

/// Number density and neighbour count of a particle, relative to the full lattice.
struct LocalDensity {
  double density = 0;     ///< n_i / n0 [-]
  double neighbours = 0;  ///< N_i / N0 [-]
};

/// What a criterion sees of a particle: its local density, and its neighbours with their positions.
template <int Dim, class RealType, class ForEach>
struct SurfaceView : LocalDensity {
  using Real = RealType;
  static constexpr int dimension = Dim;

  Real spacing;  ///< l0 [m]
  Real n0;       ///< (5) [-]
  /// for_each(f) calls f(r_ij, w, covers) for every neighbour; `covers` is false for neighbours
  /// that must not cover the surface of the fluid: walls.
  const ForEach& for_each;
};

namespace detail {

/// The neighbours of a view that serves to check a criterion when it is compiled.
struct AnyNeighbours {
  template <class F>
  void operator()(F&& f) const;
};
template <int Dim>
using AnySurfaceView = SurfaceView<Dim, double, AnyNeighbours>;

}  // namespace detail

/// is_on_surface(view) decides whether a particle lies on the free surface, from its SurfaceView or
/// from the LocalDensity alone.
template <class S>
concept FreeSurface =
    requires(const S criterion, const detail::AnySurfaceView<2>& in_2d,
             const detail::AnySurfaceView<3>& in_3d) {
      { criterion.is_on_surface(in_2d) } -> std::same_as<bool>;
      { criterion.is_on_surface(in_3d) } -> std::same_as<bool>;
      criterion.check();
    };

/// n_i < β n0, [HwangLeePark2010] (13).
struct DensitySurface {
  /// β [-] in (0, 1]. The paper does not give it; 0.97 is usual. At re = 3.1 l0 this includes the
  /// second row of particles below a flat surface, where n = 0.93 n0; 0.9 only the outermost one.
  double beta = 0.97;

  void check() const { require_between("DensitySurface: beta", beta, {0, 1}); }
  bool is_on_surface(const LocalDensity& local) const { return local.density < beta; }
};

/// N_i < β' N0, [HwangLeePark2010] (17), [TanakaMasunaga2010].
struct CountSurface {
  double beta = 0.85;  ///< β' [-] in (0, 1]; not given in the paper, 0.85 is usual

  void check() const { require_between("CountSurface: beta", beta, {0, 1}); }
  bool is_on_surface(const LocalDensity& local) const { return local.neighbours < beta; }
};

/// Both conditions must hold, the `first` and the `second`, as [HwangLeePark2010] adopts.
template <FreeSurface A, FreeSurface B>
struct BothSurfaces {
  A first{};
  B second{};

  void check() const {
    first.check();
    second.check();
  }
  template <class View>
  bool is_on_surface(const View& at) const {
    return first.is_on_surface(at) && second.is_on_surface(at);
  }
};

using BothConditions = BothSurfaces<DensitySurface, CountSurface>;  ///< (13) and (17)

}  // namespace silt::mps
