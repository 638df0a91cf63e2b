// SPDX-License-Identifier: MIT
// A step of contacts as a loop over the blocks of grains. Each thread has consecutive blocks: for
// the contacts of a block it evaluates the law (block_evaluator.hpp), then it sums the forces on
// the block's grains (load_sum.hpp). Grains with a contact in a block of another thread are
// deferred until all blocks have been evaluated.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/block_evaluator.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/contact_results.hpp>
#include <silt/dem/contact/list_constants.hpp>
#include <silt/dem/contact/touching_grains.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace silt::dem::detail {

/// The memory that the loop uses again in every step.
template <class Loads>
struct BlockMemory {
  WorkDivision division;
  Loads loads;
  TouchingGrains touching;
  Buffer<char> is_dense;  ///< by block, from the last step
  Buffer<Index> counts;   ///< by thread, of contacts that touch
};

/// Adds the forces and torques of all contacts to the grains, and stores their histories. Refers to
/// its arguments; Evaluator is a BlockEvaluator.
template <class P, class Evaluator>
class BlockLoop {
  using Results = typename Evaluator::Results;

 public:
  using Memory = BlockMemory<typename Results::Loads>;

  /// Changes of the grains' constants are looked for in the same loop. `after` takes the histories.
  template <class Changes>
  BlockLoop(P& grains, const ContactList& list, const Evaluator& evaluator, Changes& changes,
            typename Evaluator::Histories& after, const Pass& pass, Memory& memory)
      : grains_(grains.size()),
        evaluator_(evaluator),
        find_changes_(changes),
        pass_(pass),
        memory_(fit(memory, list, grains.size(), after)),
        results_{list, memory.division, memory.loads, after, memory.touching},
        sum_loads_(memory.loads.sums_for(grains, list, memory.division)) {}

  /// Returns how many contacts touch.
  Index add_forces() {
    const Index threads = memory_.division.threads();
    memory_.counts.assign(threads, 0);
    if (threads == 1) {
      evaluate_blocks(0);
    } else {
      for_each_task(threads, [this](Index thread) { evaluate_blocks(thread); });
      for_each_task(threads, [this](Index thread) { sum_deferred(thread); });
    }
    return std::accumulate(memory_.counts.begin(), memory_.counts.end(), Index(0));
  }

 private:
  static Memory& fit(Memory& memory, const ContactList& list, Index grains,
                     typename Evaluator::Histories& after) {
    after.resize(list.groups());
    memory.division.fit(list, static_cast<Index>(threads_for(grains)));
    memory.loads.resize(memory.division.slots());
    memory.is_dense.resize(list.blocks(), false);
    memory.touching.resize(grains);
    return memory;
  }

  // Evaluates the contacts of a thread's blocks and sums the forces on their grains, but those that
  // are deferred.
  void evaluate_blocks(Index thread) {
    const WorkDivision& division = memory_.division;
    const Index first_block = division.first_block(thread);
    const Index last_block = division.first_block(thread + 1);
    const bool are_most_dense =
        2 * dense_blocks(first_block, last_block) > last_block - first_block;
    memory_.touching.remove_blocks(first_block, last_block);
    const auto sum_loads = sum_loads_;
    Results results(results_);
    typename Evaluator::Batch batch;
    for (Index b = first_block; b < last_block; ++b) {
      const bool is_dense = memory_.is_dense[b] != 0;
      auto contacts = evaluator_.contacts_of(b, is_dense);
      while (evaluator_.fill(batch, contacts, results)) evaluator_.evaluate(batch, results);
      if (is_dense && !are_most_dense) results.add_grains_of_dense_block(b);
      memory_.is_dense[b] = evaluator_.is_dense(b, contacts.touching());
      memory_.counts[thread] += contacts.touching();
      const Index end = std::min(grains_, (b + 1) * block_size);
      find_changes_(b, b * block_size, end);
      division.for_each_ready(b * block_size, end, [&](Index first, Index last) {
        pass_.before(first, last);
        if (are_most_dense) {
          division.for_each_in_order(first, last, sum_loads);
        } else {
          memory_.touching.for_each(first, last, sum_loads);
        }
        pass_.after(first, last);
      });
    }
  }
  void sum_deferred(Index thread) {
    memory_.division.for_each_deferred(thread, [&](Index i) {
      pass_.before(i, i + 1);
      sum_loads_(i);
      pass_.after(i, i + 1);
    });
  }

  Index dense_blocks(Index first, Index last) const {
    const auto begin = memory_.is_dense.begin();
    return static_cast<Index>(
        std::count(begin + std::ptrdiff_t(first), begin + std::ptrdiff_t(last), 1));
  }

  Index grains_;
  const Evaluator& evaluator_;
  FunctionRef<void(Index, Index, Index)> find_changes_;
  const Pass& pass_;
  Memory& memory_;
  typename Results::OfStep results_;
  decltype(std::declval<Memory&>().loads.sums_for(std::declval<P&>(),
                                                  std::declval<const ContactList&>(),
                                                  std::declval<const WorkDivision&>())) sum_loads_;
};

}  // namespace silt::dem::detail
