// SPDX-License-Identifier: MIT
// What grains and the fluid around them exchange in a step: volume and momentum.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/grains_in_fluid.hpp>
#include <silt/coupled/own_wake.hpp>
#include <silt/coupled/vorticity.hpp>
#include <silt/coupled/weights.hpp>
#include <silt/coupled/work_on_grains.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/mixture.hpp>
#include <silt/mps/operator/own_density.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace silt::coupled {

/// What all particles of the fluid, and all grains, have in common.
struct ExchangeSettings {
  double spacing;         ///< l0 [m]
  double density;         ///< ρ of the fluid [kg/m³]
  double viscosity;       ///< ν [m²/s]
  double radius;          ///< re/l0 of the flow, the smaller one [-]
  double added_mass = 0;  ///< Cₘ of the grains [-]
  bool has_lift = false;  ///< of the grains
};

/// The exchange of grains of type G with particles of a fluid of type F. In each step,
/// find_volumes(), give_to_grains(), give_to_fluid() and correct() are called in this order.
/// In between, particles may be sorted in memory, and both be removed.
template <ParticlesInFluid G, mps::ParticlesInMixture F>
class Exchange {
 public:
  static constexpr int dimension = G::dimension;
  using Real = typename G::Real;
  using Vec = typename G::Vec;

  /// Of grains and a fluid with these settings.
  explicit Exchange(const ExchangeSettings& settings)
      : settings_(settings),
        reach_(Real(Weights<dimension, Real>::reach_for(settings.radius) * settings.spacing)),
        mass_(Real(settings.density * std::pow(settings.spacing, dimension))) {}

  /// The weights, the share χ of each grain that is immersed, and of each particle of the fluid
  /// ε = l0^Dim/(l0^Dim + Σ_k W χ V) and the response of the grains to its pressure.
  void find_volumes(G& grains, F& fluid) {
    weights_.find(std::as_const(fluid)[position], std::as_const(grains)[position], fluid.box(),
                  reach_);
    find_immersion(grains, fluid);
    leave_fluid_on_surface(grains, fluid);
    const double particle = std::pow(settings_.spacing, dimension);
    const auto R = std::as_const(grains)[radius];
    const auto immersed = std::as_const(grains)[immersion];
    const auto m = std::as_const(grains)[mass];
    const auto fraction = fluid[mps::fluid_fraction];
    const auto response = fluid[mps::response];
    for_each(fluid.size(), [&](Index i) {
      double displaced = 0;
      weights_.for_each_grain(i, [&](Index k, Real weight) {
        const double volume = double(immersed_volume(R[k], immersed[k]));
        displaced += double(weight) * volume * settings_.density * moved_by_pressure(volume) /
                     inert_mass(volume, double(m[k]));
      });
      fraction[i] = Real(particle / (particle + solid_around(grains, i)));
      response[i] = Real(displaced / particle);
    });
  }
  /// Throws if ε around a grain is less than between grains in the closest packing.
  void require_room(const G& grains, const F& fluid) const {
    const auto fraction = fluid[mps::fluid_fraction];
    const auto mean_of = [&](Index k) {
      double mean = 0;
      weights_.for_each_particle(
          k, [&](Index i, Real weight) { mean += double(weight * fraction[i]); });
      return mean;
    };
    const Index dense = first_where(grains.size(), [&](Index k) {
      return grains[immersion][k] > 0 && mean_of(k) < closest_packing;
    });
    if (dense == no_index) return;
    fail({"Coupled: a fluid fraction of ", mean_of(dense), " around a grain at ",
          to_text(Vec(grains[position][dense])), " m is less than in the closest packing, ",
          closest_packing, "; let the grains overlap less, or begin with more fluid around them"},
         {.particle = dense, .id = grains.id(dense)});
  }

  /// u, its vorticity, ε, −χ V ∇P and the mobility of the fluid around each grain.
  /// acceleration_at(x) is that of gravity and the body force at x [m/s²].
  /// coefficient_of(diameter, ε, speed, χ) is β of a grain, see FluidForces::coefficient(); the
  /// step has this length [s].
  template <class CoefficientOf, class AccelerationAt>
  void give_to_grains(G& grains, const F& fluid, double time_step, CoefficientOf&& coefficient_of,
                      AccelerationAt&& acceleration_at) {
    remember_ids(grains, fluid);
    const Index number = grains.size();
    const auto u = fluid[velocity];
    const auto fraction = fluid[mps::fluid_fraction];
    const auto gradient = fluid[mps::pressure_gradient];
    const auto immersed = std::as_const(grains)[immersion];
    const auto wake = std::as_const(grains)[own_wake];
    const auto R = std::as_const(grains)[radius];
    const auto x = std::as_const(grains)[position];
    const auto v = std::as_const(grains)[velocity];
    const auto undisturbed = grains[fluid_velocity];
    const auto accelerated = grains[fluid_acceleration];
    const auto share = grains[fluid_share];
    const auto of_pressure = grains[pressure_force];
    const auto vorticity = grains[fluid_vorticity];
    const auto impulse = grains[exchanged_impulse];
    means_.resize(number);
    coefficients_.resize(number);
    volumes_.resize(number);
    for_each(number, [&](Index k) {
      Vec mean = Vec::Zero(), of_gradients = Vec::Zero();
      Real epsilon = 0;
      weights_.for_each_particle(k, [&](Index i, Real weight) {
        mean += weight * u[i];
        of_gradients += weight * gradient[i];
        epsilon += weight * fraction[i];
      });
      means_[k] = mean;
      undisturbed[k] = mean - wake[k];
      if (settings_.has_lift) vorticity[k] = vorticity_around(weights_, k, u);
      accelerated[k] = acceleration_at(x[k]) - of_gradients / Real(settings_.density);
      share[k] = epsilon;
      volumes_[k] = immersed_volume(R[k], immersed[k]);
      of_pressure[k] = -volumes_[k] * of_gradients;
      impulse[k] = Vec::Zero();
      const double speed = double(Vec(undisturbed[k] - v[k]).norm());
      coefficients_[k] =
          immersed[k] > 0
              ? Real(coefficient_of(2 * double(R[k]), double(epsilon), speed, double(immersed[k])))
              : Real(0);
    });
    find_mobilities(grains, fluid.size(), time_step);
  }

  /// The acceleration of each particle of the fluid by the impulses J that drag, added mass and
  /// lift gave the grains in a step of this length [s]: of grain k on particle i,
  ///
  ///   −W_ki [J_k + Δt β_k/(1 + Δt β_k D_k) (u_i − Σ_j W_kj u_j)].
  ///
  /// The second term has no sum: grains slow down the particles around them, each in its own
  /// motion.
  void give_to_fluid(const G& grains, F& fluid, double time_step) {
    const auto impulse = grains[exchanged_impulse];
    const auto x = grains[position];
    const NearestImage<dimension, Real> nearest(grains.box());
    impulses_.resize(ids_of_grains_.size());
    velocities_.resize(ids_of_grains_.size());
    for_each(impulses_.size(), [&](Index k) {
      const Index now = grains.index_of(ids_of_grains_[k]);
      impulses_[k] = velocities_[k] = Vec::Zero();
      if (now == no_index) return;
      impulses_[k] = impulse[now];
      Vec move = x[now] - weights_.centre(k);
      for (int a = 0; a < dimension; ++a) nearest.apply(a, move[a]);
      velocities_[k] = move / Real(time_step);
    });
    find_rates(fluid);
    const auto acceleration = fluid[mps::momentum_exchange];
    const auto u = std::as_const(fluid)[velocity];
    const Real dt = Real(time_step);
    velocities_before_.assign(u.begin(), u.end());
    for_each(fluid.size(), [&](Index i) {
      Vec sum = Vec::Zero();
      weights_.for_each_grain(i, [&](Index k, Real weight) {
        sum += weight * (impulses_[k] + dt * coefficients_[k] * (u[i] - means_[k]));
      });
      acceleration[i] = -sum / (mass_ * dt);
    });
  }

  /// Work in a step.
  struct Work {
    WorkOnGrains on_grains;
    double on_fluid = 0;     ///< of the exchange, in the flow's step [J]
    double after_fluid = 0;  ///< of that after it, by the added mass [J]
  };
  /// Gives the grains the impulse −χ V ∇P Δt of the step that the flow has made, less that of
  /// pressure_force, which acted for a time [s] on them, and the fluid that of the added mass.
  /// Returns the work of this on grains, and that of the exchange in the step on the fluid.
  Work correct(G& grains, F& fluid, double time_step, double acted_for) {
    const OwnWake<dimension> of_one{settings_.density, settings_.viscosity,
                                    Weights<dimension, Real>::width() * double(reach_)};
    const auto gradient = std::as_const(fluid)[mps::pressure_gradient];
    const auto m = std::as_const(grains)[mass];
    const auto u = std::as_const(grains)[fluid_velocity];
    const auto impulse = std::as_const(grains)[exchanged_impulse];
    const auto before = std::as_const(grains)[pressure_force];
    const auto wake = grains[own_wake];
    const auto v = grains[velocity];
    places_.resize(ids_of_fluid_.size());
    for_each(places_.size(), [&](Index i) { places_[i] = fluid.index_of(ids_of_fluid_[i]); });
    Work work;
    work.on_grains = ordered_sum(ids_of_grains_.size(), WorkOnGrains{}, [&](Index k) {
      WorkOnGrains of_grain;
      impulses_[k] = Vec::Zero();
      const Index now = grains.index_of(ids_of_grains_[k]);
      if (now == no_index) return of_grain;
      const Vec relative = v[now] - u[now];
      wake[now] = of_one.after(Vec(wake[now]), Vec(impulse[now]), double(relative.norm()),
                               double(rates_of_others_[k]), time_step);
      Vec of_gradients = Vec::Zero();
      weights_.for_each_particle(k, [&](Index i, Real weight) {
        if (places_[i] != no_index) of_gradients += weight * gradient[places_[i]];
      });
      const Vec force = -volumes_[k] * of_gradients;
      const Vec of_pressure = Real(time_step) * force - Real(acted_for) * before[now];
      const Vec change = of_pressure * Real(1 + settings_.added_mass) /
                         Real(inert_mass(double(volumes_[k]), double(m[now])));
      if (settings_.added_mass > 0) impulses_[k] = m[now] * change - of_pressure;
      const Vec mean = v[now] + change / 2;
      of_grain.by_pressure = double(of_pressure.dot(mean));
      of_grain.by_exchange = double(impulses_[k].dot(mean));
      v[now] += change;
      return of_grain;
    });
    const auto exchanged = std::as_const(fluid)[mps::momentum_exchange];
    const auto of_fluid = fluid[velocity];
    const auto work_on = [&](Index i) {
      silt::Vec<2> of_particle = silt::Vec<2>::Zero();
      const Index now = places_[i];
      if (now == no_index) return of_particle;
      const Vec mean = (velocities_before_[i] + of_fluid[now]) / 2;
      of_particle[0] = double(Real(time_step) * exchanged[now].dot(mean));
      if (!(settings_.added_mass > 0)) return of_particle;
      Vec sum = Vec::Zero();
      weights_.for_each_grain(i, [&](Index k, Real weight) { sum += weight * impulses_[k]; });
      const Vec change = -sum / mass_;
      of_particle[1] = double(change.dot(of_fluid[now] + change / 2));
      of_fluid[now] += change;
      return of_particle;
    };
    const silt::Vec<2> on_fluid =
        ordered_sum(ids_of_fluid_.size(), silt::Vec<2>(silt::Vec<2>::Zero()), work_on);
    work.on_fluid = double(mass_) * on_fluid[0];
    work.after_fluid = double(mass_) * on_fluid[1];
    return work;
  }

 private:
  // ε of hexagonal discs, and of close-packed spheres.
  static constexpr double closest_packing = dimension == 2 ? 0.0931 : 0.2595;

  static Real immersed_volume(Real R, Real immersed) {
    return immersed * Real(dem::volume_of<dimension>(double(R)));
  }

  // A change of ∇P accelerates a grain by this volume of it over this mass, with the added mass.
  double moved_by_pressure(double volume) const { return (1 + settings_.added_mass) * volume; }
  double inert_mass(double volume, double mass_of_grain) const {
    return mass_of_grain + settings_.added_mass * settings_.density * volume;
  }

  // χ follows from the share of the reach of a grain that fluid and grains fill. In the fluid it is
  // 1 also in the corner of a tank, where they fill a quarter in 2D, and an eighth in 3D, and 0
  // where the fluid does not go on around the grain. Among particles of the free surface it is a
  // half where they fill a half, as around a grain whose centre is on the surface.
  void find_immersion(G& grains, const F& fluid) {
    const auto on_surface = fluid[mps::surface];
    const auto fraction = fluid[mps::fluid_fraction];
    const double full = Weights<dimension, Real>::integral() *
                        std::pow(double(reach_) / settings_.spacing, dimension);
    const auto immersed = grains[immersion];
    may_be_dry_.resize(grains.size());
    for_each(grains.size(), [&](Index k) {
      bool is_near_surface = false;
      double content = 0;
      weights_.for_each_particle(k, [&](Index i, Real weight) {
        is_near_surface = is_near_surface || on_surface[i];
        const double known = double(fraction[i]) > 0 ? double(fraction[i]) : 1;
        content += double(weight * weights_.sum(k)) / known;
      });
      const double filled = content / full;
      constexpr double corner = dimension == 2 ? 1.0 / 4 : 1.0 / 8;
      const double share = is_near_surface ? 2 * filled - 0.5 : 4 * filled / corner - 1;
      immersed[k] = Real(std::clamp(share, 0.0, 1.0));
      may_be_dry_[k] = is_near_surface || double(weights_.sum(k)) < least_of_flow() / 2 * full;
    });
  }
  // The smallest ε that the flow allows.
  double least_of_flow() const {
    return 1 / mps::OwnDensity<dimension, Real>::largest_volume(settings_.radius);
  }
  // Few particles among many grains, as on a slope that falls dry, are not a fluid around them: on
  // the surface, ε is not below that of the closest packing, nor what the flow allows.
  void leave_fluid_on_surface(G& grains, const F& fluid) {
    const auto may_be_dry = [&](Index k) { return may_be_dry_[k] != 0; };
    if (first_where(grains.size(), may_be_dry) == no_index) return;
    const double least = std::max(closest_packing, least_of_flow());
    const double most = (1 - 1e-6) * std::pow(settings_.spacing, dimension) * (1 / least - 1);
    shares_.resize(fluid.size());
    for_each(fluid.size(), [&](Index i) {
      const double solid = solid_around(grains, i);
      shares_[i] = solid > most ? Real(most / solid) : Real(1);
    });
    const auto immersed = grains[immersion];
    for_each(grains.size(), [&](Index k) {
      if (!may_be_dry(k)) return;
      Real share = 1;
      weights_.for_each_particle(k, [&](Index i, Real) { share = std::min(share, shares_[i]); });
      immersed[k] *= share;
    });
  }
  // Σ_k W χ V of particle i [m³].
  double solid_around(const G& grains, Index i) const {
    const auto R = grains[radius];
    const auto immersed = grains[immersion];
    double solid = 0;
    weights_.for_each_grain(i, [&](Index k, Real weight) {
      solid += double(weight) * double(immersed_volume(R[k], immersed[k]));
    });
    return solid;
  }
  // Dε/Dt = −ε²/l0^Dim Σ_k χ V dW_ki/dt, as the grains moved in the step.
  void find_rates(F& fluid) {
    const auto u = std::as_const(fluid)[velocity];
    const auto fraction = std::as_const(fluid)[mps::fluid_fraction];
    const auto rate = fluid[mps::fluid_fraction_rate];
    // Of a fixed number of blocks of grains, so that the sums are the same on any number of
    // threads.
    constexpr Index blocks = 8;
    const Index particles = fluid.size();
    solid_rates_.assign(blocks * particles, 0);
    for_each_task(blocks, [&](Index block) {
      const Index end = weights_.grains() * (block + 1) / blocks;
      for (Index k = weights_.grains() * block / blocks; k < end; ++k) {
        if (!(volumes_[k] > 0)) continue;
        weights_.for_each_rate(k, velocities_[k], u, [&](Index i, Real of_weight) {
          solid_rates_[block * particles + i] += volumes_[k] * of_weight;
        });
      }
    });
    const Real particle = Real(std::pow(settings_.spacing, dimension));
    for_each(particles, [&](Index i) {
      Real solid = 0;
      for (Index block = 0; block < blocks; ++block) solid += solid_rates_[block * particles + i];
      rate[i] = -squared(fraction[i]) / particle * solid;
    });
  }
  // D_k = Σ_i W_ki Σ_l W_li β_l/(β_k m): of all grains around a particle, each drags its share of it.
  void find_mobilities(G& grains, Index particles, double time_step) {
    of_particles_.resize(particles);
    for_each(particles, [&](Index i) {
      Real sum = 0;
      weights_.for_each_grain(i, [&](Index k, Real weight) { sum += weight * coefficients_[k]; });
      of_particles_[i] = sum;
    });
    const auto mobility = grains[fluid_mobility];
    rates_of_others_.resize(grains.size());
    for_each(grains.size(), [&](Index k) {
      Real of_all = 0, own = 0;
      weights_.for_each_particle(k, [&](Index i, Real weight) {
        of_all += weight * of_particles_[i];
        own += weight * weight * coefficients_[k];
      });
      mobility[k] = coefficients_[k] > 0 ? of_all / (coefficients_[k] * mass_) : Real(0);
      rates_of_others_[k] = std::max(of_all - own, Real(0)) / mass_;
      coefficients_[k] /= 1 + Real(time_step) * of_all / mass_;
    });
  }
  void remember_ids(const G& grains, const F& fluid) {
    ids_of_grains_.resize(grains.size());
    for_each(grains.size(), [&](Index k) { ids_of_grains_[k] = grains.id(k); });
    ids_of_fluid_.resize(fluid.size());
    for_each(fluid.size(), [&](Index i) { ids_of_fluid_[i] = fluid.id(i); });
  }

  ExchangeSettings settings_;
  Real reach_;  // of the weights [m]
  Real mass_;   // of a particle of the fluid [kg]
  Weights<dimension, Real> weights_;
  // In the order of the weights, by grain and by particle.
  Buffer<Id> ids_of_grains_, ids_of_fluid_;
  Buffer<Index> places_;          // of the particles, after they were sorted
  Buffer<Vec> means_;             // Σ_i W u [m/s]
  Buffer<Real> coefficients_;     // β, and later β/(1 + Δt β D) [kg/s]
  Buffer<Real> of_particles_;     // Σ_k W β [kg/s]
  Buffer<Real> rates_of_others_;  // of the drag by other grains [1/s]
  Buffer<Real> volumes_;          // χ V [m³]
  Buffer<std::uint8_t> may_be_dry_;  // of a grain
  Buffer<Real> shares_;              // of χ that leave enough fluid, of particles
  Buffer<Vec> impulses_;             // of the exchange on grains [N s]
  Buffer<Vec> velocities_before_;    // of particles, in the step [m/s]
  Buffer<Vec> velocities_;        // mean ones of the grains in the step [m/s]
  Buffer<Real> solid_rates_;      // Σ_k χ V dW_ki/dt, by block of grains [m³/s]
};

}  // namespace silt::coupled
