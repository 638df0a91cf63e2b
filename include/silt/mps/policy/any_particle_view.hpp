// SPDX-License-Identifier: MIT
// What every view of a particle offers to the policies of a flow, to check them when they are
// compiled. The view that a flow gives them is in silt/mps/view/particle_view.hpp.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/kernel.hpp>
#include <silt/mps/operator/neighbour.hpp>
#include <silt/mps/operator/neighbourhood.hpp>
#include <silt/mps/operator/operators.hpp>

#include <span>

namespace silt::mps::detail {

/// Without the state of the flow, as models of walls see it: NeighbourView.
template <int Dim>
struct AnyNeighbourView {
  static constexpr int dimension = Dim;
  using Real = double;
  using Vec = silt::Vec<Dim>;
  static constexpr bool has_images = false;
  using Velocities = std::span<const Vec>;
  using Kinds = std::span<const Kind>;

  const Fluid<Dim>& particles() const;
  Index index() const;
  Kind kind() const;
  Vec velocity() const;
  Real spacing() const;
  Index owner(const Neighbour<Dim, Real>& neighbour) const;
  Index owner(Index j) const;
  Kinds kinds() const;
  Velocities velocities() const;
  const Stencil<Dim, Real, CubicKernel>& stencil() const;
  const Stencil<Dim, Real, CubicKernel>& laplacian_stencil() const;
  const Neighbourhood<Dim, Real>& neighbourhood() const;
  template <class F>
  void for_each(F&&) const {}
  template <class F>
  void for_each_in_laplacian(F&&) const {}
  template <class F>
  void for_each_wall(F&&) const {}
  template <class F>
  bool any(F&&) const {
    return false;
  }
  template <class U>
  auto values_of(const U&) const {
    return [](auto&& f) { f(Vec(), Vec(), Real(), Real()); };
  }
  template <class U>
  Real divergence(const U& u) const;
};

/// With it: ParticleView.
template <int Dim>
struct AnyParticleView : AnyNeighbourView<Dim> {
  using Real = double;
  using Vec = silt::Vec<Dim>;

  double density() const;
  double time_step() const;
  double compression() const;
  Vec force() const;
  Vec force(Index owned) const;
  Vec weight() const;

  using AnyNeighbourView<Dim>::divergence;
  double divergence() const;
  double density_rate() const;
  template <class U>
  Vec laplacian(const U& u) const;
  template <class G>
  Vec pressure_gradient(const G& gradient) const;
  Vec concentration_gradient() const;
  Real bulk_volume() const;
  Real max_relative_speed() const;
  bool has_pressure(const Neighbour<Dim, Real>& neighbour) const;
  bool near_boundary() const;
};

}  // namespace silt::mps::detail
