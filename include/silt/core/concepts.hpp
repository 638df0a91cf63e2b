// SPDX-License-Identifier: MIT
// What a simulation is made of, as concepts. Conventions that hold everywhere:
//
//   r_ij = x_j − x_i                      points from i to j
//   normal n of a contact                 points the way i is pushed, so n = −r_ij / r
//   forces and moments are ADDED by an interaction; the integrator clears them
//   a spin is counter-clockwise positive; SI units throughout
//   an index below size() is an owned particle, one above it a ghost: fields of ghosts are as fresh
//   as the last refresh_ghosts(field)
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <type_traits>
#include <utility>

namespace silt {

/// A container of particles with the columns of Particles.
template <class P>
concept ParticleSet = requires(P p, const P q) {
  typename P::Real;
  typename P::Vec;
  { P::dimension } -> std::convertible_to<int>;
  { q.size() } -> std::same_as<Index>;
  p[position];
};

/// Functions of the shape that searches call: any generic lambda will do.
namespace archetype {
struct OnNeighbour {
  template <class V, class R>
  void operator()(Index, const V&, R) const {}
};
struct OnPair {
  template <class V, class R>
  void operator()(Index, Index, const V&, R) const {}
};
}  // namespace archetype

/// Made for vectors of P's dimension and precision, or for any (then it has no S::Vec).
template <class S, class P>
concept FitsVectorsOf =
    !requires { typename S::Vec; } || std::same_as<typename S::Vec, typename P::Vec>;

/// Finds all pairs closer than radius(). Models: UniformGrid, NeighbourList, BruteForce.
template <class S, class P>
concept NeighbourSearch =
    ParticleSet<P> && FitsVectorsOf<S, P> &&
    requires(S s, const S found, P& p, typename P::Real r, Index i) {
      s.set_radius(r);
      { found.radius() } -> std::convertible_to<typename P::Real>;
      s.update(p);
      found.for_each_neighbour(i, archetype::OnNeighbour{});
      found.for_each_pair(archetype::OnPair{});
    };

/// May put the owned particles into an order in memory that makes it faster; ids stay.
template <class S, class P>
concept SortsParticles = requires(S s, P& p) { s.sort(p); };

/// f(j) for every j that may be closer to owned particle i than radius() + margin_of(search): of a
/// pair of owned particles at one of the two, of a pair across a periodic side at both, each with
/// the ghost of the other. More may come.
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

/// How far beyond radius() the candidates are complete now [m].
template <class Real, class S>
Real margin_of(const S& search) {
  if constexpr (requires { search.margin(); }) {
    return search.margin();
  } else {
    return 0;
  }
}

/// Knows how far it reaches [m]; 0 if it needs no neighbours.
template <class I, class P>
concept Reaching = requires(const I i, const P& p) {
  { i.reach(p) } -> std::convertible_to<typename P::Real>;
};

/// Adds forces [N] and moments [N m] to the particles, and changes no other field of theirs that
/// the integrator advances. Models: dem::Contacts, Gravity, Forces.
template <class I, class P, class S>
concept Interaction =
    NeighbourSearch<S, P> && Reaching<I, P> && requires(I i, P& p, S& s, double dt) {
      i.accelerate(p, s, dt);
    };

/// An interaction may also have add_forces(p, i), which adds to owned particle i alone what
/// accelerate() adds to all: a step can so go through the particles once. If more than particle i
/// has a part in that, it may also have
///   prepare(p, s, dt)      called once, before all
///   interact(p, chunk)     called for every chunk of particles: makes what several particles share
///   needs<P>(chunk)        the chunks whose interact() takes part in the forces of this one's particles
///   conclude(p, dt)        called once, behind all
/// Models: dem::Contacts, Gravity, Forces.
template <class I, class P>
concept AddsForces = requires(const I i, P& p, Index k) { i.add_forces(p, k); };

template <class I, class P, class S>
void prepare(I& interaction, P& particles, S& search, double dt) {
  if constexpr (requires { interaction.prepare(particles, search, dt); }) {
    interaction.prepare(particles, search, dt);
  }
}
template <class I, class P>
void interact(I& interaction, P& particles, Chunk chunk) {
  if constexpr (requires { interaction.interact(particles, chunk); }) {
    static_assert(requires { { interaction.template needs<P>(chunk) } -> std::same_as<ChunkSpan>; },
                  "silt: an interaction with interact(particles, chunk) also has needs<P>(chunk), "
                  "which gives a ChunkSpan");
    interaction.interact(particles, chunk);
  }
}
template <class P, class I>
ChunkSpan needs(const I& interaction, Chunk chunk) {
  if constexpr (requires { interaction.template needs<P>(chunk); }) {
    return interaction.template needs<P>(chunk);
  } else {
    return {chunk.number, chunk.number};
  }
}
template <class I, class P>
void conclude(I& interaction, P& particles, double dt) {
  if constexpr (requires { interaction.conclude(particles, dt); }) {
    interaction.conclude(particles, dt);
  }
}

/// use_forces(chunk) for all particles, once what they need has interacted: it may call
/// add_forces() for those of the chunk, and change them. Between prepare() and conclude().
template <class I, class P, class UseForces>
  requires AddsForces<I, P>
void for_each_chunk_with_forces(I& interaction, P& particles, UseForces&& use_forces) {
  for_each_chunk_in_two(
      particles.size(), [&](Chunk chunk) { interact(interaction, particles, chunk); }, use_forces,
      [&](Chunk chunk) { return needs<P>(interaction, chunk); });
}
template <class I, class P, class S>
  requires AddsForces<I, P>
void accelerate_all(I& interaction, P& particles, S& search, double dt) {
  prepare(interaction, particles, search, dt);
  for_each_chunk_with_forces(interaction, particles, [&](Chunk chunk) {
    for (Index i = chunk.first; i < chunk.last; ++i) {
      std::as_const(interaction).add_forces(particles, i);
    }
  });
  conclude(interaction, particles, dt);
}

/// Depends on time: set_time(t) tells it the time of the positions [s] before it is asked for anything
/// that a step takes. It keeps no clock of its own: Simulation::time() is the one. Models:
/// dem::Contacts, Forces.
template <class I>
concept DependsOnTime = requires(I i, double time) { i.set_time(time); };

template <class I>
void set_time(I& interaction, double time) {
  if constexpr (DependsOnTime<I>) interaction.set_time(time);
}

/// An incompressible flow, advanced by predictor and pressure. It may also have advect(p, dt),
/// which moves the particles with the predictor's velocities, and needs_moved_particles. Model:
/// mps::Flow.
template <class I, class P, class S>
concept PressureInteraction =
    NeighbourSearch<S, P> && Reaching<I, P> && requires(I i, P& p, S& s, double dt) {
      i.predict(p, s, dt);
      i.collide(p, s, dt);
      { i.project(p, s, dt) } -> std::same_as<SolveReport>;
      i.correct(p, dt);
    };

/// Field F is written by T only through Particles::advance or after Particles::keep, so that nobody
/// else need save it.
template <class T, class F>
concept AdvancesField = bool(T::template advances<F>);

/// Advances particles by one step. It may also have
///   advances<F>     true for the fields that it saves itself, see AdvancesField
///   all_finite()    true if it knows that all it made in the last step is finite
/// Models: Leapfrog, SemiImplicit.
template <class T, class P, class S, class I>
concept Integrator =
    NeighbourSearch<S, P> && Reaching<I, P> && requires(T t, P& p, S& s, I& i, double dt) {
      t.step(p, s, i, dt);
    };

/// Lets a part of a simulation say in its own words what it misses: I::explain<P>(), all
/// static_asserts. True, so that it can stand in one.
template <class I, class P>
constexpr bool explain() {
  if constexpr (requires { I::template explain<P>(); }) I::template explain<P>();
  return true;
}

/// Chooses the next time step [s].
template <class I, class P>
concept ChoosesTimeStep = requires(I i, const P& p) {
  { i.time_step(p) } -> std::convertible_to<double>;
};

/// Has state of its own that a failed step must undo.
template <class T>
concept Transactional = requires(T t) {
  t.save();
  { t.restore() } noexcept;
};

/// Velocity after dt, from the velocity before and the acceleration. It may also have
///   check(), check(dt)            throw if a parameter, or a step, is out of range
///   half_step_before(v, a, dt)    v^{N−½} from v^N, where that is not v − ½ a Δt
///   drag(v)                       its part of the acceleration at v^N, for an energy ledger
/// Models: NoDamping, GlobalDamping.
template <class D, class Real = double>
concept Damping = requires(const D d, Real v, Real a, Real dt) {
  { d.kicked(v, a, dt) } -> std::convertible_to<Real>;
};

struct Run;

/// Called with the simulation at every output. A lambda is one.
template <class O, class Sim>
concept ObservesOutputs = std::invocable<O&, const Sim&>;
/// o.before_step(simulation), called before every step, may change it: inflow, removal.
template <class O, class Sim>
concept ActsBeforeSteps = requires(O o, Sim& simulation) { o.before_step(simulation); };
/// o.after_step(simulation, run), called after every step.
template <class O, class Sim>
concept ObservesSteps =
    requires(O o, const Sim& simulation, const Run& run) { o.after_step(simulation, run); };

/// o.between_steps(simulation), called after every step, once every observer has been called for
/// it: a checkpoint that is written here is complete.
template <class O, class Sim>
concept ActsBetweenSteps = requires(O o, const Sim& simulation) { o.between_steps(simulation); };
/// Can end a run: o.stop_requested() is called before every step, and ends the run if it is true.
template <class O>
concept EndsRuns = requires(O o) {
  { o.stop_requested() } -> std::convertible_to<bool>;
};

/// Does at least one of the five.
template <class O, class Sim>
concept Observer = ObservesOutputs<O, Sim> || ActsBeforeSteps<O, Sim> || ObservesSteps<O, Sim> ||
                   ActsBetweenSteps<O, Sim> || EndsRuns<O>;

}  // namespace silt
