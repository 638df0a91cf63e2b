// SPDX-License-Identifier: MIT
// What the policies of a flow see of it during a step, around one particle.
#pragma once

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/body_force.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/kept_moments.hpp>
#include <silt/mps/operator/neighbour_pack.hpp>
#include <silt/mps/operator/operators.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/view/flow_operators.hpp>
#include <silt/mps/view/neighbour_view.hpp>
#include <silt/mps/view/pressure_boundary.hpp>
#include <silt/mps/wall/walls.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace silt::mps {

template <class Scheme, FluidParticles P>
class ParticleView;

/// The parts of a flow that the views of its particles refer to. Valid during the call that it is
/// given to.
template <class Scheme, FluidParticles P>
struct StepView {
  static constexpr int Dim = P::dimension;  ///< 2 or 3
  using Real = typename P::Real;

  const P& particles;
  const FlowSettings<Dim, Scheme>& settings;
  const FlowOperators<Scheme, Dim, Real>& operators;
  const PressureBoundary<Scheme>& boundary;
  const BodyForce<Dim, Real>& force;
  const KeptMoments<Dim, Real>& moments;
  double time_step;  ///< Δt [s]
  bool is_first;     ///< no step of the flow was made before it

  /// The view of an owned particle.
  ParticleView<Scheme, P> at(Index i) const { return {*this, i}; }
};

/// A particle with its neighbours, and with the state of the flow. Where the flow has a pressure is
/// known after the free surface has been found: to the source and to shifting. Valid during the
/// call that it is given to.
template <class Scheme, FluidParticles P>
class ParticleView
    : public NeighbourView<FlowOperators<Scheme, P::dimension, typename P::Real>, P> {
 public:
  static constexpr int Dim = P::dimension;  ///< 2 or 3
  using Real = typename P::Real;
  using Vec = silt::Vec<Dim, Real>;
  using Operators = FlowOperators<Scheme, Dim, Real>;
  /// What is known without the state of the flow.
  using Neighbours = NeighbourView<Operators, P>;
  /// See the concept AllHavePressure.
  static constexpr bool all_have_pressure = AllHavePressure<WallsOf<Scheme>>;

  /// The view of particle i.
  ParticleView(const StepView<Scheme, P>& step, Index i)
      : Neighbours(step.particles, step.operators, i), step_(step) {}

  double density() const { return step_.settings.density; }  ///< ρ [kg/m³]
  double time_step() const { return step_.time_step; }       ///< Δt [s]
  Vec force() const { return step_.force[this->index()]; }   ///< F [m/s²]
  Vec force(Index owned) const { return step_.force[owned]; }
  Vec weight() const { return Real(density()) * force(); }  ///< ρF [Pa/m]
  /// (n − n0)/n0 [-]
  double compression() const {
    const Real n0 = this->stencil().n0;
    return double((this->particles()[number_density][this->index()] - n0) / n0);
  }

  using Neighbours::divergence;
  double divergence() const { return double(divergence(this->velocities())); }  ///< ∇·u [1/s]
  /// (1/n0) Dn/Dt [1/s]
  double density_rate() const {
    return double(mps::density_rate(this->stencil(), this->velocity(),
                                    this->values_of(this->velocities())));
  }
  /// ⟨∇²u⟩_i of the velocities u [1/(m s)]      (6)
  template <class U>
  auto laplacian(const U& u) const {
    return step_.operators.laplacian(this->index(), u);
  }
  /// ⟨∇P⟩_i over the neighbours with pressure [Pa/m]; in images, P rises as in fluid at rest.
  template <class G>
  Vec pressure_gradient(const G& gradient) const {
    return pressure_gradient(gradient,
                             [weight = weight(), rho = Real(density())](const auto& image) {
                               return rise_at_rest(image, weight, rho);
                             });
  }
  /// The same, with the pressures of images above those of their particles, rise_of(image) [Pa].
  template <class G, class RiseOf>
  [[gnu::flatten]] Vec pressure_gradient(const G& gradient, const RiseOf& rise_of) const {
    const auto p = this->particles().with_ghosts(pressure);
    const auto for_each_with_pressure = [&](auto&& f) {
      const auto add = [&](const auto& j) {
        if (!has_pressure(j)) return;
        if constexpr (std::remove_cvref_t<decltype(j)>::is_image) {
          f(p[j.index] + rise_of(j), j.r_ij, j.weight, j.weight_over_square);
        } else {
          f(p[j.index], j.r_ij, j.weight, j.weight_over_square);
        }
      };
      if constexpr (all_have_pressure && TakesFour<decltype(f), Dim, Real>) {
        this->for_each_four(
            [&](const NeighbourPack<Dim, Real>& j) {
              Four<Real> p_j;
              j.get(p, p_j);
              f(p_j, j.r_ij, j.weight, j.weight_over_square);
            },
            add);
      } else {
        this->for_each(add);
      }
    };
    return step_.moments.evaluate(this->index(), gradient, this->stencil(), p[this->index()],
                                  for_each_with_pressure);
  }
  /// 2d/(λ n0) Σ w rise_of(image) over the images of the particles with pressure [Pa/m²]: the part
  /// of the Laplacian of the pressure that is known.
  template <class RiseOf>
  [[gnu::flatten]] double laplacian_of_rises(const RiseOf& rise_of) const {
    const auto& laplacian = this->laplacian_stencil();
    Real sum = 0;
    step_.operators.for_each_image_in_laplacian(this->index(), [&](const auto& image) {
      if (has_pressure(image)) sum += image.weight * rise_of(image);
    });
    return double(2 * Dim / (laplacian.lambda * laplacian.n0) * sum);
  }
  /// l0/n0 Σ w r_ij/r² [-], in the direction of increasing particle concentration.
  Vec concentration_gradient() const {
    const Real factor = this->spacing() / this->stencil().n0;
    if constexpr (all_have_pressure) {  // as the moments require
      if (const auto* const kept = step_.moments.find(this->index())) return factor * kept->first;
    }
    const auto over_neighbours = [this](auto&& f, auto&& g) { this->for_each_four(f, g); };
    const auto weight = [](const auto& j) -> const auto& { return j.weight_over_square; };
    return factor * first_moment(over_neighbours, weight);
  }
  /// Σ w r_ij within the stencil of the Laplacian [m]
  Vec laplacian_moment() const {
    const auto over_neighbours = [this](auto&& f, auto&& g) {
      this->for_each_four_in_laplacian(f, g);
    };
    const auto weight = [](const auto& j) -> const auto& { return j.weight; };
    return first_moment(over_neighbours, weight);
  }
  /// max |u_j − u_i| over the neighbours [m/s]
  Real max_relative_speed() const {
    const auto u = this->velocities();
    const Vec own = this->velocity();
    Four<Real> of_four{};
    Real square = 0;
    this->for_each_four(
        [&](const NeighbourPack<Dim, Real>& j) {
          FourVectors<Dim, Real> u_j{};
          j.get(u, u_j);
          Four<Real> squares{};
          for (int a = 0; a < Dim; ++a) squares += (u_j[a] - own[a]) * (u_j[a] - own[a]);
          of_four = of_four < squares ? squares : of_four;
        },
        [&](const auto& image) {
          square = std::max(square, Vec(image.mirrored(u) - own).squaredNorm());
        });
    for (int lane = 0; lane < 4; ++lane) square = std::max(square, of_four[lane]);
    return std::sqrt(square);
  }

  /// Whether a neighbour has a pressure: an unknown one, or P = 0 on the free surface.
  bool has_pressure(const auto& neighbour) const {
    return step_.boundary.has_pressure(this->owner(neighbour));
  }
  /// The particle or a neighbour lies on the free surface, or a neighbour has no pressure; n is
  /// then not comparable with n0.
  bool near_boundary() const { return step_.boundary.near_boundary(*this); }

 private:
  // Σ of weight_of(j) r_ij
  template <class OverNeighbours, class WeightOf>
  Vec first_moment(const OverNeighbours& over_neighbours, const WeightOf& weight_of) const {
    FourVectors<Dim, Real> of_four{};
    Real of_images[Dim] = {};  // g++ 12 -O3 miscompiles the sum as a vector, for AVX-512
    over_neighbours(
        [&](const NeighbourPack<Dim, Real>& j) {
          const Four<Real>& weight = weight_of(j);
          for (int a = 0; a < Dim; ++a) of_four[a] += weight * j.r_ij[a];
        },
        [&](const auto& image) {
          for (int a = 0; a < Dim; ++a) of_images[a] += weight_of(image) * image.r_ij[a];
        });
    Vec sum = sum_of(of_four);
    for (int a = 0; a < Dim; ++a) sum[a] += of_images[a];
    return sum;
  }

  const StepView<Scheme, P>& step_;
};

}  // namespace silt::mps
