// SPDX-License-Identifier: MIT
// Where the results of contacts go: for a step, their loads and histories; for observers, the rows
// of the contacts. One class, so that the evaluation of contacts is compiled once for both.
#pragma once

#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/load_rows.hpp>
#include <silt/dem/contact/touching_grains.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace silt::dem::detail {

/// The numbers of eight contacts.
using EightNumbers = std::array<std::uint32_t, lanes>;

/// Takes the results of a BlockEvaluator. Lanes is a LawLanes, HistoriesType a Histories.
template <class Lanes, class HistoriesType>
class ContactResults {
  using Real = typename Lanes::Real;
  using Row = typename Lanes::Row;

 public:
  using Loads = LoadRows<Lanes::dimension, Real, Row::has_couple>;
  struct OfStep {
    const ContactList& list;
    const WorkDivision& division;
    Loads& loads;
    HistoriesType& histories;
    TouchingGrains& grains;  ///< those with contacts of groups that were not evaluated as a whole
  };

  explicit ContactResults(const OfStep& step) : step_(&step) {}
  /// Row c, of Row::words numbers, is that of contact c.
  explicit ContactResults(Real* rows) : rows_(rows) {}

  /// Once for each group, before its results; bit l of `touching` is set if contact l touches.
  void begin(Index group, unsigned touching, bool is_whole) {
    if (rows_ != nullptr) return;
    step_->histories.set_touching_in_group(group, touching);
    if (!is_whole) step_->loads.clear(step_->division.slot_of(group));
  }
  /// The results of a group that is whole.
  void store_group(Index group, const Lanes& eight, unsigned touching) {
    if (rows_ != nullptr) {
      for (int k = 0; k < Row::words; k += 4) {
        rows_from(&eight.row[k], rows_ + group * lanes * Row::words + k, Row::words);
      }
      return;
    }
    step_->loads.store(step_->division.slot_of(group), eight, touching);
    std::memcpy(step_->histories.group(group), eight.history, sizeof(Real) * Lanes::words * lanes);
  }
  /// Those of `count` contacts of other groups.
  void store_contacts(const EightNumbers& contacts, Index count, const Lanes& eight) {
    if (rows_ != nullptr) {
      for (Index lane = 0; lane < count; ++lane) {
        Real* const row = rows_ + contacts[lane] * Row::words;
        for (int k = 0; k < Row::words; ++k) row[k] = eight.row[k][lane];
      }
      return;
    }
    const OfStep& step = *step_;
    step.loads.store(eight, count,
                     [&](Index lane) { return step.division.row_of(contacts[lane]); });
    for (Index lane = 0; lane < count; ++lane) {
      const Index contact = contacts[lane];
      for (int k = 0; k < Lanes::words; ++k) {
        step.histories.at(contact, k) = eight.history[k][lane];
      }
      add_if_owned(step.list.first(contact));
      if (!step.list.is_of_wall(contact)) add_if_owned(step.list.second(contact));
    }
  }
  /// Adds the grains of a block that was evaluated in groups, also those whose contacts do not
  /// touch.
  void add_grains_of_dense_block(Index block) {
    step_->grains.add_block(block);
    const auto [first, last] = step_->list.block(block).pairs;
    for (Index c = first; c < last; ++c) {
      add_if_owned(std::max(step_->list.first(c), step_->list.second(c)));
    }
  }

 private:
  void add_if_owned(std::uint32_t grain) {
    // Those that are deferred may belong to another thread.
    if (step_->list.is_owned(grain) && !step_->division.is_deferred(grain)) {
      step_->grains.add(grain);
    }
  }

  const OfStep* step_ = nullptr;
  Real* rows_ = nullptr;
};

}  // namespace silt::dem::detail
