// SPDX-License-Identifier: MIT
// Grains in a fluid that does not resolve them: both simulations, as one.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/run.hpp>
#include <silt/core/thread_choice.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/coupled_checks.hpp>
#include <silt/coupled/coupled_energy.hpp>
#include <silt/coupled/exchange.hpp>
#include <silt/coupled/fluid_forces.hpp>
#include <silt/coupled/grains_in_fluid.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/mixture.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

namespace silt::coupled {

/// Grains smaller than the spacing l0 of a fluid, and the fluid, each a Simulation. Those of grains
/// have Forces, of which the last part is a FluidForces; those of the fluid a flow with a scheme
/// mps::InMixture. Model A of [Gidaspow1994]. The momentum of both changes by the impulses of
/// gravity and walls, to round-off; velocities of grains are those at half steps, see Leapfrog. A
/// FlowSettings::body_force acts on the fluid only: give the grains a force that does the same.
template <class GrainSimulation, class FluidSimulation>
class Coupled {
  using G = std::remove_cvref_t<decltype(std::declval<GrainSimulation>().particles())>;
  using F = std::remove_cvref_t<decltype(std::declval<FluidSimulation>().particles())>;
  static_assert(G::dimension == F::dimension,
                "silt::coupled::Coupled: grains and fluid have different dimensions");
  static_assert(ParticlesInFluid<G>,
                "silt::coupled::Coupled: the first simulation needs grains with the fields of "
                "coupled::GrainsInFluid<Dim>");
  static_assert(mps::ParticlesInMixture<F>,
                "silt::coupled::Coupled: the second simulation needs a flow with a scheme "
                "mps::InMixture, of particles mps::FluidInMixture<Dim>");

 public:
  static constexpr int dimension = G::dimension;
  using Real = typename G::Real;
  using Vec = typename G::Vec;

  /// Sets ε of the fluid. Throws if the two do not fit: other times, gravity or periodic sides; a
  /// grain larger than l0, or on a wall of the flow; drag in a fluid without viscosity; less fluid
  /// around a grain than in the closest packing.
  Coupled(GrainSimulation grains, FluidSimulation fluid)
      : grains_(std::move(grains)),
        fluid_(std::move(fluid)),
        exchange_(
            ExchangeSettings{.spacing = settings().spacing,
                             .density = settings().density,
                             .viscosity = settings().viscosity,
                             .radius = std::min(settings().radius, settings().laplacian_radius),
                             .added_mass = coefficients().added_mass,
                             .has_lift = coefficients().lift > 0}),
        time_(fluid_.time()) {
    detail::require_common_setup(grains_, fluid_);
    begin_forces();
    exchange_.find_volumes(grains_.particles(), fluid_.particles());
    exchange_.require_room(std::as_const(grains_).particles(), std::as_const(fluid_).particles());
  }

  double time() const noexcept { return time_; }                      ///< [s]
  std::uint64_t steps() const noexcept { return steps_; }             ///< of the flow
  double last_time_step() const noexcept { return last_time_step_; }  ///< of the flow [s]

  /// Whether a checkpoint was read.
  bool was_read() const noexcept { return fluid_.was_read(); }

  /// Of both after the last step, and the work since the first one.
  CoupledEnergy energy() const {
    const auto& flow = fluid_.interaction();
    return energy_.energy(flow.energy(), flow.energy_of(fluid_.particles()));
  }

  /// That of the grains.
  GrainSimulation& grains() noexcept { return grains_; }
  /// That of the grains.
  const GrainSimulation& grains() const noexcept { return grains_; }
  /// That of the fluid.
  FluidSimulation& fluid() noexcept { return fluid_; }
  /// That of the fluid.
  const FluidSimulation& fluid() const noexcept { return fluid_; }
  /// f(name, simulation) of both: VtkSeries writes a series of them.
  template <class F>
  void for_each_simulation(F&& f) const {
    f("grains", grains_);
    f("fluid", fluid_);
  }
  /// Those of the fluid: for observers that ask for them.
  F& particles() noexcept { return fluid_.particles(); }
  const F& particles() const noexcept { return fluid_.particles(); }
  /// The flow: for observers that ask for it.
  const auto& interaction() const noexcept { return fluid_.interaction(); }

  /// That of the flow [s], or less, so that no grain moves by more than its Courant number of
  /// spacings.
  double time_step() {
    double fastest = 0;
    for (const Vec& v : std::as_const(grains_).particles()[velocity]) {
      fastest = std::max(fastest, double(v.norm()));
    }
    return std::min(fluid_.time_step(), settings().courant * settings().spacing / fastest);
  }
  void step() { step(time_step()); }
  /// One step of the flow of dt [s], and those of the grains within it, with u and ∇P of the fluid
  /// at its beginning. If one of them throws, both are as before.
  void step(double dt) {
    detail::require_common_times(grains_, fluid_, time_);
    save();
    try {
      G& grains = grains_.particles();
      F& fluid = fluid_.particles();
      const Vec g = settings().gravity.template cast<Real>();
      const GrainEnergy before = GrainEnergyAccount::of(std::as_const(grains), g);
      const Index number = grains.size();
      exchange_.find_volumes(grains, fluid);
      const auto& forces = begin_forces();
      exchange_.give_to_grains(
          grains, fluid, dt,
          [&](double diameter, double fluid_fraction, double speed, double immersed) {
            return forces.coefficient(diameter, fluid_fraction, speed, immersed);
          },
          [&](const Vec& x) {
            if (!settings().body_force) return g;
            return Vec(
                g + settings().body_force(x.template cast<double>(), time_).template cast<Real>());
          });
      grains_.run({.until = time_ + dt, .end_exactly = true});
      exchange_.give_to_fluid(grains, fluid, dt);
      fluid_.step(dt);
      auto work = exchange_.correct(grains, fluid, dt, forces.acted_for());
      work.on_grains += forces.work();
      energy_.add({.before = before,
                   .after = GrainEnergyAccount::of(std::as_const(grains), g),
                   .on_grains = work.on_grains,
                   .on_fluid = work.on_fluid,
                   .after_fluid = work.after_fluid,
                   .has_all_grains = grains.size() == number},
                  g);
    } catch (...) {
      restore();
      throw;
    }
    time_ += dt;
    last_time_step_ = dt;
    ++steps_;
  }
  /// See Simulation::run().
  template <class... Observers>
    requires(Observer<Observers, Coupled> && ...)
  bool run(const Run& run, Observers&&... observers) {
    return silt::detail::RunLoop(*this, run, observers...).perform();
  }

  /// How far let_fluid_settle() goes.
  struct Settling {
    double tolerance = 1e-4;  ///< of the last move of a particle, over l0 [-]
    int max_steps = 1000;     ///< of the flow
  };
  /// Before the first step: moves the fluid to where it rests between the grains, which are held,
  /// by steps of the flow after each of which it has no velocity. Returns the last move, over l0
  /// [-]. Throws after a step, and if the flow fails.
  double let_fluid_settle(const Settling& settling = {}) {
    if (steps_ > 0) {
      fail("Coupled: let_fluid_settle() was called after a step; call it before the first one");
    }
    require_positive("Coupled: let_fluid_settle: tolerance", settling.tolerance);
    require_positive("Coupled: let_fluid_settle: max_steps", settling.max_steps);
    FluidSimulation trial = fluid_;
    double moved = 0;
    for (int n = 0; n < settling.max_steps; ++n) {
      const double dt = trial.time_step();
      trial.step(dt);
      moved = 0;
      for (auto&& u : trial.particles()[velocity]) {
        moved = std::max(moved, double(u.norm()) * dt / settings().spacing);
        u.setZero();
      }
      exchange_.find_volumes(grains_.particles(), trial.particles());
      if (moved < settling.tolerance) break;
    }
    const F& settled = trial.particles();
    F& fluid = fluid_.particles();
    const auto copy = [&](auto field) {
      const auto values = settled[field];
      const auto own = fluid[field];
      for (Index i = 0; i < fluid.size(); ++i) {
        const Index there = settled.index_of(fluid.id(i));
        if (there != no_index) own[i] = values[there];
      }
    };
    copy(position), copy(mps::pressure), copy(mps::pressure_gradient), copy(mps::surface);
    exchange_.find_volumes(grains_.particles(), fluid);
    return moved;
  }

  /// Writes or reads the state of both for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive.within("grains", [&] { grains_.transfer(archive); });
    archive.within("fluid", [&] { fluid_.transfer(archive); });
    archive.within("energy", [&] { energy_.transfer(archive); });
    archive.finite([&] {
      archive("time", time_);
      archive("steps", steps_);
      archive("last_time_step", last_time_step_);
      run_.transfer(archive);
    });
    if constexpr (Archive::reads) detail::require_common_times(grains_, fluid_, time_);
  }

 private:
  template <class, class...>
  friend class silt::detail::RunLoop;

  const auto& settings() const { return fluid_.interaction().settings(); }
  const FluidForceCoefficients& coefficients() {
    return detail::fluid_forces_of(grains_.interaction()).coefficients();
  }
  // The part of the grains' interaction, which begins to sum impulses.
  auto& begin_forces() {
    auto& forces = detail::fluid_forces_of(grains_.interaction());
    forces.begin(
        {.density = settings().density, .viscosity = settings().density * settings().viscosity});
    return forces;
  }

  void save() {
    saved_grains_ = grains_;
    const F& fluid = fluid_.particles();
    saved_.for_each([&](auto field, auto& saved) {
      const auto values = fluid[field];
      saved.assign(values.begin(), values.end());
    });
  }
  void restore() {
    grains_ = *saved_grains_;
    F& fluid = fluid_.particles();
    saved_.for_each([&](auto field, const auto& saved) {
      std::copy(saved.begin(), saved.end(), fluid[field].begin());
    });
  }
  // What is changed of the fluid before its own step, which undoes the rest.
  struct SavedFluid {
    Buffer<Real> fractions, rates, responses;
    Buffer<Vec> exchange;
    Buffer<std::uint8_t> surface;

    template <class Each>
    void for_each(Each&& f) {
      f(mps::fluid_fraction, fractions);
      f(mps::fluid_fraction_rate, rates);
      f(mps::response, responses);
      f(mps::momentum_exchange, exchange);
      f(mps::surface, surface);
    }
  };

  GrainSimulation grains_;
  FluidSimulation fluid_;
  Exchange<G, F> exchange_;
  GrainEnergyAccount energy_;
  double time_ = 0;
  double last_time_step_ = 0;
  std::uint64_t steps_ = 0;
  std::optional<GrainSimulation> saved_grains_;
  SavedFluid saved_;
  silt::detail::ThreadChoice thread_choice_;
  silt::detail::RunState run_;
};

}  // namespace silt::coupled
