// SPDX-License-Identifier: MIT
// Where the results of contacts go: for a step, their loads and histories; for observers, the rows
// of the contacts. One class, so that the evaluation of contacts is compiled once for both.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_DEM_CONTACT_CONTACT_RESULTS
#define SILT_DEM_CONTACT_CONTACT_RESULTS

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

/// Where they go in a step. Lanes is a LawLanes, HistoriesType a Histories.
template <class Lanes, class HistoriesType>
struct ResultsOfStep {
  using Loads = LoadRows<Lanes::dimension, typename Lanes::Real, Lanes::Row::has_couple>;

  void add_if_owned(std::uint32_t grain) const {
    // Those that are deferred may belong to another thread.
    if (list.is_owned(grain) && !division.is_deferred(grain)) grains.add(grain);
  }
  /// Adds the grains of a block that was evaluated in groups, also those whose contacts do not
  /// touch.
  void add_grains_of_dense_block(Index block) const {
    grains.add_block(block);
    const auto [first, last] = list.block(block).pairs;
    for (Index c = first; c < last; ++c) {
      add_if_owned(std::max(list.first(c), list.second(c)));
    }
  }

  const ContactList& list;
  const WorkDivision& division;
  Loads& loads;
  HistoriesType& histories;
  TouchingGrains& grains;  ///< those with contacts of groups that were not evaluated as a whole
};

/// Either in a step, or to rows: row c, of Lanes::Row::words numbers, is that of contact c.
template <class Lanes, class HistoriesType>
struct ResultsTo {
  const ResultsOfStep<Lanes, HistoriesType>* step = nullptr;
  typename Lanes::Real* rows = nullptr;
};

}  // namespace silt::dem::detail

#define SILT_KERNELS <silt/dem/contact/contact_results.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::dem::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// Takes the results of a BlockEvaluator.
template <class Lanes, class HistoriesType>
class ContactResults {
  using Real = typename Lanes::Real;
  using Row = typename Lanes::Row;
  using OfStep = ResultsOfStep<Lanes, HistoriesType>;
  using Store = LoadStore<typename OfStep::Loads>;

 public:
  explicit ContactResults(const ResultsTo<Lanes, HistoriesType>& to)
      : step_(to.step), rows_(to.rows) {}

  /// Once for each group, before its results; bit l of `touching` is set if contact l touches.
  void begin(Index group, unsigned touching, bool is_whole) {
    if (rows_ != nullptr) return;
    step_->histories.set_touching_in_group(group, touching);
    if (!is_whole) Store::clear(step_->loads, step_->division.slot_of(group));
  }
  /// The results of a group that is whole.
  void store_group(Index group, const Lanes& eight, unsigned touching) {
    if (rows_ != nullptr) {
      for (int k = 0; k < Row::words; k += 4) {
        simd::rows_from(&eight.row[k], rows_ + group * lanes * Row::words + k, Row::words);
      }
      return;
    }
    Store::store(step_->loads, step_->division.slot_of(group), eight, touching);
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
    Store::store(step.loads, eight, count,
                 [&](Index lane) { return step.division.row_of(contacts[lane]); });
    for (Index lane = 0; lane < count; ++lane) {
      const Index contact = contacts[lane];
      for (int k = 0; k < Lanes::words; ++k) {
        step.histories.at(contact, k) = eight.history[k][lane];
      }
      step.add_if_owned(step.list.first(contact));
      if (!step.list.is_of_wall(contact)) step.add_if_owned(step.list.second(contact));
    }
  }

 private:
  const OfStep* step_;
  Real* rows_;
};

}  // namespace silt::dem::detail::SILT_INSTRUCTION_SET

#endif
