// SPDX-License-Identifier: MIT
// A law as input of the conformance checks: functions that evaluate it in double, in float, and for
// eight contacts at once as dem::Contacts does.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/conformance/prescribed_contact.hpp>
#include <silt/dem/contact/contact_lanes.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/wall/wall.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace silt::dem {

template <int Dim>
using EightContacts = std::array<PrescribedContact<Dim>, lanes>;
template <int Dim>
using EightLoads = std::array<std::vector<LawLoad<Dim>>, lanes>;

/// The loads along eight contacts of the same duration. Each is that of a grain of mass m* and
/// radius R* with its own wall.
template <class Law, int Dim>
  requires LawInLanes<Law, Dim, double>
EightLoads<Dim> loads_in_lanes(const Law& law, const EightContacts<Dim>& contacts) {
  using Kept = LawHistory<Law, Dim, double>;
  constexpr bool has_couple = GivesCouple<Law, Dim, double>;
  using Eight = ContactLanes<Dim, double, Kept::words, has_couple>;
  using Row = typename Eight::Row;

  Grains<Dim> grains;
  std::array<std::uint32_t, lanes> places;
  for (std::uint32_t lane = 0; lane < lanes; ++lane) {
    places[lane] = lane;
    add_grain(grains, Vec<Dim>(Vec<Dim>::Zero()), {.radius = 1, .density = 1});
    grains[mass][lane] = contacts[lane].front().effective_mass;
    grains[radius][lane] = contacts[lane].front().effective_radius;
  }
  const typename Eight::Columns columns(grains);
  alignas(64) double rows[lanes * Row::words] = {};
  alignas(64) double histories[lanes * std::max(Eight::padded_words, 1)] = {};
  const auto history_of = [&](int lane) { return histories + lane * Eight::padded_words; };

  Eight eight;
  EightLoads<Dim> loads;
  for (Index k = 0; k < contacts[0].size(); ++k) {
    for (Index lane = 0; lane < lanes; ++lane) {
      const auto& contact = contacts[lane][k];
      if (k == 0 || !(contact.overlap > 0)) Kept::put({}, history_of(int(lane)));
      // u = v − (R − δ) ω × n
      const Vec<Dim> arm = (contact.overlap - contact.effective_radius) * contact.normal;
      grains[velocity][lane] = contact.relative_velocity - cross(contact.relative_spin, arm);
      grains[spin][lane] = contact.relative_spin;
    }
    const auto nearest = [&](std::uint32_t lane, const auto&) {
      const auto& contact = contacts[lane][k];
      return NearestPoint<Dim, double>{contact.normal, contact.effective_radius - contact.overlap};
    };
    eight.look_at_walls(columns, places.data(), places.data(), nearest);
    eight.meet_walls(columns, places.data(), places.data(), 1, nullptr);
    eight.recall(history_of);
    eight.ask(law, contacts[0][k].time_step);
    eight.give(rows, histories);
    for (Index lane = 0; lane < lanes; ++lane) {
      LawLoad<Dim>& load = loads[lane].emplace_back();
      if (!(contacts[lane][k].overlap > 0)) continue;
      const double* const row = rows + lane * Row::words;
      load.force = Row::template force_in<Dim>(row);
      load.couple = Row::template couple_in<Dim>(row);
    }
  }
  return loads;
}

/// A law with its type erased.
template <int Dim>
struct ErasedLaw {
  MakeContactEvaluator<Dim> in_double;
  MakeContactEvaluator<Dim> in_float;  ///< empty for a law in double only
  /// Empty for a law that is evaluated one contact at a time.
  std::function<EightLoads<Dim>(const EightContacts<Dim>&)> in_lanes;
  bool gives_energy = false;
  bool gives_couple = false;
};

template <int Dim, class Law>
ErasedLaw<Dim> erased(const Law& law) {
  ErasedLaw<Dim> result;
  result.in_double = evaluator_in_precision<double, Dim>(law);
  if constexpr (ContactLaw<Law, Dim, float>) {
    result.in_float = evaluator_in_precision<float, Dim>(law);
  }
  if constexpr (LawInLanes<Law, Dim, double>) {
    result.in_lanes = [law](const EightContacts<Dim>& eight) { return loads_in_lanes(law, eight); };
  }
  result.gives_energy = GivesEnergy<Law, Dim, double>;
  result.gives_couple = GivesCouple<Law, Dim, double>;
  return result;
}

}  // namespace silt::dem
