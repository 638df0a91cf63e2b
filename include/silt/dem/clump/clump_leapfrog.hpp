// SPDX-License-Identifier: MIT
// The leapfrog for grains of which some are spheres of clumps.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/shared_particles.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/clump/clump_faces.hpp>
#include <silt/dem/clump/clumps.hpp>
#include <silt/dem/clump/motion_of_grains.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/integrate/damping.hpp>
#include <silt/integrate/leapfrog.hpp>
#include <silt/integrate/leapfrog_operations.hpp>

#include <utility>

namespace silt::dem {

/// Advances clumps, and grains that belong to none, as Leapfrog does grains: [SahChoi2004]
/// (15)–(33) with the velocity and the angular momentum of each clump in place of velocity and
/// spin. Between two kicks a clump turns as a free body, see geometry/free_rotation.hpp. The
/// results have velocities at half steps; Simulation::snapshot() returns those at time().
///
/// The first step throws if a mass or moment of inertia is not positive and finite; each step, if a
/// sphere of a clump was removed without the others, or if a clump turns too far in it.
template <int Dim, Damping<double> D = NoDamping>
class ClumpLeapfrog {
 public:
  /// Throws if a parameter of the damping model is out of range.
  explicit ClumpLeapfrog(Clumps<Dim> clumps, D damping = {})
      : clumps_(std::move(clumps)), damping_(damping) {
    if constexpr (requires { damping.check(); }) damping.check();
  }

  /// The clumps, with velocities at half steps. What the program changes holds from the next step
  /// on.
  Clumps<Dim>& clumps() noexcept { return clumps_; }
  const Clumps<Dim>& clumps() const noexcept { return clumps_; }

  /// The damping model; see Leapfrog.
  const D& damping() const noexcept { return damping_; }
  /// See Leapfrog.
  void set_damping(D damping) {
    if constexpr (requires { damping.check(); }) damping.check();
    damping_ = damping;
  }

  template <class P, class S, class I>
    requires Interaction<I, P, S> && HasFields<P, clump_t, clump_mass_t> && (P::dimension == Dim)
  bool step(P& grains, S& search, I& interaction, double dt) {
    static_assert(silt::detail::are_of_one_process<P>,
                  "silt::dem::ClumpLeapfrog: a clump moves within one process; use particles that "
                  "processes do not share");
    if constexpr (requires { damping_.check(dt); }) damping_.check(dt);
    if (grains.box().on_escape == OnEscape::remove) {
      fail(
          "dem::ClumpLeapfrog: the box has OnEscape::remove, which takes grains one by one, also "
          "spheres of clumps; use OnEscape::refuse and a dem::Outflow");
    }
    set_last_time_step(interaction, started_ ? last_time_step_ : 0);
    if (!started_) start(grains, search, interaction, dt);
    // The time between the half steps; dt if the time step is constant.
    const double between_half_steps = (last_time_step_ + dt) / 2;
    evaluate(grains, search, interaction, dt);
    const bool is_valid = move(grains, dt, Drift::yes, [=, this](double v, double a) {
      return static_cast<double>(damping_.kicked(v, a, between_half_steps));
    });
    last_time_step_ = dt;
    return is_valid;
  }

  /// Advances velocities, spins and angular momenta from N − ½ to N; see Leapfrog.
  template <class P, class S, class I>
  void synchronise(P& grains, S& search, I& interaction) {
    set_last_time_step(interaction, last_time_step_);
    evaluate(grains, search, interaction, last_time_step_);
    move(grains, 0, Drift::no,
         [this](double v, double a) { return kicked_to_mean(damping_, v, a, last_time_step_); });
  }

  /// Writes or reads the state of the integrator for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("started", started_);
    archive("last_time_step", last_time_step_);
    archive.within("clumps", [&] { clumps_.transfer(archive); });
  }

  // See AdvancesField in core/concepts.hpp.
  template <class F>
  static constexpr bool advances = one_of<F, position_t, velocity_t, spin_t, angle_t>;

 private:
  enum class Drift { no, yes };

  template <class P, class S, class I>
  static void evaluate(P& grains, S& search, I& interaction, double dt) {
    if (needs_search(interaction, grains)) search.update(grains);
    clear(grains);
    interaction.accelerate(grains, search, dt);
  }

  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps.
  template <class P, class S, class I>
  [[gnu::cold]] void start(P& grains, S& search, I& interaction, double dt) {
    silt::detail::check_inertia(std::as_const(grains));
    last_time_step_ = dt;
    started_ = true;
    I trial = interaction;  // a copy: the contact histories must not advance
    evaluate(grains, search, trial, dt);
    move(grains, -dt, Drift::no,
         [=, this](double v, double a) { return half_step_back(damping_, v, a, dt); });
  }

  // Changes all velocities and then, with a drift, moves for dt. Returns whether all results are
  // valid.
  template <class P, class Change>
  bool move(P& grains, double dt, Drift drift, const Change& change) {
    detail::MotionOfGrains<P> motion(grains, drift == Drift::yes ? dt : 0);
    clumps_.advance(grains, dt, drift == Drift::yes, change, [&] { return motion.range(); });
    const auto names = std::as_const(grains)[clump];
    for_each_range(grains.size(), [&](Index first, Index last) {
      auto range = motion.range();
      for (Index i = first; i < last; ++i) {
        if (names[i] == 0) range.change(i, change);
      }
    });
    grains.finish_advance(motion.max_displacement());
    return motion.is_valid();
  }

  Clumps<Dim> clumps_;
  D damping_{};
  bool started_ = false;
  double last_time_step_ = 0;
};

}  // namespace silt::dem
