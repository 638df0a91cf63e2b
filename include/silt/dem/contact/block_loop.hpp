// SPDX-License-Identifier: MIT
// A step of contacts as a loop over the blocks of grains. Each thread has consecutive blocks: for
// the contacts of a block it evaluates the law (block_evaluator.hpp), then it sums the forces on
// the block's grains (load_rows.hpp). Grains with a contact in a block of another thread are
// deferred until all blocks have been evaluated.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/block_evaluator.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/load_rows.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <vector>

namespace silt::dem::detail {

/// The loop and the memory that it uses again in every step.
template <class P, class Evaluation>
class BlockLoop {
  using Real = typename P::Real;
  using Histories = typename Evaluation::Histories;
  using Loads = LoadRows<P::dimension, Real, Evaluation::Lanes::Row::has_couple>;

 public:
  /// Has to be called when a list has been rebuilt in the same memory.
  void forget_list() { division_.reset(); }

  /// Adds the forces and torques of all contacts and stores their histories in `after`. Returns how
  /// many contacts touch. evaluate_block is a BlockEvaluator for this list.
  template <class BlockEvaluator, class Pass>
  Index operator()(P& grains, const ContactList& list, const BlockEvaluator& evaluate_block,
                   Histories& after, const Pass& pass) {
    after.resize(list.groups());
    division_.fit(list, static_cast<Index>(threads_for(grains.size())));
    loads_.resize(division_.slots());
    is_dense_.resize(list.blocks(), false);
    const auto sum_forces = [&](Index first, Index last) {
      pass.before(first, last);
      loads_.add_to(grains, list, division_, first, last);
      pass.after(first, last);
    };
    std::vector<Index> counts(division_.threads(), 0);
    for_each_task(division_.threads(), [&](Index thread) {
      Results results{loads_, division_, after};
      for (Index b = division_.first_block(thread); b < division_.first_block(thread + 1); ++b) {
        const Index touching = evaluate_block(b, is_dense_[b] != 0, results);
        is_dense_[b] = evaluate_block.is_dense(b, touching);
        counts[thread] += touching;
        const Index end = std::min(grains.size(), (b + 1) * block_size);
        division_.for_each_ready(b * block_size, end, sum_forces);
      }
    });
    for_each_task(division_.threads(), [&](Index thread) {
      division_.for_each_deferred(thread, [&](Index i) { sum_forces(i, i + 1); });
    });
    return std::accumulate(counts.begin(), counts.end(), Index(0));
  }

 private:
  // Where a BlockEvaluator stores its results.
  struct Results {
    Loads& loads;
    const WorkDivision& division;
    Histories& histories;

    void begin(Index group, unsigned touching, bool is_whole) {
      histories.set_touching_in_group(group, touching);
      if (!is_whole) loads.clear(division.slot_of(group));
    }
    template <class Lanes>
    void store_group(Index group, const Lanes& eight, unsigned touching) {
      loads.store(division.slot_of(group), eight, touching);
      std::memcpy(histories.group(group), eight.history, sizeof(Real) * Lanes::words * lanes);
    }
    template <class Lanes>
    void store_contacts(const EightNumbers& contacts, Index count, const Lanes& eight) {
      loads.store(eight, count, [&](Index lane) { return division.row_of(contacts[lane]); });
      for (Index lane = 0; lane < count; ++lane) {
        for (int k = 0; k < Lanes::words; ++k) {
          histories.at(contacts[lane], k) = eight.history[k][lane];
        }
      }
    }
  };

  WorkDivision division_;
  Loads loads_;
  std::vector<char> is_dense_;  // by block, from the last step
};

}  // namespace silt::dem::detail
