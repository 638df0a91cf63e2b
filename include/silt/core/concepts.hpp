// SPDX-License-Identifier: MIT
// The concepts modelled by the components of a simulation. Conventions throughout the library:
//
//   r_ij = x_j − x_i                      points from i to j
//   normal n of a contact                 direction of a repulsive force on i: n = −r_ij / r
//   an interaction ADDS forces and torques; the integrator sets them to zero before
//   a spin is positive counter-clockwise; SI units
//   an index below size() is an owned particle, from local() on a ghost, between both one of the
//   halo (shared_particles.hpp); fields of ghosts have the values of the last refresh_ghosts(field)
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/shared_array.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <string>
#include <string_view>
#include <utility>

namespace silt {

/// A particle container with the interface of Particles.
template <class P>
concept ParticleSet = requires(P p, const P q) {
  typename P::Real;
  typename P::Vec;
  { P::dimension } -> std::convertible_to<int>;
  { q.size() } -> std::same_as<Index>;
  p[position];
};

namespace detail {
// A function that searches can call for neighbours and pairs, like any generic lambda.
struct AnyVisitor {
  void operator()(const auto&...) const {}
};
}  // namespace detail

/// S has the dimension and precision of P, or works with any (then it has no S::Vec).
template <class S, class P>
concept FitsVectorsOf =
    !requires { typename S::Vec; } || std::same_as<typename S::Vec, typename P::Vec>;

/// Finds all pairs closer than radius(). Models: UniformGrid, NeighbourList, BruteForce.
template <class S, class P>
concept NeighbourSearch = ParticleSet<P> && FitsVectorsOf<S, P> &&
                          requires(S s, const S found, P& p, typename P::Real r, Index i) {
                            s.set_radius(r);
                            { found.radius() } -> std::convertible_to<typename P::Real>;
                            s.update(p);
                            found.for_each_neighbour(i, detail::AnyVisitor{});
                            found.for_each_pair(detail::AnyVisitor{});
                          };

/// Can reorder the owned particles in memory, for speed; ids do not change.
template <class S, class P>
concept SortsParticles = requires(S s, P& p) { s.sort(p); };

/// f(j) for every candidate j of the owned particle i, that is, every j that may be closer to i
/// than radius() + margin_of(search). A pair of owned particles is reported at one of the two; a
/// pair across a periodic side at both, each with the ghost of the other. Pairs farther apart may
/// be reported as well.
template <class S, class F>
void for_each_candidate(const S& search, Index i, F&& f) {
  if constexpr (requires { search.for_each_candidate(i, f); }) {
    search.for_each_candidate(i, f);
  } else {
    search.for_each_neighbour(i, [&](Index j, const auto&, auto) {
      if (j > i) f(j);
    });
  }
}

/// The candidates include all pairs closer than radius() plus this distance [m].
template <class Real, class S>
Real margin_of(const S& search) {
  if constexpr (requires { search.margin(); }) {
    return search.margin();
  } else {
    return 0;
  }
}

/// Positions of the last update [m], with those of the halo and perhaps of ghosts, for others to
/// keep in the same memory; none if the search keeps none.
template <class Vec, class S>
SharedArray<Vec> last_positions_of(const S& search) {
  if constexpr (requires {
                  { search.last_positions() } -> std::convertible_to<SharedArray<Vec>>;
                }) {
    return search.last_positions();
  } else {
    return {};
  }
}

/// Calls I::explain<P>(), if it exists: static_asserts with readable messages about missing fields
/// or members. Returns true, so that the call can be the condition of a static_assert.
template <class I, class P>
constexpr bool explain() {
  if constexpr (requires { I::template explain<P>(); }) I::template explain<P>();
  return true;
}

namespace detail {
template <class I, class P>
struct InteractionFor {
  using type = I;
};
// Not for types derived from I, of which For<P> would be only a part.
template <class I, class P>
  requires requires { typename I::template For<P>; } && std::same_as<typename I::Description, I>
struct InteractionFor<I, P> {
  using type = typename I::template For<P>;
};
}  // namespace detail

/// The type in which a simulation of particles P stores an interaction I: I::For<P>, constructed
/// from an I, if I has it and I::Description is I; otherwise I itself. For interactions with data
/// whose types depend on the particles, such as dem::Contacts.
template <class I, class P>
using ForParticles = typename detail::InteractionFor<I, P>::type;

/// The interaction for these particles, for calls without a simulation.
template <class I, class P>
ForParticles<I, P> for_particles(I interaction, const P&) {
  static_assert(explain<I, P>());
  return ForParticles<I, P>(std::move(interaction));
}

/// i.reach(p) is the interaction range [m]; 0 if no neighbours are needed.
template <class I, class P>
concept HasReach = requires(const ForParticles<I, P> i, const P& p) {
  { i.reach(p) } -> std::convertible_to<typename P::Real>;
};

/// Adds forces [N] and torques [N m] to the particles; changes no field that the integrator
/// advances. Models: dem::Contacts, that is, dem::ContactsOf; dem::Bonds, Gravity, Forces.
template <class I, class P, class S>
concept Interaction =
    NeighbourSearch<S, P> && HasReach<I, P> &&
    requires(ForParticles<I, P> i, P& p, S& s, double dt) { i.accelerate(p, s, dt); };

/// A function of a range [first, last) of particles.
using FunctionOfRange = FunctionRef<void(Index first, Index last)>;
/// The one that does nothing.
inline constexpr auto do_nothing = [](Index, Index) {};

/// Functions called by accelerate(p, s, dt, pass) for ranges of particles; see below. They must
/// outlive the call.
struct Pass {
  FunctionOfRange before = do_nothing;  ///< before forces are added to a range
  FunctionOfRange after = do_nothing;   ///< when all are added
};

/// accelerate(p, s, dt, pass) adds the same forces as accelerate(p, s, dt) in one pass over the
/// particles, range by range: it calls pass.before(first, last) before it adds forces to the
/// particles [first, last), and pass.after(first, last) when all are added. Every particle is in
/// exactly one range; ranges are processed in parallel. pass.after() may advance these particles,
/// see Particles::advance. Models: dem::ContactsOf, dem::Bonds, Forces of these.
template <class I, class P, class S>
concept AcceleratesInPass =
    requires(I i, P& p, S& s, double dt, const Pass& pass) { i.accelerate(p, s, dt, pass); };

namespace detail {
/// Whether what a step moves is written to other memory than it is read from, see
/// Particles::advance.
template <class P>
bool moves_in_other_memory(const P& particles) {
  bool result = particles.is_advancing(position);
  const auto also = [&]<class F>(F field) {
    if constexpr (HasFields<P, F>) result &= particles.is_advancing(field);
  };
  also(velocity);
  if constexpr (HasFields<P, torque_t, inertia_t>) also(spin);
  return result;
}
}  // namespace detail

/// add_forces(p, i) adds to the owned particle i alone what accelerate() adds to all; it reads only
/// this particle. Forces adds them in the pass of another interaction. Model: Gravity.
template <class I, class P>
concept AddsForces = requires(const I i, P& p, Index k) { i.add_forces(p, k); };

/// f(i) for all n particles, in a pass over them.
template <class F>
void for_each_in_pass(Index n, const Pass& pass, F&& f) {
  for_each_range(n, [&](Index first, Index last) {
    pass.before(first, last);
    for (Index i = first; i < last; ++i) f(i);
    pass.after(first, last);
  });
}
/// accelerate() of an interaction with add_forces().
template <class I, class P>
  requires AddsForces<I, P>
void accelerate_each(const I& interaction, P& particles, const Pass& pass = {}) {
  for_each_in_pass(particles.size(), pass, [&](Index i) { interaction.add_forces(particles, i); });
}

/// needs_search(p) is false if the next accelerate() for these particles does not use the search,
/// which then need not be updated. A class derived from an interaction that has it must have its
/// own if it uses the search itself.
template <class I, class P>
bool needs_search(const I& interaction, const P& particles) {
  if constexpr (requires { interaction.needs_search(particles); }) {
    return interaction.needs_search(particles);
  } else {
    return true;
  }
}

/// Depends on time: set_time(t) sets the time of the positions [s] and is called before any other
/// function in a step. An interaction does not advance the time itself; see Simulation::time().
/// Models: dem::ContactsOf, Forces.
template <class I>
concept DependsOnTime = requires(I i, double time) { i.set_time(time); };

/// Calls set_time(time [s]) of an interaction that has it.
template <class I>
void set_time(I& interaction, double time) {
  if constexpr (DependsOnTime<I>) interaction.set_time(time);
}

/// Adds up what happens between evaluations, such as the slip of a contact: set_last_time_step(dt)
/// sets for how long the particles have moved since the last one [s], 0 before the first step. It
/// holds for the next evaluation; without it, the time step of that evaluation counts. Called by
/// Leapfrog. Models: dem::ContactsOf, Forces.
template <class I>
concept DependsOnLastTimeStep = requires(I i, double dt) { i.set_last_time_step(dt); };

/// Calls set_last_time_step(dt [s]) of an interaction that has it.
template <class I>
void set_last_time_step(I& interaction, double dt) {
  if constexpr (DependsOnLastTimeStep<I>) interaction.set_last_time_step(dt);
}

/// An incompressible flow, advanced by a predictor and a pressure correction. It may also have
/// advect(p, dt), which moves the particles with the velocities of the predictor, and the constant
/// needs_moved_particles. Model: mps::Flow.
template <class I, class P, class S>
concept PressureInteraction =
    NeighbourSearch<S, P> && HasReach<I, P> && requires(I i, P& p, S& s, double dt) {
      i.predict(p, s, dt);
      i.collide(p, s, dt);
      { i.project(p, s, dt) } -> std::same_as<SolveReport>;
      i.correct(p, dt);
    };

/// Whether some of the particles P move as parts of rigid bodies, by an integrator of their own:
/// grains with clumps. Leapfrog does not compile with them.
template <class P>
inline constexpr bool move_in_bodies = false;

/// Whether F is one of the Fs.
template <class F, class... Fs>
inline constexpr bool one_of = (std::same_as<F, Fs> || ...);

/// T writes field F only through Particles::advance or after Particles::keep, so that the
/// simulation need not save it.
template <class T, class F>
concept AdvancesField = bool(T::template advances<F>);

/// Advances particles by one step. step() may return a bool: true if it has verified that all
/// positions, velocities, spins and angles after the step are finite and all positions within the
/// box. It may also have
///
///   advances<F>           true for the fields that it saves itself, see AdvancesField
///   max_energy_gain()     → [-], of the kinetic energy in the last step, see FinishedStep in
///                         core/watch.hpp
/// Models: Leapfrog, SemiImplicit.
template <class T, class P, class S, class I>
concept Integrator =
    NeighbourSearch<S, P> && HasReach<I, P> &&
    requires(T t, P& p, S& s, ForParticles<I, P>& i, double dt) { t.step(p, s, i, dt); };

/// Chooses the next time step [s].
template <class I, class P>
concept ChoosesTimeStep = requires(ForParticles<I, P> i, const P& p) {
  { i.time_step(p) } -> std::convertible_to<double>;
};

/// i.limit_of_time_step(p) names what makes time_step(p) as short as it is, and what to do about
/// it; for messages. Models: dem::ContactsOf, Forces.
template <class I, class P>
concept LimitsTimeStep = requires(const I i, const P& p) {
  { i.limit_of_time_step(p) } -> std::convertible_to<std::string>;
};

/// Has state that must be rolled back if a step fails.
template <class T>
concept Transactional = requires(T t) {
  t.save();
  { t.restore() } noexcept;
};

/// kicked(v, a, dt) is the velocity after dt, from the velocity before and the acceleration. It may
/// also have
///
///   check(), check(dt)            throw if a parameter, or the time step, is out of range
///   half_step_before(v, a, dt)    v^{N−½} from v^N, if it is not v − ½ a Δt
///   drag(v)                       acceleration due to damping at v^N, for an energy ledger
///
/// Models: NoDamping, GlobalDamping.
template <class D, class Real = double>
concept Damping = requires(const D d, Real v, Real a, Real dt) {
  { d.kicked(v, a, dt) } -> std::convertible_to<Real>;
};

namespace detail {
struct CallWithSimulation {
  void operator()(std::string_view name, const auto& simulation) const;
};
}  // namespace detail
/// s.for_each_simulation(f) calls f(name, simulation) with each of several simulations that are
/// advanced together. Model: coupled::Coupled.
template <class Sim>
concept ConsistsOfSimulations =
    requires(const Sim& s) { s.for_each_simulation(detail::CallWithSimulation{}); };

struct Run;

/// o(simulation), called at every output. Lambdas are observers.
template <class O, class Sim>
concept ObservesOutputs = std::invocable<O&, const Sim&>;
/// o.before_step(simulation), called before every step; may change the simulation: inflow, removal.
template <class O, class Sim>
concept ActsBeforeSteps = requires(O o, Sim& simulation) { o.before_step(simulation); };
/// o.after_step(simulation, run), called after every step.
template <class O, class Sim>
concept ObservesSteps =
    requires(O o, const Sim& simulation, const Run& run) { o.after_step(simulation, run); };

/// o.between_steps(simulation), called after every step and all other calls for it, so that a
/// checkpoint written here is complete.
template <class O, class Sim>
concept ActsBetweenSteps = requires(O o, const Sim& simulation) { o.between_steps(simulation); };
/// o.stop_requested(), called before every step; true ends the run.
template <class O>
concept EndsRuns = requires(O o) {
  { o.stop_requested() } -> std::convertible_to<bool>;
};

/// Has at least one of these five.
template <class O, class Sim>
concept Observer = ObservesOutputs<O, Sim> || ActsBeforeSteps<O, Sim> || ObservesSteps<O, Sim> ||
                   ActsBetweenSteps<O, Sim> || EndsRuns<O>;

namespace detail {

// Each calls one function of an observer, if the observer has it.
template <class O, class Sim>
void call_at_output(O& observer, const Sim& simulation) {
  if constexpr (ObservesOutputs<O, Sim>) observer(simulation);
}
template <class O, class Sim>
void call_before_step(O& observer, Sim& simulation) {
  if constexpr (ActsBeforeSteps<O, Sim>) observer.before_step(simulation);
}
template <class O, class Sim>
void call_after_step(O& observer, const Sim& simulation, const Run& run) {
  if constexpr (ObservesSteps<O, Sim>) observer.after_step(simulation, run);
}
template <class O, class Sim>
void call_between_steps(O& observer, const Sim& simulation) {
  if constexpr (ActsBetweenSteps<O, Sim>) observer.between_steps(simulation);
}
template <class O>
bool requests_stop(O& observer) {
  if constexpr (EndsRuns<O>) {
    return observer.stop_requested();
  } else {
    return false;
  }
}

}  // namespace detail

}  // namespace silt
