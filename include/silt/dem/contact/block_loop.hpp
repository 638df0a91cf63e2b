// SPDX-License-Identifier: MIT
// A step of contacts as a loop over the blocks of grains. Each thread has consecutive blocks: for
// the contacts of a block it evaluates the law (block_evaluator.hpp), then it sums the forces on
// the block's grains (load_sum.hpp). Grains with a contact in a block of another thread are
// deferred until that has been evaluated, too.
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

namespace silt::dem::detail {

/// The memory that the loop uses again in every step.
template <class Loads>
struct BlockMemory {
  Loads loads;
  TouchingGrains touching;
  Buffer<char> is_dense;  ///< by block, from the last step
  Buffer<Index> counts;   ///< by thread, of contacts that touch
};

/// Adds the forces and torques of all contacts to the grains, and stores their histories. Refers to
/// its arguments; Input is a BlockInput.
template <class P, class Input>
class BlockLoop {
  using Lanes = typename Input::Lanes;
  using Histories = typename Input::Histories;
  using Results = ResultsOfStep<Lanes, Histories>;

 public:
  using Memory = BlockMemory<typename Results::Loads>;

  /// Changes of the grains' constants are looked for in the same loop. `after` takes the histories.
  template <class Changes>
  BlockLoop(P& grains, const ContactList& list, const Input& input, Changes& changes,
            Histories& after, const Pass& pass, WorkDivision& division, Memory& memory)
      : list_(list),
        grains_(grains.size()),
        input_(input),
        find_changes_(changes),
        pass_(pass),
        division_(division),
        memory_(fit(division, memory, list, grains.size(), after)),
        results_{list, division, memory.loads, after, memory.touching},
        sums_(grains, list, division, memory.loads) {}

  /// Returns how many contacts touch.
  Index add_forces() {
    const Index threads = division_.threads();
    memory_.counts.assign(threads, 0);
    memory_.touching.clear();
    evaluate_added();
    division_.deferred().begin_step();
    for_each_task(threads, [this](Index thread) {
      evaluate_blocks(thread);
      division_.deferred().finish(thread, [this](Index first, Index last) {
        pass_.before(first, last);
        sums_.add(first, last, nullptr);
        pass_.after(first, last);
      });
    });
    return std::accumulate(memory_.counts.begin(), memory_.counts.end(), Index(0));
  }

 private:
  static Memory& fit(WorkDivision& division, Memory& memory, const ContactList& list, Index grains,
                     Histories& after) {
    after.resize(list.groups());
    division.fit(list, static_cast<Index>(threads_for(grains)));
    memory.loads.resize(division.slots());
    memory.is_dense.resize(list.blocks(), false);
    memory.touching.resize(grains);
    return memory;
  }

  // Before all others: grains of any block may have such contacts.
  void evaluate_added() {
    const Index last = list_.blocks() + list_.added_blocks();
    for (Index b = list_.blocks(); b < last; ++b) {
      memory_.counts[0] += evaluate_block(input_, b, false, {.step = &results_});
    }
  }
  // Evaluates the contacts of a thread's blocks and sums the forces on their grains, but those that
  // are deferred.
  void evaluate_blocks(Index thread) {
    const Index first_block = division_.first_block(thread);
    const Index last_block = division_.first_block(thread + 1);
    const bool are_most_dense =
        2 * dense_blocks(first_block, last_block) > last_block - first_block;
    const TouchingGrains* const touching = are_most_dense ? nullptr : &memory_.touching;
    for (Index b = first_block; b < last_block; ++b) {
      const bool is_dense = memory_.is_dense[b] != 0;
      const Index count = evaluate_block(input_, b, is_dense, {.step = &results_});
      if (is_dense && !are_most_dense) results_.add_grains_of_dense_block(b);
      memory_.is_dense[b] = input_.is_dense(b, count);
      memory_.counts[thread] += count;
      const Index end = std::min(grains_, (b + 1) * block_size);
      find_changes_(b, b * block_size, end);
      division_.for_each_ready(b * block_size, end, [&](Index first, Index last) {
        pass_.before(first, last);
        sums_.add(first, last, touching);
        pass_.after(first, last);
      });
    }
  }

  Index dense_blocks(Index first, Index last) const {
    const auto begin = memory_.is_dense.begin();
    return static_cast<Index>(
        std::count(begin + std::ptrdiff_t(first), begin + std::ptrdiff_t(last), 1));
  }

  const ContactList& list_;
  Index grains_;
  const Input& input_;
  FunctionRef<void(Index, Index, Index)> find_changes_;
  const Pass& pass_;
  WorkDivision& division_;
  Memory& memory_;
  Results results_;
  LoadSums<P, Lanes::Row::has_couple> sums_;
};

}  // namespace silt::dem::detail
