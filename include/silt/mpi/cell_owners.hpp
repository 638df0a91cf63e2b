// SPDX-License-Identifier: MIT
// Who owns the background cells that several processes share.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/world.hpp>
#include <silt/solve/background_cells.hpp>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace silt::mpi {

/// Of each cell, the first of the processes that occupy it. Every cell has a process, by its position,
/// which is asked for it: its directory.
template <int Dim>
class CellOwners {
 public:
  using Cell = GridCell<Dim>;

  /// No cell is occupied, in the directory of this process.
  void clear() {
    owners_.clear();
    directory_.clear();
  }

  /// Adds those of the cells that are occupied, by any process; the values tell whether this one does.
  /// To be called by all.
  void find(const World& world, const Agreement& agree, const std::map<Cell, bool>& cells) {
    std::vector<Writer> questions(Index(world.size())), answers(Index(world.size()));
    std::vector<std::vector<Cell>> asked(questions.size());
    for (const auto& [cell, is_occupied] : cells) {
      const Index process = directory_of(cell, world);
      questions[process](cell);
      questions[process](is_occupied);
      asked[process].push_back(cell);
    }
    const auto messages = exchange_messages(world, agree, questions);
    const auto for_each_question = [&](auto&& f) {
      for (const Transfer& message : messages) {
        Reader read(message.from);
        while (!read.is_at_end()) {
          Cell cell;
          bool is_occupied = false;
          read(cell);
          read(is_occupied);
          f(message.process, cell, is_occupied);
        }
      }
    };
    for_each_question([&](int process, const Cell& cell, bool is_occupied) {
      if (!is_occupied) return;
      const auto [at, is_new] = directory_.try_emplace(cell, process);
      if (!is_new) at->second = std::min(at->second, process);
    });
    for_each_question([&](int process, const Cell& cell, bool) {
      const auto found = directory_.find(cell);
      answers[Index(process)](found == directory_.end() ? nobody : found->second);
    });
    for (const Transfer& message : exchange_messages(world, agree, answers)) {
      Reader read(message.from);
      for (const Cell& cell : asked[Index(message.process)]) {
        int owner = nobody;
        read(owner);
        if (owner != nobody) owners_[cell] = owner;
      }
    }
  }

  /// By cell, all that have been found.
  const std::map<Cell, int>& all() const noexcept { return owners_; }

 private:
  static constexpr int nobody = -1;

  // Cells of a block are mostly asked for by the same processes.
  static Index directory_of(const Cell& cell, const World& world) {
    std::uint64_t hash = 0;
    for (const std::int64_t k : cell) {
      hash = (hash ^ std::uint64_t(k >> 3)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return Index(hash % std::uint64_t(world.size()));
  }

  std::map<Cell, int> owners_;
  std::map<Cell, int> directory_;  // of those of which this process is the directory
};

}  // namespace silt::mpi
