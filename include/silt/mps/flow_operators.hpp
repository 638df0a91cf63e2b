// SPDX-License-Identifier: MIT
// What the operators of a flow are evaluated with: the stencils of its scheme, and at the present
// positions the neighbours within them and the normals of the walls.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/operators.hpp>
#include <silt/mps/walls.hpp>

#include <algorithm>
#include <type_traits>

namespace silt::mps {

template <class Scheme, int Dim, class RealType>
class FlowOperators {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Stencil = mps::Stencil<Dim, Real, typename Scheme::Kernel>;
  using LaplacianKernel =
      typename Scheme::Laplacian::template Weights<typename Scheme::Kernel, Dim>;
  using LaplacianStencil = mps::Stencil<Dim, Real, LaplacianKernel>;

  FlowOperators() = default;
  explicit FlowOperators(const FlowSettings<Dim, Scheme>& settings)
      : stencil_({.spacing = settings.spacing, .radius = settings.radius}),
        laplacian_stencil_({.spacing = settings.spacing, .radius = settings.laplacian_radius}) {}

  /// Of density, gradient and divergence.
  const Stencil& stencil() const noexcept { return stencil_; }
  const LaplacianStencil& laplacian_stencil() const noexcept { return laplacian_stencil_; }
  /// The larger of the two effective radii [m].
  Real reach() const { return std::max(stencil_.re, laplacian_stencil_.re); }

  /// Finds neighbours and normals from the search.
  template <FluidParticles P, class S>
  void find(const P& particles, const S& search) {
    neighbourhood_.find(particles, search, stencil_);
    if (!shares_neighbourhood()) {
      laplacian_neighbourhood_.find(particles, search, laplacian_stencil_);
    }
    if constexpr (Scheme::Walls::smooth) normals_.find(particles, neighbourhood_, stencil_);
  }
  /// Whether no particle was added, removed, sorted or moved since then.
  template <FluidParticles P>
  bool are_current(const P& particles) const {
    return neighbourhood_.is_current(particles);
  }

  const Neighbourhood<Dim, Real>& neighbourhood() const noexcept { return neighbourhood_; }
  const Neighbourhood<Dim, Real>& laplacian_neighbourhood() const noexcept {
    return shares_neighbourhood() ? neighbourhood_ : laplacian_neighbourhood_;
  }
  /// Normals of smooth walls.
  const WallNormals<Dim, Real>& normals() const noexcept { return normals_; }

  /// <∇·u>_i
  template <FluidParticles P, class U>
  Real divergence(const P& particles, Index i, const U& u) const {
    if constexpr (Scheme::Walls::smooth) {
      return divergence_at_smooth_walls(particles, neighbourhood_, normals_, stencil_, i, u);
    } else {
      return mps::divergence(neighbourhood_, stencil_, i, u);
    }
  }
  /// <∇²φ>_i      (6)
  template <class U>
  auto laplacian(Index i, const U& phi) const {
    return mps::laplacian(laplacian_neighbourhood(), laplacian_stencil_, i, phi);
  }

 private:
  // The Laplacian has the weights and radius of the other operators.
  bool shares_neighbourhood() const noexcept {
    return std::is_same_v<Stencil, LaplacianStencil> && stencil_.re == laplacian_stencil_.re;
  }

  Stencil stencil_;
  LaplacianStencil laplacian_stencil_;
  Neighbourhood<Dim, Real> neighbourhood_;            // within stencil_
  Neighbourhood<Dim, Real> laplacian_neighbourhood_;  // within laplacian_stencil_, if it differs
  WallNormals<Dim, Real> normals_;
};

}  // namespace silt::mps
