// SPDX-License-Identifier: MIT
// Access to the contacts of the last step for observers, measurements and the energy ledger.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/id_table.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/block_evaluator.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/evaluation.hpp>
#include <silt/dem/contact/law_between.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/contact/single_contacts.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/dem/wall/wall.hpp>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace silt::dem::detail {

/// Energy of the springs of all contacts, without that of adhesion, which no spring holds [J].
struct ContactEnergy {
  double stored = 0;  ///< at the time of the forces
  /// By springs and dashpots on the grains in the step, relative to the walls, without attraction.
  double work = 0;
  /// By the motion of walls on the grains in the step, through the same forces: below 0 if walls
  /// give way.
  double work_of_walls = 0;
};

/// View of the last step of Contacts, limited to contacts whose grains still exist. `grains` may be
/// those before or after that step; the velocities of contacts are computed from theirs. Walls is a
/// WallSet.
template <class P, class Law, class Walls>
class ContactsOfStep {
  using Real = typename P::Real;
  using Vec = typename P::Vec;
  using Contact = dem::Contact<P::dimension, Real>;
  using Evaluation = detail::Evaluation<P, Law>;
  using LawHistory = typename Evaluation::LawHistory;
  using Histories = typename Evaluation::Histories;
  using Row = typename Evaluation::Lanes::Row;

 public:
  ContactsOfStep(const P& grains, const Materials<Law>& materials, const Walls& walls,
                 const ContactSettings& settings, const Evaluation& evaluation)
      : grains_(grains),
        materials_(materials),
        walls_(walls),
        settings_(settings),
        evaluation_(evaluation) {}

  /// See Contacts::for_each_contact.
  template <class F>
  void for_each(F&& f) const {
    const auto walls = walls_then();
    for_each_of_own([&](Index, const auto& bodies, const Real* row) {
      f(bodies.i, bodies.j, contact_at(row, bodies, walls),
        Row::template force_in<P::dimension>(row));
    });
  }

  /// See Contacts::for_each_wall_contact.
  template <class F>
  void for_each_at_walls(F&& f) const {
    const auto walls = walls_then();
    for_each_of_own([&](Index, const auto& bodies, const Real* row) {
      if (bodies.wall == no_index) return;
      WallContact<P::dimension, Real> touch;
      touch.grain = bodies.i;
      touch.wall = walls_.number_of(bodies.wall);
      touch.point = contact_point<P, Row>(grains_, row, bodies);
      const auto velocity = walls.velocity(bodies.wall);
      touch.velocity = velocity.at(touch.point);
      touch.spin = velocity.spin;
      touch.force = -Row::template force_in<P::dimension>(row);
      touch.couple = -Row::template couple_in<P::dimension>(row);
      f(touch);
    });
  }

  /// See Contacts::load_on.
  WallLoad<P::dimension, Real> load_on(Index wall, const Vec& about) const {
    walls_.check_number(wall);
    require_finite("dem::Contacts: about", about);
    WallLoad<P::dimension, Real> load;
    for_each_at_walls([&](const auto& touch) {
      if (touch.wall != wall) return;
      load.force += touch.force;
      load.torque += cross(Vec(touch.point - about), touch.force) + touch.couple;
    });
    return load_of_all(load);
  }

  /// See ContactEnergy. `mean` are the grains with the mean velocities of the step, those of this
  /// view have the velocities at its beginning. For a law with knows_springs.
  [[gnu::cold]] ContactEnergy energy(const P& mean) const {
    ContactEnergy energy;
    const auto walls = walls_then();
    const auto walls_of_law = walls_in_law<P>(walls_, evaluation_.step);
    const double duration = evaluation_.step.between_velocities();
    for_each_of_own([&](Index c, const auto& bodies, const Real* row) {
      const auto contact = contact_at(row, bodies, walls_of_law);
      const ElasticEnergies elastic = elastic_energies(law_of(c), contact, c);
      energy.stored += std::max(0.0, elastic.normal + elastic.tangential + elastic.rolling);
      const auto answer = answer_of(contact, c);
      const auto motion = contact_of<Row>(mean, row, bodies, walls, evaluation_.step);
      const auto repulsion = std::max(Real(0), answer.normal_spring + answer.normal_dashpot);
      const Vec force =
          repulsion * contact.normal + answer.tangential_spring + answer.tangential_dashpot;
      const auto couple = couple_of(answer);
      energy.work += duration * double(force.dot(motion.relative_velocity) +
                                       dot(couple, motion.relative_spin));
      if (bodies.wall == no_index) return;
      const auto wall = walls.velocity(bodies.wall);
      energy.work_of_walls +=
          duration * double(force.dot(wall.at(contact_point<P, Row>(grains_, row, bodies))) +
                            dot(couple, wall.spin));
    });
    return energy;
  }

  /// See Contacts::for_each_evaluated_contact.
  template <class F>
  void for_each_evaluated_contact(F&& f) const {
    const auto walls = walls_then();
    const auto walls_of_law = walls_in_law<P>(walls_, evaluation_.step);
    for_each_of_own([&](Index c, const auto& bodies, const Real* row) {
      const auto contact = contact_at(row, bodies, walls_of_law);
      RigidVelocity<P::dimension, Real> wall;
      if (bodies.wall != no_index) wall = walls.velocity(bodies.wall);
      f(EvaluatedContact<P::dimension, Real, decltype(answer_of(contact, c))>{
          .bodies = bodies,
          .first = evaluation_.contacts().first_id(c),
          .second = evaluation_.contacts().second_id(c),
          .contact = contact,
          .arm_reduction = row[Row::arm_reduction],
          .answer = answer_of(contact, c),
          .wall_velocity = wall.at(contact_point<P, Row>(grains_, row, bodies)),
          .wall_spin = wall.spin,
          .elastic = elastic_energies(law_of(c), contact, c)});
    });
  }

  /// The law returns the components of its force and the energy in its springs.
  static constexpr bool gives_spring_energy =
      GivesComponents<Law, P::dimension, Real> &&
      requires(const Law law, const Contact c, const typename LawHistory::type history) {
        law.elastic_energies(c, history);
      };
  /// These are all springs but those of adhesion.
  static constexpr bool knows_springs = gives_spring_energy && [] {
    if constexpr (requires { Law::template knows_springs<Contact>; }) {
      return Law::template knows_springs<Contact>;
    } else {
      return true;
    }
  }();

  /// See Contacts::elastic_energy.
  double elastic_energy() const {
    double energy = 0;
    if constexpr (GivesEnergy<Law, P::dimension, Real>) {
      const auto walls = walls_then();
      for_each_of_own([&](Index c, const auto& bodies, const Real* row) {
        energy += double(
            law_of(c).elastic_energy(contact_at(row, bodies, walls), evaluation_.after->of(c)));
      });
    }
    return silt::detail::sum_of_all(grains_, energy);
  }

  /// See Contacts::history.
  auto history() const {
    using Table = PairHistory<typename LawHistory::type>;
    std::vector<typename Table::Entry> entries;
    for_each_in_order([&](Index c, const ContactBodies&) {
      const ContactList& list = evaluation_.contacts();
      entries.push_back({list.first_id(c), list.second_id(c), evaluation_.after->of(c)});
    });
    return Table(std::move(entries));
  }

  /// f(c, bodies, contact, stiffness, arm_reduction) for every contact, with the velocities of
  /// walls at the time N of the contacts.
  template <class F>
  void for_each_stiffness(F&& f) const {
    const auto walls = walls_then();
    for_each_with_row([&](Index c, const auto& bodies, const Real* row) {
      const auto contact = contact_at(row, bodies, walls);
      f(c, bodies, contact, law_of(c).stiffness(contact), row[Row::arm_reduction]);
    });
  }
  const ContactList& list() const { return evaluation_.contacts(); }

 private:
  // Of all processes.
  WallLoad<P::dimension, Real> load_of_all(WallLoad<P::dimension, Real> load) const {
    for (int k = 0; k < P::dimension; ++k) {
      load.force[k] = Real(silt::detail::sum_of_all(grains_, double(load.force[k])));
    }
    for (int k = 0; k < angular_size<P::dimension>; ++k) {
      Real& torque = component(load.torque, k);
      torque = Real(silt::detail::sum_of_all(grains_, double(torque)));
    }
    return load;
  }

  const Law& law_of(Index c) const { return law_between(*evaluation_.list, materials_, walls_, c); }

  auto walls_then() const { return walls_at<P>(walls_, evaluation_.step); }

  Contact contact_at(const Real* row, const ContactBodies& bodies, const auto& walls) const {
    return contact_of<Row>(grains_, row, bodies, walls, evaluation_.step);
  }

  // The result of the law for contact c, from its history before the step.
  auto answer_of(const Contact& contact, Index c) const {
    if constexpr (LawHistory::words == 0) {
      return evaluate_law(law_of(c), contact);
    } else {
      auto own = before().of(c);
      return evaluate_law(law_of(c), contact, own);
    }
  }

  ElasticEnergies elastic_energies(const Law& law, const Contact& contact, Index c) const {
    if constexpr (gives_spring_energy) {
      return law.elastic_energies(contact, evaluation_.after->of(c));
    } else {
      return {};
    }
  }

  // f(c, bodies) for every contact of the step whose grains still exist. They are visited in the
  // order of the grains in memory, those of a grain in the order of the partners' ids, so that sums
  // do not depend on when the list was built.
  void for_each_in_order(FunctionRef<void(Index, const ContactBodies&)> f) const {
    const ContactList& list = evaluation_.contacts();
    list.for_each_contact_by_grain([&](Index c) {
      if (!evaluation_.after->touches(c)) return;
      const bool at_wall = list.is_of_wall(c);
      const ContactBodies bodies{.i = grains_.index_of(list.first_id(c)),
                                 .j = at_wall ? no_index : grains_.index_of(list.second_id(c)),
                                 .wall = at_wall ? list.second(c) : no_index};
      if (bodies.i != no_index && (at_wall || bodies.j != no_index)) f(c, bodies);
    });
  }
  // The same for each contact in one process only, the one that owns the grain with the lower id.
  template <class F>
  void for_each_of_own(F&& f) const {
    for_each_with_row([&](Index c, const ContactBodies& bodies, const Real* row) {
      if (bodies.i < grains_.size()) f(c, bodies, row);
    });
  }
  // f(c, bodies, row) for all of them; the rows are computed again.
  void for_each_with_row(FunctionRef<void(Index, const ContactBodies&, const Real*)> f) const {
    if (evaluation_.count == 0) return;
    if (!evaluation_.is_repeatable()) {
      fail(
          "dem::Contacts: the contacts of the step before a failed one are unknown, because they "
          "had not been asked for in any step before; use those of Simulation::state()");
    }
    Buffer<Real> rows(evaluation_.contacts().size() * Row::words);
    evaluate_again(rows.data());
    for_each_in_order(
        [&](Index c, const ContactBodies& bodies) { f(c, bodies, rows.data() + c * Row::words); });
  }

  // The histories before the step. Those of contacts of a list before are moved once more; by the
  // ids of the list, because grains may have been sorted since.
  const Histories& before() const {
    if (!evaluation_.is_of_new_list()) return *evaluation_.before;
    if (!moved_) {
      const auto ids = evaluation_.contacts().ids();
      const Id last = ids.empty() ? 0 : *std::max_element(ids.begin(), ids.end());
      const silt::detail::IdTable table(ids, last + 1);
      evaluation_.move_before_to(moved_.emplace(),
                                 [&](Id id) { return id > last ? no_index : table.find(id, ids); });
    }
    return *moved_;
  }

  void evaluate_again(Real* rows) const {
    const BlockInput<P, Law, Walls> input(evaluation_, before().known(), evaluation_.grains.rows(),
                                          materials_, walls_, settings_);
    const auto evaluate = [&](Index block) { evaluate_block(input, block, true, {.rows = rows}); };
    const ContactList& list = evaluation_.contacts();
    list.for_each_block([&](Index block, Index, Index) { evaluate(block); });
    for (Index k = 0; k < evaluation_.added_blocks; ++k) evaluate(list.blocks() + k);
  }

  const P& grains_;
  const Materials<Law>& materials_;
  const Walls& walls_;
  const ContactSettings& settings_;
  const Evaluation& evaluation_;
  mutable std::optional<Histories> moved_;  // see before()
};

}  // namespace silt::dem::detail
