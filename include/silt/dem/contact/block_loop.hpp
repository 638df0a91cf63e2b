// SPDX-License-Identifier: MIT
// A step of contacts as a loop over the blocks of grains. Each thread has consecutive blocks: for
// the contacts of a block it evaluates the law (block_evaluator.hpp), then it sums the forces on
// the block's grains (load_sum.hpp). Grains with a contact in a block of another thread are
// deferred until all blocks have been evaluated.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/block_evaluator.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/load_rows.hpp>
#include <silt/dem/contact/touching_grains.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <cstddef>
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
  /// many contacts touch. evaluate_block is a BlockEvaluator for this list; compare(b, first, last)
  /// is called for the grains [first, last) of each block b.
  template <class BlockEvaluator, class Compare, class Pass>
  Index operator()(P& grains, const ContactList& list, const BlockEvaluator& evaluate_block,
                   Compare& compare, Histories& after, const Pass& pass) {
    after.resize(list.groups());
    division_.fit(list, static_cast<Index>(threads_for(grains.size())));
    loads_.resize(division_.slots());
    is_dense_.resize(list.blocks(), false);
    touching_.resize(grains.size());
    const auto sum_loads = loads_.sums_for(grains, list, division_);
    const auto sum_in_pass = [&pass](Index first, Index last, const auto& sum) {
      pass.before(first, last);
      sum();
      pass.after(first, last);
    };
    std::vector<Index> counts(division_.threads(), 0);
    for_each_task(division_.threads(), [&](Index thread) {
      const Index first_block = division_.first_block(thread);
      const Index last_block = division_.first_block(thread + 1);
      const bool are_most_dense =
          2 * dense_blocks(first_block, last_block) > last_block - first_block;
      touching_.remove_blocks(first_block, last_block);
      Results results{list, division_, loads_, after, touching_};
      for (Index b = first_block; b < last_block; ++b) {
        const bool is_dense = is_dense_[b] != 0;
        const Index touching = evaluate_block(b, is_dense, results);
        if (is_dense && !are_most_dense) results.add_grains_of_dense_block(b);
        is_dense_[b] = evaluate_block.is_dense(b, touching);
        counts[thread] += touching;
        const Index end = std::min(grains.size(), (b + 1) * block_size);
        compare(b, b * block_size, end);
        division_.for_each_ready(b * block_size, end, [&](Index first, Index last) {
          sum_in_pass(first, last, [&] {
            if (are_most_dense) {
              division_.for_each_in_order(first, last, sum_loads);
            } else {
              touching_.for_each(first, last, sum_loads);
            }
          });
        });
      }
    });
    for_each_task(division_.threads(), [&](Index thread) {
      division_.for_each_deferred(thread,
                                  [&](Index i) { sum_in_pass(i, i + 1, [&] { sum_loads(i); }); });
    });
    return std::accumulate(counts.begin(), counts.end(), Index(0));
  }

 private:
  Index dense_blocks(Index first, Index last) const {
    return static_cast<Index>(std::count(is_dense_.begin() + std::ptrdiff_t(first),
                                         is_dense_.begin() + std::ptrdiff_t(last), 1));
  }

  // Where a BlockEvaluator stores its results.
  struct Results {
    const ContactList& list;
    const WorkDivision& division;
    Loads& loads;
    Histories& histories;
    TouchingGrains& grains;

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
        const Index contact = contacts[lane];
        for (int k = 0; k < Lanes::words; ++k) {
          histories.at(contact, k) = eight.history[k][lane];
        }
        add_if_owned(list.first(contact));
        if (!list.is_of_wall(contact)) add_if_owned(list.second(contact));
      }
    }
    // Also those whose contacts do not touch.
    void add_grains_of_dense_block(Index block) {
      grains.add_block(block);
      const auto [first, last] = list.block(block).pairs;
      for (Index c = first; c < last; ++c) add_if_owned(std::max(list.first(c), list.second(c)));
    }
    void add_if_owned(std::uint32_t grain) {
      // Those that are deferred may belong to another thread.
      if (list.is_owned(grain) && !division.is_deferred(grain)) grains.add(grain);
    }
  };

  WorkDivision division_;
  Loads loads_;
  TouchingGrains touching_;
  std::vector<char> is_dense_;  // by block, from the last step
};

}  // namespace silt::dem::detail
