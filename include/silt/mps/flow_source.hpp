// SPDX-License-Identifier: MIT
// The source of the pressure equation of a flow: SourceTerms at each particle.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/body_force.hpp>
#include <silt/mps/corrected_gradient.hpp>
#include <silt/mps/flow_operators.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/operators.hpp>
#include <silt/mps/pressure_boundary.hpp>
#include <silt/mps/source.hpp>

#include <utility>
#include <vector>

namespace silt::mps {

template <class Scheme, int Dim, class RealType>
class FlowSource {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Source = typename Scheme::Source;
  using Operators = FlowOperators<Scheme, Dim, Real>;

  /// To be called before the predictor.
  template <FluidParticles P>
  void begin(const P& particles) {
    if constexpr (needs_density_rate<Source>()) {
      previous_velocity_.assign(particles[velocity].begin(), particles[velocity].end());
    }
  }

  /// What the source depends on, in addition to the particles.
  struct Input {
    const FlowSettings<Dim, Scheme>& settings;
    const Operators& operators;
    const PressureBoundary<Scheme>& boundary;
    const BodyForce<Dim, Real>& force;
    double time_step;  ///< Δt [s]
  };
  /// A function of i that returns ∇²P [Pa/m²], (9), (16), and refers to all of these.
  template <FluidParticles P>
  auto evaluator(P& particles, const Input& input) {
    particles.refresh_ghosts(velocity);
    const auto u = std::as_const(particles).with_ghosts(velocity);
    const auto n = std::as_const(particles)[number_density];
    if constexpr (balances_forces<Source>()) {
      particles.refresh_ghosts(pressure);  // of the previous step
      balance_velocity(particles, u, input);
    }
    return [=, this, &particles](Index i) {
      const auto& neighbourhood = input.operators.neighbourhood();
      const auto& stencil = input.operators.stencil();
      SourceTerms terms{.density = input.settings.density, .time_step = input.time_step};
      terms.compression = double((n[i] - stencil.n0) / stencil.n0);
      if constexpr (balances_forces<Source>()) {
        terms.divergence = double(input.operators.divergence(particles, i, balanced_velocity_));
        terms.near_boundary = input.boundary.is_near(i);
        terms.asymmetry = double(asymmetry(particles, input, i));
      } else if constexpr (Source::needs_divergence) {
        terms.divergence = double(input.operators.divergence(particles, i, u));
      }
      if constexpr (needs_density_rate<Source>()) {
        terms.density_rate = double(density_rate(neighbourhood, stencil, i, u));
        terms.last_density_rate = double(
            density_rate(neighbourhood, stencil, i, OwnerValues<P>{particles, previous_velocity_}));
      }
      return input.settings.source.value(terms);
    };
  }

 private:
  // Values of owned particles, accessible by the index of a ghost too.
  template <class P>
  struct OwnerValues {
    const P& particles;
    const std::vector<Vec>& values;
    const Vec& operator[](Index j) const { return values[particles.owner(j)]; }
  };

  // Walls and dummies have u* = Δt F, as fluid at rest has; see BalancedSource.
  template <class P, class U>
  void balance_velocity(const P& particles, const U& u, const Input& input) {
    const auto kinds = particles.with_ghosts(kind);
    balanced_velocity_.assign(u.begin(), u.end());
    for_each(u.size(), [&](Index j) {
      if (kinds[j] != Kind::fluid) {
        balanced_velocity_[j] += Real(input.time_step) * input.force[particles.owner(j)];
      }
    });
  }

  // The Laplacian of a linear pressure, which is not zero where neighbours are missing on one side;
  // see BalancedSource.
  template <class P>
  static Real asymmetry(const P& particles, const Input& input, Index i) {
    const auto& laplacian = input.operators.laplacian_stencil();
    const Vec gradient =
        input.boundary.template pressure_gradient<CorrectedGradient>(particles, input.operators, i);
    const Vec weight = Real(input.settings.density) * input.force[i];
    Real sum = 0;
    for_each_weighted(input.operators.laplacian_neighbourhood(), i, laplacian,
                      [&](Index j, const Vec& r_ij, Real w, Real) {
                        const bool has_pressure = input.boundary.has_pressure(particles.owner(j));
                        sum += w * r_ij.dot(has_pressure ? gradient : Vec(gradient - weight));
                      });
    return 2 * Dim / (laplacian.lambda * laplacian.n0) * sum;
  }

  std::vector<Vec> balanced_velocity_;  // u*, but Δt F for walls and dummies; with ghosts
  std::vector<Vec> previous_velocity_;  // u before the predictor
};

}  // namespace silt::mps
