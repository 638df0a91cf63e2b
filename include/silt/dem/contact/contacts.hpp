// SPDX-License-Identifier: MIT
// The contact interaction of DEM. In each step it updates the list of near pairs if necessary
// (near_search.hpp), evaluates the law once for each contact (law_pass.hpp), sums the forces on
// each grain in a fixed order (single_contacts.hpp), and checks that the time step is stable
// (stable_time_step.hpp).
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/contacts_of_step.hpp>
#include <silt/dem/contact/law_pass.hpp>
#include <silt/dem/contact/near_search.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/contact/single_contacts.hpp>
#include <silt/dem/contact/stable_time_step.hpp>
#include <silt/dem/contact/touches.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/wall/walls.hpp>

#include <concepts>
#include <limits>
#include <numeric>
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
/// materials. A wall is any type that models dem::Wall. Radii may change only together with
/// particles.revision(). A simulation of grains of type P stores them as a ContactsOf<P, …>; for
/// calls without a simulation see for_particles() in core/concepts.hpp.
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
  using HistoryOfLaw = LawHistory<Law, dimension, Real>;
  using History = typename HistoryOfLaw::type;
  using Found = Touches<dimension, Real, HistoryOfLaw, GivesCouple<Law, dimension, Real>>;
  using OfStep = ContactsOfStep<P, Law, WallSet<Walls...>, Found>;

 public:
  ContactsOf(Contacts<Law, Walls...> contacts)
      : Contacts<Law, Walls...>(std::move(contacts)) {}

  /// A copy with other settings and the same histories. Throws if a setting is out of range.
  ContactsOf with(const ContactSettings& settings) const {
    settings.check();
    ContactsOf contacts = *this;
    contacts.settings_ = settings;
    return contacts;
  }

  /// Interaction range: twice the largest radius [m].
  Real reach(const P& grains) const {
    const auto R = grains[radius];
    return 2 * largest(R.size(), Real(0), [&](Index i) { return R[i]; });
  }

  /// Adds contact forces and torques. Throws if two centres coincide, if a radius, mass or inertia
  /// is not positive, if a material does not exist, or if dt exceeds the stability limit.
  template <class S>
  void accelerate(P& grains, const S& search, double dt) {
    accelerate_all(*this, grains, search, dt);
  }

  /// Sets the time of the positions [s], which determines where moving walls are. Called by
  /// Simulation.
  void set_time(double time) { time_ = time; }

  // accelerate() in stages, see AddsForces in core/concepts.hpp.

  template <class S>
  void prepare(P& grains, const S& search, double dt) {
    const bool stale = is_stale(grains, search, walls_, time_, found_.validity());
    if (stale) check_grains(grains, materials_);
    found_.begin_step({.time = time_, .time_step = dt});
    grains.refresh_ghosts(velocity, spin);
    if (stale) renew_near(grains, search, dt);
    found_.make_room();
    counts_.assign(chunk_count(grains.size()), 0);
  }

  /// Evaluates the law for the contacts that belong to a chunk of grains.
  void interact(const P& grains, Chunk chunk) {
    using Lanes = typename Found::Lanes;
    const Real dt = found_.seen().time_step;
    const auto evaluate = [&, this, dt](Lanes* eights, int count, const unsigned* touching,
                                        const auto* contacts) {
      if constexpr (LawInLanes<Law, dimension, Real>) {
        if (materials_.count() == 1) {
          return evaluate_in_lanes(materials_.between(0, 0), eights, count, dt);
        }
      }
      for (int e = 0; e < count; ++e) {
        for (int lane = 0; lane < lanes; ++lane) {
          if ((touching[e] >> lane & 1) == 0) continue;
          const Index c = contacts[e][static_cast<Index>(lane)];
          eights[e].template evaluate<Real>(law_of(grains)(sides_of(grains, found_.near(), c)), dt,
                                            lane);
        }
      }
    };
    const Real arm_share = settings_.lever_arm == LeverArm::radius ? 0 : Real(0.5);
    const auto walls = walls_as_the_law_saw_them<P>(walls_, found_.seen());
    const LawPass pass(grains, found_, walls, arm_share, evaluate);
    counts_[chunk.number] = pass(found_.near().of_chunk(chunk.number));
  }

  ChunkSpan needs(Chunk chunk) const { return found_.near().of_chunk(chunk.number).needs; }

  /// Adds Σ F and Σ M (14) of grain i, in the order of the partners' ids.
  void add_forces(P& grains, Index i) const { add_rows(grains, found_, i, i + 1); }
  void add_forces(P& grains, Index first, Index last) const {
    add_rows(grains, found_, first, last);
  }

  void conclude(const P& grains, double dt) {
    found_.end_step(std::accumulate(counts_.begin(), counts_.end(), Index(0)));
    if constexpr (knows_stiffness) {
      if (!settings_.check_stability || dt <= found_.validity().stable_time_step) return;
      check_stability(grains, found_, walls_of_step<P>(walls_, found_.seen()), dt, law_of(grains));
    }
  }

  /// Default time step [s]: the shortest contact duration of the lightest grains, divided by
  /// steps_per_contact.
  double time_step(const P& grains) const {
    double shortest = std::numeric_limits<double>::infinity();
    if constexpr (knows_stiffness) shortest = shortest_contact(grains, materials_);
    return shortest / settings_.steps_per_contact;
  }

  /// Number of contacts in the last step, including those with walls.
  Index size() const noexcept { return found_.seen().count; }

  // Results of the last step, see ContactsOfStep.

  /// f(i, j, contact, force on i) for every contact of the last step whose grains still exist; i
  /// and j are the current indices of the two (owned particles), j is `no_index` for a wall. The
  /// contact's velocity is computed from the velocities in `grains`, and for a wall from its
  /// velocity at the time N of the contact.
  template <class F>
  void for_each_contact(const P& grains, F&& f) const {
    of_step(grains).for_each(f);
  }

  /// f(WallContact) for every contact of the last step between a wall and a grain that still
  /// exists.
  template <class F>
  void for_each_wall_contact(const P& grains, F&& f) const {
    of_step(grains).for_each_at_walls(f);
  }

  /// Load on a wall, given by its number, in the last step; the torque is about the point `about`
  /// [m]. Bitwise identical for any number of threads. Throws if there is no such wall.
  auto load_on(const P& grains, Index wall, const typename P::Vec& about = P::Vec::Zero()) const {
    return of_step(grains).load_on(wall, about);
  }

  /// f(EvaluatedContact) for every contact of the last step, with the law evaluated again on the
  /// same input. `before` are the grains, with their velocities, at the beginning of that step.
  /// Must not be called after save().
  template <class F>
  void for_each_evaluated_contact(const P& before, F&& f) const {
    of_step(before).for_each_evaluated_contact(f);
  }

  /// The law returns the components of its force and the energy in its springs.
  static constexpr bool gives_spring_energy = OfStep::gives_spring_energy;

  /// Energy in the springs of the last step's contacts [J]; 0 for a law without elastic_energy().
  double elastic_energy(const P& grains) const {
    return of_step(grains).elastic_energy();
  }

  /// The history of all contacts, by pairs of ids; for a checkpoint.
  auto history(const P& grains) const {
    return of_step(grains).history();
  }

  /// Replaces the history; for resuming from a checkpoint.
  void set_history(const P&, const PairHistory<History>& history) { found_.set_history(history); }

  /// Writes or reads the history for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive, const P& grains) {
    auto own = history(grains);
    archive.within("history", [&] { own.transfer(archive); });
    if constexpr (Archive::reads) set_history(grains, own);
  }

  void save() noexcept { found_.save(); }
  void restore() noexcept { found_.restore(); }

 private:
  using Contacts<Law, Walls...>::materials_;
  using Contacts<Law, Walls...>::walls_;
  using Contacts<Law, Walls...>::settings_;

  static constexpr bool knows_stiffness =
      requires(const Law law, const Contact<dimension, Real> c) {
        { law.stiffness(c) } -> std::convertible_to<Stiffness>;
      };

  OfStep of_step(const P& grains) const { return {grains, materials_, walls_, found_}; }

  template <class S>
  void renew_near(const P& grains, const S& search, double dt) {
    found_.renew_near([&](NearContacts& near, auto& found, auto& validity) {
      const typename Found::Step step{.time = time_, .time_step = dt};
      renew_validity(grains, search, walls_, step, reach(grains), validity);
      const auto walls = walls_of_step<P>(walls_, found_.seen());
      find_near(grains, search, walls, validity.margin, near, found);
      if constexpr (knows_stiffness) {
        validity.stable_time_step =
            stable_for_all(grains, near, walls, validity.margin, law_of(grains));
      }
    });
  }

  // law(sides) of a near contact.
  auto law_of(const P& grains) const {
    return [&grains, this](const Sides& sides) -> const Law& {
      return law_between(grains, sides, materials_, walls_);
    };
  }

  double time_ = 0;  // from set_time()
  Found found_;
  std::vector<Index> counts_;  // by chunk
};

}  // namespace silt::dem
