// SPDX-License-Identifier: MIT
// The contact interaction of DEM. A step, accelerate(), is made of
//
//   begin_step       the list of the last step, extended or rebuilt         list_of_step.hpp
//   loop             evaluates the law once for each contact, then sums     block_loop.hpp
//                    the forces on each grain in a fixed order
//   check_stability  throws if the time step is unstable for the contacts   stable_time_step.hpp
//
// After the integrator's part of the step, check_step() throws if grains or walls moved too far
// (step_limits.hpp), or if contacts gave more energy than they had (energy_check.hpp).
//
// The result of accelerate(), an Evaluation (evaluation.hpp), replaces that of the step before;
// restore() undoes this. Observers read it through ContactsOfStep (contacts_of_step.hpp).
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/own_memory.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/dem/contact/block_evaluator.hpp>
#include <silt/dem/contact/block_loop.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/contacts_of_step.hpp>
#include <silt/dem/contact/default_time_step.hpp>
#include <silt/dem/contact/described_contacts.hpp>
#include <silt/dem/contact/energy_check.hpp>
#include <silt/dem/contact/evaluation.hpp>
#include <silt/dem/contact/lasting_contacts.hpp>
#include <silt/dem/contact/list_of_step.hpp>
#include <silt/dem/contact/list_rebuild.hpp>
#include <silt/dem/contact/of_constants.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/contact/saved_list.hpp>
#include <silt/dem/contact/setup_comparison.hpp>
#include <silt/dem/contact/stable_time_step.hpp>
#include <silt/dem/contact/step_limits.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/wall/wall_set.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace silt::dem {

/// Contacts of grains of type P; see Contacts.
template <class P, class Law, class... Walls>
class ContactsOf : public Contacts<Law, Walls...> {
  using Real = typename P::Real;
  static constexpr int dimension = P::dimension;
  using Evaluation = detail::Evaluation<P, Law>;
  using History = typename Evaluation::LawHistory::type;
  using List = typename Evaluation::List;
  using Histories = typename Evaluation::Histories;
  using Input = detail::BlockInput<P, Law, WallSet<Walls...>>;
  using Loop = detail::BlockLoop<P, Input>;
  using ContactsOfStep = detail::ContactsOfStep<P, Law, WallSet<Walls...>>;

 public:
  /// Contacts for grains of type P, from their description; made by a Simulation or by
  /// for_particles().
  ContactsOf(Contacts<Law, Walls...> contacts) : Contacts<Law, Walls...>(std::move(contacts)) {}

  /// A copy with other settings and the same histories. Throws if a setting is out of range.
  ContactsOf with(const ContactSettings& settings) const {
    settings.check();
    ContactsOf contacts = *this;
    contacts.settings_ = settings;
    return contacts;
  }

  /// Interaction range: twice the largest radius, and the largest gap of contacts [m]. Throws if a
  /// radius is infinite.
  Real reach(const P& grains) const { return contact_reach(grains).distance(); }

  /// Whether the list of contacts has to be rebuilt, for which the search is used. The next
  /// evaluation is for the grains as they are at this call.
  bool needs_search(const P& grains) const { return list_.needs_rebuild(grains, setup(), time_); }

  /// Adds contact forces [N] and torques [N m], in a pass over the grains if one is given, see
  /// AcceleratesInPass in core/concepts.hpp. Throws if two centres coincide to round-off, if a
  /// radius, mass or inertia is not positive and finite, if products of them underflow or overflow,
  /// if a material does not exist, if positions have too few digits, if an overlap exceeds
  /// ContactSettings::max_overlap, or if dt exceeds the stability limit.
  template <class S>
  void accelerate(P& grains, const S& search, double dt, const Pass& pass = {}) {
    const double since_last = std::exchange(last_time_step_, std::nullopt).value_or(dt);
    Evaluation evaluation =
        list_.begin_step(grains, search, setup(), [&] { return contact_reach(grains); },
                         {.time = time_, .time_step = dt, .last_time_step = since_last});
    const auto after = list_.take_histories();
    const auto known = known_histories(evaluation, grains, *after);
    const detail::GrainRows<dimension, Real> rows(std::as_const(grains));
    detail::UnnoticedChanges changes(std::as_const(grains), *evaluation.list, evaluation.lifetime);
    const Input input(evaluation, known, rows, materials_, walls_, settings_);
    Loop loop(grains, evaluation.contacts(), input, changes, *after, pass, list_.division(),
              memory_->loop);
    evaluation.count = loop.add_forces();
    changes.check(grains);
    evaluation.after = after;
    evaluation.grains = detail::SharedGrains<P>(grains, memory_->copies);
    if constexpr (knows_stiffness) {
      if (settings_.check_stability && dt > evaluation.list->stable_time_step) {
        const ContactsOfStep contacts(grains, materials_, walls_, settings_, evaluation);
        check_stability(grains, contacts, dt);
      }
    }
    list_.finish_step(std::move(evaluation));
  }

  /// Throws if a grain or a wall moved too far in the step, see ContactSettings::max_displacement,
  /// or if the step is too long for a vibrating wall. Called by Simulation.
  void check_step(const P& grains, const FinishedStep& step) const {
    if (grains.empty()) return;
    const double smallest = double(radii_of(grains).smallest);
    detail::check_displacements(grains, smallest, settings_, step);
    if constexpr (WallSet<Walls...>::move) {
      detail::check_motion_of_walls(walls_, list_.last().list->extent, smallest, settings_, step);
    }
  }
  /// See ContactSettings::max_energy_gain; infinite if the energy of the contacts is not known [-].
  double max_energy_gain() const {
    return ContactsOfStep::knows_springs ? settings_.max_energy_gain
                                         : std::numeric_limits<double>::infinity();
  }
  /// Throws if contacts gave more energy than they had. Called by Simulation after a step in which
  /// a grain gained more than max_energy_gain().
  void check_energy(const P& grains, const FinishedStep& step) const {
    if constexpr (ContactsOfStep::knows_springs) {
      if (silt::detail::are_of_one_process<P> && list_.last().count == 0) return;
      detail::check_energy(
          grains, list_.last().grains.rows(), settings_, step,
          [this](const P& before, const P& mean) { return results_for(before).energy(mean); });
    }
  }

  /// Sets the time of the positions [s], which determines where moving walls are. Called by
  /// Simulation.
  void set_time(double time) { time_ = time; }

  /// Sets, for the next evaluation, for how long the grains have moved and contacts have slipped
  /// since the last one [s]; 0 before the first step. Called by Leapfrog; without it, the dt of
  /// accelerate() counts.
  void set_last_time_step(double dt) { last_time_step_ = dt; }

  /// Default time step [s]: the shortest contact duration of the lightest grains with each other
  /// or with a wall, divided by steps_per_contact, or 1/20 of the period of a vibrating wall, if
  /// that is shorter; infinite without grains or stiffness. Throws if a wall makes it less than a
  /// thousandth of that of the grains alone.
  double time_step(const P& grains) const {
    const auto& shortest = shortest_contacts(grains);
    detail::check_walls_are_not_too_stiff(shortest, settings_.steps_per_contact);
    const double of_contacts = shortest.of_all.duration / settings_.steps_per_contact;
    if (!is_finite(of_contacts)) return of_contacts;
    return std::min(of_contacts, walls_.shortest_period() / detail::steps_per_period);
  }
  /// What determines time_step(); see LimitsTimeStep in core/concepts.hpp.
  [[gnu::cold]] std::string limit_of_time_step(const P& grains) const {
    const auto& shortest = shortest_contacts(grains).of_all;
    const double period = walls_.shortest_period();
    if (period / detail::steps_per_period < shortest.duration / settings_.steps_per_contact) {
      return message_of(
          {"dem::Contacts: a wall vibrates with the period ", period, " s; lower its frequency"});
    }
    return message_of({"dem::Contacts: ", shortest.name(), " lasts ", shortest.duration,
                       " s; use a softer material"});
  }

  /// Takes a wall, given by its number, away or puts it back, from the next step on: a gate that
  /// opens. All are present at first. Kept in checkpoints. Throws if there is no such wall.
  void set_wall_present(Index wall, bool present) { walls_.set_present(wall, present); }
  /// Whether the wall acts on grains. Throws if there is no such wall.
  bool is_wall_present(Index wall) const { return walls_.is_present(wall); }

  /// Whether a grain at x [m] with this radius [m] would touch a wall, or be behind one, at a time
  /// [s].
  bool would_touch_wall(const typename P::Vec& x, Real radius, double time) const {
    return walls_.would_touch(x, radius, time);
  }

  /// Adds the work of each grain in units of that of a grain without contacts, see mpi/work.hpp:
  /// its near contacts. Returns false, and adds nothing, if they are not known.
  bool add_work(const P& grains, std::span<double> work) const {
    const List& list = *list_.last().list;
    if (list.rows_revision != grains.rows_revision() || list.contacts.grains() != grains.size()) {
      return false;
    }
    for (Index i = 0; i < work.size(); ++i) work[i] += double(list.contacts.count(i));
    return true;
  }

  /// Number of contacts in the last step, including those with walls. Of grains that processes
  /// share, those of owned grains: contacts between two processes are counted by both.
  Index size() const noexcept { return list_.last().count; }

  // Results of the last step, see ContactsOfStep. They are evaluated again, from the grains and
  // histories before that step. The next step uses this memory for its own results, until one of
  // these functions has been called for the first time. If it fails, the results of the step before
  // are then unknown: these functions throw.

  /// f(i, j, contact, force on i) for every contact of the last step whose grains still exist; i
  /// and j are the current indices of the two, j is `no_index` for a wall. Of grains that processes
  /// share, the grain i is owned and j may be of the halo: each contact is visited in one process.
  /// The contact's velocity is computed from the velocities in `grains`, and for a wall from its
  /// velocity at the time N of the contact. The law is evaluated again in every call.
  template <class F>
  void for_each_contact(const P& grains, F&& f) const {
    last_step(grains).for_each(f);
  }

  /// f(WallContact) for every contact of the last step between a wall and a grain that still
  /// exists.
  template <class F>
  void for_each_wall_contact(const P& grains, F&& f) const {
    last_step(grains).for_each_at_walls(f);
  }

  /// Load on a wall, given by its number, in the last step; the torque is about the point `about`
  /// [m]. Bitwise identical for any number of threads. Of grains that processes share, all call it,
  /// and get the load of all; likewise for elastic_energy(). Throws if there is no such wall, or if
  /// the point is not finite.
  auto load_on(const P& grains, Index wall, const typename P::Vec& about = P::Vec::Zero()) const {
    return last_step(grains).load_on(wall, about);
  }

  /// f(EvaluatedContact) for every contact of the last step, with the law evaluated again on the
  /// same input. `before` are the grains, with their velocities, at the beginning of that step.
  template <class F>
  void for_each_evaluated_contact(const P& before, F&& f) const {
    last_step(before).for_each_evaluated_contact(f);
  }

  /// The law returns the components of its force and the energy in its springs.
  static constexpr bool gives_spring_energy = ContactsOfStep::gives_spring_energy;

  /// Energy in the springs of the last step's contacts [J]; 0 for a law without elastic_energy().
  double elastic_energy(const P& grains) const { return last_step(grains).elastic_energy(); }

  /// The history of all contacts of grains of this process, by pairs of ids; for a checkpoint.
  PairHistory<History> history(const P& grains) const {
    const auto* const given = list_.given_history();
    return given ? *given : results_for(grains).history();
  }

  /// Replaces the history; for resuming from a checkpoint.
  void set_history(const P&, const PairHistory<History>& history) { list_.set_history(history); }

  /// Writes or reads the histories, the list and which walls are present, and compares laws and
  /// walls, for a checkpoint, see core/transfer.hpp. With walls of other numbers of elements than
  /// those of the checkpoint, contacts with walls begin anew.
  template <class Archive>
  void transfer(Archive& archive, const P& grains) {
    auto own = history(grains);
    auto list = list_.saved_list(grains, walls_);
    if constexpr (!Archive::reads) {
      // Those given by set_history() may be of grains that were removed since, or of none.
      own.keep_if([&](Id a, Id b) { return detail::may_touch(grains, a, b); });
    }
    const auto common = detail::compare_setup(archive, grains, materials_, walls_, time_);
    archive.within("walls", [&] { walls_.transfer(archive); });
    archive.within("history", [&] { own.transfer(archive); });
    archive.within("list", [&] { list.transfer(archive); });
    if constexpr (Archive::reads) {
      own.for_each_pair([&](Id a, Id b, const auto&) { detail::check_pair(grains, a, b); });
      list.check(grains);
      if (!common.wall_elements) own.keep_if([](Id, Id b) { return !is_wall_id(b); });
      set_history(grains, own);
      if (common.laws_and_walls) {  // else it is rebuilt in the next step
        list_.restore_list(list, grains, setup());
      }
    }
  }

  /// restore() undoes all steps since save(), see Simulation::step.
  void save() noexcept { list_.save(); }
  void restore() noexcept {
    list_.restore();
    last_time_step_.reset();
  }

 private:
  using Contacts<Law, Walls...>::materials_;
  using Contacts<Law, Walls...>::walls_;
  using Contacts<Law, Walls...>::settings_;

  static constexpr bool knows_stiffness = detail::KnowsStiffness<Law, dimension, Real>;

  // Used again in every step.
  struct Memory {
    Buffer<std::uint8_t> touching;
    typename detail::SharedGrains<P>::Pools copies;
    typename Loop::Memory loop;
  };

  detail::ContactSetup<Law, WallSet<Walls...>> setup() const { return {materials_, walls_}; }
  ContactsOfStep results_for(const P& grains) const {
    return {grains, materials_, walls_, settings_, list_.last()};
  }
  ContactsOfStep last_step(const P& grains) const {
    list_.keep_input();
    return results_for(grains);
  }

  const detail::RadiusRange<Real>& radii_of(const P& grains) const {
    const auto evaluate = [&] {
      const auto range = detail::radius_range(grains);
      if (!is_finite(2 * range.largest)) detail::check_grains(grains, materials_);
      return range;
    };
    return radii_.get(grains, evaluate, [R = grains.with_halo(radius)](const auto& range, Index i) {
      return range.contains(R[i]);
    });
  }
  detail::ContactReach<Real> contact_reach(const P& grains) const {
    const auto& radii = radii_of(grains);
    return {.largest_radius = radii.largest,
            .gap = detail::largest_gap<dimension>(materials_, radii)};
  }
  const detail::ShortestContacts& shortest_contacts(const P& grains) const {
    // They are evaluated by all processes, or by none.
    const auto hold_for = [&grains](const auto& shortest, Index i) {
      return shortest.hold_for(grains, i);
    };
    if (silt::detail::any_of_all(grains, !shortest_.is_of(grains, hold_for))) shortest_.forget();
    const auto evaluate = [&] {
      if constexpr (knows_stiffness) {
        detail::check_grains(grains, materials_);
        return detail::shortest_contacts(grains, materials_, walls_);
      } else {
        return detail::ShortestContacts{};
      }
    };
    return shortest_.get(grains, evaluate, hold_for);
  }

  // The histories before the step. If they are of contacts of the list before, they are moved to
  // `after`, where those after the step replace them.
  typename Evaluation::Known known_histories(const Evaluation& evaluation, const P& grains,
                                             Histories& after) {
    if (!evaluation.is_of_new_list()) return evaluation.before->known();
    evaluation.move_before_to(after, [&](Id id) { return grains.index_of(id); });
    return after.known_in_place(memory_->touching);
  }

  mutable detail::OfConstants<detail::RadiusRange<Real>> radii_;
  mutable detail::OfConstants<detail::ShortestContacts> shortest_;
  double time_ = 0;                       // from set_time()
  std::optional<double> last_time_step_;  // from set_last_time_step()
  detail::ListOfStep<P, Law, WallSet<Walls...>> list_;
  silt::detail::OwnMemory<Memory> memory_;
};

}  // namespace silt::dem
