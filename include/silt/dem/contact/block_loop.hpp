// SPDX-License-Identifier: MIT
// A step of contacts as a loop over the blocks of grains. Each thread has consecutive blocks: for
// the contacts of a block it evaluates the law (block_evaluator.hpp), then it sums the forces on
// the block's grains (load_sum.hpp). Grains with a contact in a block of another thread are
// deferred until all blocks have been evaluated.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/contact_results.hpp>
#include <silt/dem/contact/touching_grains.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace silt::dem::detail {

/// The loop and the memory that it uses again in every step.
template <class P, class Evaluation>
class BlockLoop {
  using Real = typename P::Real;
  using Histories = typename Evaluation::Histories;
  using Results = ContactResults<typename Evaluation::Lanes, Histories>;

 public:
  /// Has to be called when a list has been rebuilt in the same memory.
  void forget_list() { division_.reset(); }

  /// Adds the forces and torques of all contacts and stores their histories in `after`. Returns how
  /// many contacts touch. `evaluator` is a BlockEvaluator for this list; compare(b, first, last)
  /// is called for the grains [first, last) of each block b.
  template <class Evaluator, class Compare>
  Index add_forces(P& grains, const ContactList& list, const Evaluator& evaluator, Compare& compare,
                   Histories& after, const Pass& pass) {
    after.resize(list.groups());
    division_.fit(list, static_cast<Index>(threads_for(grains.size())));
    loads_.resize(division_.slots());
    is_dense_.resize(list.blocks(), false);
    touching_.resize(grains.size());
    const typename Results::OfStep results{list, division_, loads_, after, touching_};
    const auto sum_loads = loads_.sums_for(grains, list, division_);
    std::vector<Index> counts(division_.threads(), 0);
    for_each_task(division_.threads(), [&](Index thread) {
      counts[thread] = evaluate_blocks(thread, evaluator, Results(results), compare, grains.size(),
                                       sum_loads, pass);
    });
    for_each_task(division_.threads(), [&](Index thread) {
      division_.for_each_deferred(thread, [&](Index i) {
        pass.before(i, i + 1);
        sum_loads(i);
        pass.after(i, i + 1);
      });
    });
    return std::accumulate(counts.begin(), counts.end(), Index(0));
  }

 private:
  // Evaluates the contacts of a thread's blocks and sums the forces on their grains, but those that
  // are deferred. Returns how many contacts touch.
  template <class Evaluator, class Compare, class SumLoads>
  Index evaluate_blocks(Index thread, const Evaluator& evaluator, Results results, Compare& compare,
                        Index grains, const SumLoads& sum_loads, const Pass& pass) {
    const Index first_block = division_.first_block(thread);
    const Index last_block = division_.first_block(thread + 1);
    const bool are_most_dense =
        2 * dense_blocks(first_block, last_block) > last_block - first_block;
    touching_.remove_blocks(first_block, last_block);
    Index count = 0;
    for (Index b = first_block; b < last_block; ++b) {
      const bool is_dense = is_dense_[b] != 0;
      const Index touching = evaluator.evaluate(b, is_dense, results);
      if (is_dense && !are_most_dense) results.add_grains_of_dense_block(b);
      is_dense_[b] = evaluator.is_dense(b, touching);
      count += touching;
      const Index end = std::min(grains, (b + 1) * block_size);
      compare(b, b * block_size, end);
      division_.for_each_ready(b * block_size, end, [&](Index first, Index last) {
        pass.before(first, last);
        if (are_most_dense) {
          division_.for_each_in_order(first, last, sum_loads);
        } else {
          touching_.for_each(first, last, sum_loads);
        }
        pass.after(first, last);
      });
    }
    return count;
  }

  Index dense_blocks(Index first, Index last) const {
    return static_cast<Index>(std::count(is_dense_.begin() + std::ptrdiff_t(first),
                                         is_dense_.begin() + std::ptrdiff_t(last), 1));
  }

  WorkDivision division_;
  typename Results::Loads loads_;
  TouchingGrains touching_;
  std::vector<char> is_dense_;  // by block, from the last step
};

}  // namespace silt::dem::detail
