// SPDX-License-Identifier: MIT
// A law as input of the conformance checks: functions that evaluate it in double, in float, and for
// eight contacts at once as dem::Contacts does.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/conformance/prescribed_contact.hpp>
#include <silt/dem/contact/law_lanes.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

namespace silt::dem::detail {

template <int Dim>
using EightContacts = std::array<PrescribedContact<Dim>, lanes>;
template <int Dim>
using EightLoads = std::array<std::vector<LawLoad<Dim>>, lanes>;

/// The loads along eight contacts of the same duration.
template <class Law, int Dim>
  requires LawInLanes<Law, Dim, double>
EightLoads<Dim> loads_in_lanes(const Law& law, const EightContacts<Dim>& contacts) {
  using History = LawHistory<Law, Dim, double>;
  constexpr bool has_couple = GivesCouple<Law, Dim, double>;
  using Eight = LawLanes<Dim, double, History::words, has_couple>;
  using Row = typename Eight::Row;

  Eight eight{};
  EightLoads<Dim> loads;
  double fresh[std::max(History::words, 1)];
  History::put({}, fresh);
  for (Index k = 0; k < contacts[0].size(); ++k) {
    for (int lane = 0; lane < lanes; ++lane) {
      const auto& contact = contacts[static_cast<Index>(lane)][k];
      if (k == 0 || !(contact.overlap > 0)) {
        for (int word = 0; word < History::words; ++word) eight.history[word][lane] = fresh[word];
      }
      for (int d = 0; d < Dim; ++d) {
        eight.row[Row::n + d][lane] = contact.normal[d];
        eight.velocity[d][lane] = contact.relative_velocity[d];
      }
      if constexpr (has_couple) {
        for (int d = 0; d < angular_size<Dim>; ++d) {
          eight.relative_spin[d][lane] = component(contact.relative_spin, d);
        }
      }
      eight.row[Row::overlap][lane] = contact.overlap;
      eight.row[Row::mass][lane] = contact.effective_mass;
      eight.row[Row::radius][lane] = contact.effective_radius;
    }
    SILT_INDEPENDENT_ITERATIONS
    for (int lane = 0; lane < lanes; ++lane) {
      eight.template evaluate<Lane<double>>(law, {.time_step = contacts[0][k].time_step}, lane);
    }
    for (int lane = 0; lane < lanes; ++lane) {
      LawLoad<Dim>& load = loads[static_cast<Index>(lane)].emplace_back();
      if (!(contacts[static_cast<Index>(lane)][k].overlap > 0)) continue;
      double row[Row::words];
      for (int word = 0; word < Row::words; ++word) row[word] = eight.row[word][lane];
      load.force = Row::template force_in<Dim>(row);
      load.couple = Row::template couple_in<Dim>(row);
    }
  }
  return loads;
}

/// A law of any type.
template <int Dim>
struct LawAdapter {
  template <class Law>
  explicit LawAdapter(const Law& law)
      : in_double(evaluator_in_precision<double, Dim>(law)),
        gives_energy(GivesEnergy<Law, Dim, double>),
        gives_couple(GivesCouple<Law, Dim, double>) {
    if constexpr (ContactLaw<Law, Dim, float>) in_float = evaluator_in_precision<float, Dim>(law);
    if constexpr (LawInLanes<Law, Dim, double>) {
      in_lanes = [law](const EightContacts<Dim>& eight) { return loads_in_lanes(law, eight); };
    }
  }

  MakeContactEvaluator<Dim> in_double;
  MakeContactEvaluator<Dim> in_float;  ///< empty for a law in double only
  /// Empty for a law that is evaluated one contact at a time.
  std::function<EightLoads<Dim>(const EightContacts<Dim>&)> in_lanes;
  bool gives_energy;
  bool gives_couple;
};

}  // namespace silt::dem::detail
