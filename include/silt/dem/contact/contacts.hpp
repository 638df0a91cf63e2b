// SPDX-License-Identifier: MIT
// The contact interaction of DEM. In each step it rebuilds the list of contacts if necessary
// (list_renewal.hpp), evaluates the law once for each contact (contact_kernel.hpp), sums the forces
// on each grain in a fixed order (load_rows.hpp), and checks that the time step is stable
// (stable_time_step.hpp).
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_kernel.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/contacts_of_step.hpp>
#include <silt/dem/contact/evaluation.hpp>
#include <silt/dem/contact/law_evaluation.hpp>
#include <silt/dem/contact/list_renewal.hpp>
#include <silt/dem/contact/load_rows.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/contact/saved_list.hpp>
#include <silt/dem/contact/stable_time_step.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/wall/walls.hpp>

#include <algorithm>
#include <concepts>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

/// Throws if a radius, mass or inertia is not positive, or if a grain's material does not exist.
template <class P, class Law>
void check_grains(const P& grains, const Materials<Law>& materials) {
  const auto R = grains[radius];
  const auto m = grains[mass];
  const auto inertias = grains[inertia];
  const auto numbers = grains[material];
  const Index odd = first_where(grains.size(), [&](Index i) {
    return !(R[i] > 0 && m[i] > 0 && inertias[i] > 0 && numbers[i] < materials.count());
  });
  if (odd == no_index) return;
  const Where where{.particle = odd, .id = grains.id(odd)};
  materials.check(numbers[odd], "of a grain", where);
  fail("dem::Contacts: radius = " + to_text(double(R[odd])) + " m, mass = " +
           to_text(double(m[odd])) + " kg and inertia = " + to_text(double(inertias[odd])) +
           " kg m² of a grain must be positive; set them",
       where);
}

template <class P, class Law, class... Walls>
class ContactsOf;

/// Contacts between grains, and between grains and walls, with one law or one per pair of
/// materials. A wall is any type that models dem::Wall. A simulation of grains of type P stores
/// them as a ContactsOf<P, …>; for calls without a simulation see for_particles() in
/// core/concepts.hpp.
template <class Law, class... Walls>
class Contacts {
 public:
  /// Throws if a parameter of the law or of a wall is out of range.
  explicit Contacts(Law law, Walls... walls) : Contacts(Materials<Law>{law}, std::move(walls)...) {}
  explicit Contacts(Materials<Law> materials, Walls... walls)
      : materials_(std::move(materials)), walls_(std::move(walls)...) {
    for (Index w = 0; w < walls_.size(); ++w) {
      materials_.check(walls_.material(w), "of wall " + std::to_string(w));
    }
  }

  /// A copy with other settings. Throws if a setting is out of range.
  Contacts with(const ContactSettings& settings) const {
    settings.check();
    Contacts contacts = *this;
    contacts.settings_ = settings;
    return contacts;
  }

  /// Fails to compile, with a readable message, for particles that these contacts cannot act on.
  template <class P>
  static constexpr void explain() {
    static_assert(HasFields<P, velocity_t, spin_t, force_t, torque_t, mass_t, inertia_t, radius_t,
                            material_t>,
                  "silt::dem::Contacts: these particles lack a field of dem::Grains");
    static_assert(in_rows_with_radius<P>(),
                  "silt::dem::Contacts: these particles are not stored as dem::Grains; use "
                  "dem::Grains<Dim, Real, further_fields…>");
    static_assert(ContactLaw<Law, P::dimension, typename P::Real>,
                  "silt::dem::Contacts: the law has neither force(contact) nor force(contact, "
                  "history) that returns a vector, nor components() instead (see ContactLaw in "
                  "silt/dem/law/contact.hpp)");
    static_assert((Wall<Walls, P::dimension, typename P::Real> && ...),
                  "silt::dem::Contacts: a wall lacks nearest(x), material or check(), or has "
                  "another dimension or precision (see silt/dem/wall/wall.hpp), or its motion is "
                  "not a WallMotion (see silt/dem/wall/moving.hpp)");
  }

  // See ForParticles in core/concepts.hpp.
  using Description = Contacts;
  template <class P>
    requires HasFields<P, velocity_t, spin_t, force_t, torque_t, mass_t, inertia_t, radius_t,
                       material_t> &&
                 ContactLaw<Law, P::dimension, typename P::Real> &&
                 (Wall<Walls, P::dimension, typename P::Real> && ...)
  using For = ContactsOf<P, Law, Walls...>;

 protected:
  Materials<Law> materials_;
  WallSet<Walls...> walls_;
  ContactSettings settings_;
};

/// Contacts of grains of type P; see Contacts.
template <class P, class Law, class... Walls>
class ContactsOf : public Contacts<Law, Walls...> {
  using Real = typename P::Real;
  static constexpr int dimension = P::dimension;
  using Kept = LawHistory<Law, dimension, Real>;
  using History = typename Kept::type;
  static constexpr bool has_couple = GivesCouple<Law, dimension, Real>;
  using Evaluation = dem::Evaluation<P, Kept, has_couple>;
  using List = typename Evaluation::List;
  using Histories = typename Evaluation::Histories;
  using LastStep = ContactsOfStep<P, Law, WallSet<Walls...>>;

 public:
  ContactsOf(Contacts<Law, Walls...> contacts) : Contacts<Law, Walls...>(std::move(contacts)) {}

  /// A copy with other settings and the same histories. Throws if a setting is out of range.
  ContactsOf with(const ContactSettings& settings) const {
    settings.check();
    ContactsOf contacts = *this;
    contacts.settings_ = settings;
    return contacts;
  }

  /// Interaction range: twice the largest radius [m].
  Real reach(const P& grains) const {
    if (reach_.revision != grains.constants_revision()) {
      const auto R = grains[radius];
      reach_.revision = grains.constants_revision();
      reach_.value = 2 * largest(R.size(), Real(0), [&](Index i) { return R[i]; });
    }
    return reach_.value;
  }

  /// Whether the list of contacts has to be rebuilt, for which the search is used. The next
  /// evaluation is for the grains as they are at this call.
  bool needs_search(const P& grains) const {
    is_rebuild_announced_ =
        state_.given != nullptr || have_constants_changed(grains) || is_stale(grains);
    return *is_rebuild_announced_;
  }

  /// Adds contact forces and torques. Throws if two centres coincide, if a radius, mass or inertia
  /// is not positive, if a material does not exist, or if dt exceeds the stability limit.
  template <class S>
  void accelerate(P& grains, const S& search, double dt) {
    constexpr auto nothing = [](Index, Index) {};
    accelerate(grains, search, dt, Pass{nothing, nothing});
  }

  /// The same in one pass over the grains, see AcceleratesInPass in core/concepts.hpp: block by
  /// block, the law is evaluated for all contacts, then the forces on each grain are summed.
  template <class S, class Before, class After>
  void accelerate(P& grains, const S& search, double dt, const Pass<Before, After>& pass) {
    Evaluation step = begin_step(grains, search, {.time = time_, .time_step = dt});
    const auto after = memory_.histories.take();
    after->resize(step.contacts().groups());
    memory_.division.fit(step.contacts(), step.list.get(),
                         static_cast<Index>(threads_for(grains.size())));
    memory_.loads.resize(memory_.division.slots());
    step.count = process_blocks(grains, step, *after, pass);
    step.after = after;
    step.grains = SharedGrains<P>(grains, memory_.copies);
    if constexpr (knows_stiffness) {
      if (settings_.check_stability && dt > step.list->stable_time_step) {
        check_stability(grains, LastStep(grains, materials_, walls_, settings_, step), dt);
      }
    }
    state_.last = std::move(step);
    state_.given.reset();
  }

  /// Sets the time of the positions [s], which determines where moving walls are. Called by
  /// Simulation.
  void set_time(double time) { time_ = time; }

  /// Default time step [s]: the shortest contact duration of the lightest grains, divided by
  /// steps_per_contact.
  double time_step(const P& grains) const {
    double shortest = std::numeric_limits<double>::infinity();
    if constexpr (knows_stiffness) shortest = shortest_contact(grains, materials_);
    return shortest / settings_.steps_per_contact;
  }

  /// Number of contacts in the last step, including those with walls.
  Index size() const noexcept { return state_.last.count; }

  // Results of the last step, see ContactsOfStep.

  /// f(i, j, contact, force on i) for every contact of the last step whose grains still exist; i
  /// and j are the current indices of the two (owned particles), j is `no_index` for a wall. The
  /// contact's velocity is computed from the velocities in `grains`, and for a wall from its
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
  /// [m]. Bitwise identical for any number of threads. Throws if there is no such wall.
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
  static constexpr bool gives_spring_energy = LastStep::gives_spring_energy;

  /// Energy in the springs of the last step's contacts [J]; 0 for a law without elastic_energy().
  double elastic_energy(const P& grains) const { return last_step(grains).elastic_energy(); }

  /// The history of all contacts, by pairs of ids; for a checkpoint.
  PairHistory<History> history(const P& grains) const {
    return state_.given ? *state_.given : last_step(grains).history();
  }

  /// Replaces the history; for resuming from a checkpoint.
  void set_history(const P&, const PairHistory<History>& history) {
    state_.given = std::make_shared<const PairHistory<History>>(history);
  }

  /// Writes or reads the histories and the list for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive, const P& grains) {
    auto own = history(grains);
    auto list = saved_list(grains);
    archive.within("history", [&] { own.transfer(archive); });
    archive.within("list", [&] { list.transfer(archive); });
    if constexpr (Archive::reads) {
      set_history(grains, own);
      restore_list(list, grains);
    }
  }

  void save() noexcept { saved_ = state_; }
  void restore() noexcept {
    state_ = saved_;
    is_rebuild_announced_.reset();
  }

 private:
  using Contacts<Law, Walls...>::materials_;
  using Contacts<Law, Walls...>::walls_;
  using Contacts<Law, Walls...>::settings_;

  static constexpr bool knows_stiffness =
      requires(const Law law, const Contact<dimension, Real> c) {
        { law.stiffness(c) } -> std::convertible_to<Stiffness>;
      };

  // Replaced, not changed, by every step.
  struct State {
    Evaluation last;
    std::shared_ptr<const PairHistory<History>> given;  // by set_history(), until the next step
  };
  // Used again in every step; a copy is empty.
  struct Memory {
    Memory() = default;
    Memory(Memory&&) = default;
    Memory& operator=(Memory&&) = default;
    Memory(const Memory&) {}
    Memory& operator=(const Memory&) {
      division.reset();
      return *this;
    }

    Pool<List> lists;
    Pool<Histories> histories;
    typename SharedGrains<P>::Pools copies;
    WorkDivision division;
    LoadRows<dimension, Real, has_couple> loads;
    std::vector<ContactList::Found> found;
    std::vector<char> is_dense;  // by block, from the last step
  };

  bool have_constants_changed(const P& grains) const {
    return detail::have_constants_changed(grains, *state_.last.list,
                                          state_.last.lifetime.constants_revision);
  }
  bool is_stale(const P& grains) const {
    return dem::is_stale(grains, walls_, time_, *state_.last.list, state_.last.lifetime);
  }

  LastStep last_step(const P& grains) const {
    return {grains, materials_, walls_, settings_, state_.last};
  }

  // An evaluation with the list and the histories before it.
  template <class S>
  Evaluation begin_step(P& grains, const S& search, const StepTime& time) {
    Evaluation step;
    step.step = time;
    step.box = grains.box();
    // Other parts of Forces may have had access to the masses since needs_search(); a rebuild then
    // has to wait for the next step, as the search has not been updated.
    const bool may_rebuild = is_rebuild_announced_.value_or(true);
    const bool rebuilds = may_rebuild ? needs_search(grains) : is_stale(grains);
    is_rebuild_announced_.reset();
    if (rebuilds) {
      check_grains(grains, materials_);
      const auto list = memory_.lists.take();
      memory_.division.reset();
      renew(grains, search, time, *list);
      step.lifetime = {.since = grains.travel(),
                       .distance = double(list->margin / 2),
                       .constants_revision = grains.constants_revision()};
      const auto before = memory_.histories.take();
      move_histories(grains, list->contacts, *before);
      step.list = list;
      step.before = before;
    } else {
      step.list = state_.last.list;
      step.lifetime = state_.last.lifetime;
      step.before = state_.last.after;
    }
    return step;
  }

  template <class S>
  void renew(const P& grains, const S& search, const StepTime& step, List& list) {
    begin_list(grains, search, walls_, step, reach(grains), list);
    const auto walls = walls_at<P>(walls_, step);
    find_contacts(grains, search, walls, list, memory_.found);
    if constexpr (knows_stiffness) {
      list.stable_time_step = stable_for_all(
          grains, list.contacts, walls, list.margin,
          [&](Index c) -> const Law& { return law_between(list, materials_, walls_, c); });
    }
  }

  // Fills in the histories that contacts of a new list had in the last step.
  void move_histories(const P& grains, const ContactList& list, Histories& to) const {
    to.resize(list.groups());
    to.clear();
    const auto for_each_contact_of = [](const ContactList& contacts, auto&& f) {
      contacts.for_each_block(
          [&](Index block, Index, Index) { contacts.for_each_contact(block, f); });
    };
    if (state_.given) {
      return for_each_contact_of(list, [&](Index c) {
        const auto* const known = state_.given->find(list.first_id(c), list.second_id(c));
        if (known != nullptr) to.set(c, *known);
      });
    }
    const ContactList& last = state_.last.contacts();
    const Histories& from = *state_.last.after;
    for_each_contact_of(last, [&](Index c) {
      if (!from.touches(c)) return;
      const Index found = list.find(last.first_id(c), last.second_id(c),
                                    [&](Id id) { return grains.index_of(id); });
      if (found != no_index) to.set(found, from.of(c));
    });
  }

  // The list of the last step, if it is of the grains as they are.
  SavedList<dimension, Real> saved_list(const P& grains) const {
    const List& last = *state_.last.list;
    const bool is_of_these = !state_.given && last.owned_revision == grains.owned_revision() &&
                             !have_constants_changed(grains);
    return is_of_these ? SavedList<dimension, Real>(last) : SavedList<dimension, Real>();
  }
  void restore_list(const SavedList<dimension, Real>& saved, const P& grains) {
    if (!saved.fits(grains, walls_.elements())) return;  // it is rebuilt in the next step
    const auto list = memory_.lists.take();
    memory_.division.reset();
    saved.restore(grains, *list, memory_.found);
    const auto histories = memory_.histories.take();
    move_histories(grains, list->contacts, *histories);
    Evaluation last;
    last.list = list;
    last.before = last.after = histories;
    state_.last = std::move(last);
    state_.given.reset();
  }

  // Evaluates all contacts and sums the forces. Returns how many touch.
  template <class Before, class After>
  Index process_blocks(P& grains, const Evaluation& step, Histories& after,
                       const Pass<Before, After>& pass) {
    const ContactList& list = step.contacts();
    const WorkDivision& division = memory_.division;
    const auto walls = walls_in_law<P>(walls_, step.step);
    const auto evaluate = law_evaluation<P>(step, materials_, walls_);
    const auto kernel = contact_kernel<P>(step, GrainRows<dimension, Real>(std::as_const(grains)),
                                          walls, settings_, evaluate);
    const auto add = [&](Index first, Index last) {
      pass.before(first, last);
      memory_.loads.add_to(grains, list, division, first, last);
      pass.after(first, last);
    };
    std::vector<Index> counts(division.threads(), 0);
    memory_.is_dense.resize(list.blocks(), false);
    for_each_task(division.threads(), [&](Index thread) {
      ResultsOfStep results{memory_.loads, division, after};
      for (Index b = division.first_block(thread); b < division.first_block(thread + 1); ++b) {
        const Index touching = kernel(b, memory_.is_dense[b] != 0, results);
        memory_.is_dense[b] = kernel.is_dense(b, touching);
        counts[thread] += touching;
        const Index end = std::min(grains.size(), (b + 1) * block_size);
        for_each_ready(division, b * block_size, end, add);
      }
    });
    for_each_task(division.threads(), [&](Index thread) {
      division.for_each_waiting(thread, [&](Index i) { add(i, i + 1); });
    });
    return std::accumulate(counts.begin(), counts.end(), Index(0));
  }

  // f(first, last) for short ranges of the grains of [first, last) that do not wait.
  template <class F>
  static void for_each_ready(const WorkDivision& division, Index first, Index last, F&& f) {
    while (first < last) {
      if (division.waits(first)) {
        ++first;
        continue;
      }
      Index end = first + 1;
      while (end < last && end < first + range_size && !division.waits(end)) ++end;
      f(first, end);
      first = end;
    }
  }

  // Where the results of a step go.
  struct ResultsOfStep {
    LoadRows<dimension, Real, has_couple>& loads;
    const WorkDivision& division;
    Histories& histories;

    void begin(Index group, unsigned touching, bool is_whole) {
      histories.set_touching_in_group(group, touching);
      if (!is_whole) loads.clear(division.slot_of(group));
    }
    template <class Lanes>
    void give_group(Index group, const Lanes& eight, unsigned touching) {
      loads.store(division.slot_of(group), eight, touching);
      std::memcpy(histories.group(group), eight.history, sizeof(Real) * Lanes::words * lanes);
    }
    template <class Lanes>
    void give(const EightNumbers& contacts, Index count, const Lanes& eight) {
      loads.store(eight, count, [&](Index lane) {
        return std::pair(division.slot_of(contacts[lane] / lanes), Index{contacts[lane] % lanes});
      });
      for (Index lane = 0; lane < count; ++lane) {
        for (int k = 0; k < Lanes::words; ++k) {
          histories.at(contacts[lane], k) = eight.history[k][lane];
        }
      }
    }
  };

  struct Reach {
    std::uint64_t revision = 0;
    Real value = 0;
  };
  mutable Reach reach_;
  mutable std::optional<bool> is_rebuild_announced_;  // by needs_search(), for the next evaluation
  double time_ = 0;                                   // from set_time()
  State state_;
  State saved_;
  Memory memory_;
};

}  // namespace silt::dem
