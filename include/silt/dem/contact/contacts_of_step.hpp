// SPDX-License-Identifier: MIT
// Access to the contacts of the last step for observers, measurements and the energy ledger.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/contact/single_contacts.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/dem/wall/wall_load.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

/// The law between the two sides of a contact. Throws if a material does not exist.
template <class P, class Law, class Walls>
const Law& law_between(const P& grains, const Sides& sides, const Materials<Law>& materials,
                       const Walls& walls) {
  const std::uint32_t other =
      sides.j != no_index ? grains[material][sides.j] : walls.material(walls.number_of(sides.wall));
  const std::uint32_t own = grains[material][sides.i];
  materials.check(std::max(own, other), "of a grain",
                  {.particle = sides.i, .id = grains.id(sides.i)});
  return materials.between(own, other);
}

/// The walls of a WallSet at the time N of the step's contacts.
template <class P, class Walls, class Seen>
auto walls_of_step(const Walls& walls, const Seen& seen) {
  return walls.template at<P::dimension, typename P::Real>(
      {.positions = seen.time, .velocities = seen.time});
}
/// The same with the velocities of N − ½, as used by the law.
template <class P, class Walls, class Seen>
auto walls_as_the_law_saw_them(const Walls& walls, const Seen& seen) {
  return walls.template at<P::dimension, typename P::Real>(
      {.positions = seen.time, .velocities = seen.time - double(seen.time_step) / 2});
}

/// View of the last step of Contacts, limited to contacts whose grains still exist. `grains` may be
/// those before or after that step; the velocities of contacts are computed from theirs. Walls is a
/// WallSet.
template <class P, class Law, class Walls, class T>
class ContactsOfStep {
  using Real = typename P::Real;
  using Vec = typename P::Vec;
  using Row = typename T::Row;
  using History = LawHistory<Law, P::dimension, Real>;
  using Contact = dem::Contact<P::dimension, Real>;

 public:
  ContactsOfStep(const P& grains, const Materials<Law>& materials, const Walls& walls,
                 const T& touches)
      : grains_(grains), materials_(materials), walls_(walls), touches_(touches) {}

  /// See Contacts::for_each_contact.
  template <class F>
  void for_each(F&& f) const {
    const auto walls = walls_then();
    for_each_touch(grains_, touches_, [&](Index, const Sides& sides, const auto* row) {
      f(sides.i, sides.j, contact_of(grains_, touches_.seen(), row, sides, walls),
        Row::template force_in<P::dimension>(row));
    });
  }

  /// See Contacts::for_each_wall_contact.
  template <class F>
  void for_each_at_walls(F&& f) const {
    const auto walls = walls_then();
    for_each_touch(grains_, touches_, [&](Index, const Sides& sides, const auto* row) {
      if (sides.wall == no_index) return;
      WallContact<P::dimension, Real> touch;
      touch.grain = sides.i;
      touch.wall = walls_.number_of(sides.wall);
      touch.point = contact_point<P, Row>(grains_, row, sides);
      const auto velocity = walls.velocity(sides.wall);
      touch.velocity = velocity.at(touch.point);
      touch.spin = velocity.spin;
      touch.force = -Row::template force_in<P::dimension>(row);
      touch.couple = -Row::template couple_in<P::dimension>(row);
      f(touch);
    });
  }

  /// See Contacts::load_on.
  WallLoad<P::dimension, Real> load_on(Index wall, const Vec& about) const {
    if (wall >= walls_.size()) {
      fail("dem::Contacts: there is no wall " + std::to_string(wall) + "; give a number below " +
           std::to_string(walls_.size()));
    }
    WallLoad<P::dimension, Real> load;
    for_each_at_walls([&](const auto& touch) {
      if (touch.wall != wall) return;
      load.force += touch.force;
      load.torque += cross(Vec(touch.point - about), touch.force) + touch.couple;
    });
    return load;
  }

  /// See Contacts::for_each_evaluated_contact.
  template <class F>
  void for_each_evaluated_contact(F&& f) const {
    const auto histories = touches_.histories_before();
    const auto walls = walls_then();
    const auto walls_seen = walls_as_the_law_saw_them<P>(walls_, touches_.seen());
    for_each_touch(grains_, touches_, [&](Index c, const Sides& sides, const auto* row) {
      const Law& law = law_of(sides);
      const auto contact = contact_of(grains_, touches_.seen(), row, sides, walls_seen);
      RigidVelocity<P::dimension, Real> wall;
      if (sides.wall != no_index) wall = walls.velocity(sides.wall);
      const auto ask = [&] {
        if constexpr (History::words == 0) {
          return evaluate_law(law, contact);
        } else {
          auto own = History::from(histories.of(c));
          return evaluate_law(law, contact, own);
        }
      };
      f(EvaluatedContact<P::dimension, Real, decltype(ask())>{
          .sides = sides,
          .first = touches_.near().first_id(c),
          .second = touches_.near().second_id(c),
          .contact = contact,
          .shorter = row[Row::shorter],
          .answer = ask(),
          .wall_velocity = wall.at(contact_point<P, Row>(grains_, row, sides)),
          .wall_spin = wall.spin,
          .elastic = elastic_energies(law, contact, touches_.seen().history_of(c))});
    });
  }

  /// The law returns the components of its force and the energy in its springs.
  static constexpr bool gives_spring_energy =
      GivesComponents<Law, P::dimension, Real> &&
      requires(const Law law, const Contact c, const typename History::type history) {
        law.elastic_energies(c, history);
      };

  /// See Contacts::elastic_energy.
  double elastic_energy() const {
    double energy = 0;
    if constexpr (GivesEnergy<Law, P::dimension, Real>) {
      const auto walls = walls_then();
      for_each_touch(grains_, touches_, [&](Index c, const Sides& sides, const auto* row) {
        energy += double(
            law_of(sides).elastic_energy(contact_of(grains_, touches_.seen(), row, sides, walls),
                                         History::from(touches_.seen().history_of(c))));
      });
    }
    return energy;
  }

  /// See Contacts::history.
  auto history() const {
    using Remembered = typename T::Remembered;
    if (const Remembered* const recalled = touches_.recalled()) return *recalled;
    std::vector<typename Remembered::Entry> entries;
    for_each_touch(grains_, touches_, [&](Index c, const Sides&, const auto*) {
      entries.push_back({touches_.near().first_id(c), touches_.near().second_id(c),
                         History::from(touches_.seen().history_of(c))});
    });
    return Remembered(std::move(entries));
  }

 private:
  const Law& law_of(const Sides& sides) const {
    return law_between(grains_, sides, materials_, walls_);
  }

  auto walls_then() const { return walls_of_step<P>(walls_, touches_.seen()); }

  static ElasticEnergies elastic_energies(const Law& law, const Contact& contact,
                                          const Real* history) {
    if constexpr (gives_spring_energy) {
      return law.elastic_energies(contact, History::from(history));
    } else {
      return {};
    }
  }

  const P& grains_;
  const Materials<Law>& materials_;
  const Walls& walls_;
  const T& touches_;
};

}  // namespace silt::dem
