// SPDX-License-Identifier: MIT
// Values of background cells that go from the processes that use a cell to the one that owns it, and
// back.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/cell_owners.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/world.hpp>
#include <silt/solve/background_cells.hpp>

#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace silt::mpi {

/// A cell is used where it is among the numbered cells, and owned by one of those processes.
template <int Dim>
class CellExchange {
 public:
  using Cell = GridCell<Dim>;

  /// Finds who uses the own cells, and the numbers of all cells here among those of all processes: a
  /// process has those from first() on. To be called by all.
  void find(const World& world, const Agreement& agree, const BackgroundCells<Dim>& cells,
            const CellOwners<Dim>& owners) {
    world_ = &world;
    own_.clear();
    lists_.clear();
    std::vector<Writer> wishes(Index(world.size())), answers(Index(world.size()));
    std::vector<std::vector<std::uint32_t>> used(wishes.size());
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
      const Cell& cell = cells.cells()[c];
      const int owner = owners.all().at(cell);
      if (owner == world.rank()) {
        own_.push_back(c);
      } else {
        wishes[Index(owner)](cell);
        used[Index(owner)].push_back(c);
      }
    }
    number_own(agree, cells.size());
    for (const Transfer& message : exchange_messages(world, agree, wishes)) {
      Reader read(message.from);
      while (!read.is_at_end()) {
        Cell cell;
        read(cell);
        const std::uint32_t c = cells.find(cell);
        list_with(message.process).owned.push_back(c);
        answers[Index(message.process)](numbers_[c]);
      }
    }
    for (const Transfer& message : exchange_messages(world, agree, answers)) {
      Reader read(message.from);
      auto& list = list_with(message.process);
      list.used = std::move(used[Index(message.process)]);
      for (const std::uint32_t c : list.used) read(numbers_[c]);
    }
    agree([&] {
      to_owners_ = transfers(&List::used, &List::owned);
      to_users_ = transfers(&List::owned, &List::used);
      requests_.reserve(2 * lists_.size());
      return Reduced();
    });
  }

  const std::vector<std::uint32_t>& own() const noexcept { return own_; }  ///< cells
  double number(Index cell) const { return numbers_[cell]; }  ///< among those of all processes [-]
  double first() const noexcept { return first_; }            ///< number of the first own cell [-]
  double all() const noexcept { return all_; }                ///< cells of all processes [-]

  // To be called by all, after an agreement; they throw nothing but errors of MPI. Values are floats,
  // by cell.

  /// Adds the values of each used cell to that of the process that owns it.
  template <class Values>
  void add_to_owners(Values& values) {
    transfer(to_owners_, &List::used, &List::owned, values,
             [](float& own, float more) { own += more; });
  }
  /// Sets the value of each used cell to that of the process that owns it.
  template <class Values>
  void give_to_users(Values& values) {
    transfer(to_users_, &List::owned, &List::used, values,
             [](float& here, float value) { here = value; });
  }

 private:
  // Cells that another process owns or uses, in the same order there.
  struct List {
    int process;
    std::vector<std::uint32_t> used = {};   // by this process, of the other one
    std::vector<std::uint32_t> owned = {};  // by this process, used by the other one
  };
  using Cells = std::vector<std::uint32_t> List::*;

  List& list_with(int process) {
    const auto found = std::ranges::find(lists_, process, &List::process);
    return found == lists_.end() ? lists_.emplace_back(List{process}) : *found;
  }
  // Numbers of doubles are exact to 2⁵³.
  void number_own(const Agreement& agree, Index cells) {
    numbers_.assign(cells, 0);
    const Reduced sums = agree([&] {
      Reduced own;
      own.sum[0] = double(own_.size());
      return own;
    });
    all_ = sums.sum[0];
    double own = double(own_.size()), before = 0;
    detail::check(MPI_Exscan(&own, &before, 1, MPI_DOUBLE, MPI_SUM, world_->communicator()),
                  "MPI_Exscan");
    first_ = world_->is_first() ? 0 : before;
    for (Index k = 0; k < own_.size(); ++k) numbers_[own_[k]] = first_ + double(k);
  }

  std::vector<Transfer> transfers(Cells sent, Cells received) const {
    std::vector<Transfer> all;
    for (const List& each : lists_) {
      const int to = detail::count_of((each.*sent).size() * sizeof(float));
      const int from = detail::count_of((each.*received).size() * sizeof(float));
      all.push_back({each.process, Bytes(Index(to)), Bytes(Index(from))});
    }
    return all;
  }
  template <class Values, class Set>
  void transfer(std::vector<Transfer>& all, Cells sent, Cells received, Values& values,
                const Set& set) {
    for (Index k = 0; k < lists_.size(); ++k) {
      std::byte* to = all[k].to.data();
      for (const std::uint32_t c : lists_[k].*sent) {
        const float value = values[c];
        std::memcpy(to, &value, sizeof(float));
        to += sizeof(float);
      }
    }
    do_transfers(*world_, all, requests_);
    for (Index k = 0; k < lists_.size(); ++k) {
      const std::byte* from = all[k].from.data();
      for (const std::uint32_t c : lists_[k].*received) {
        float value = 0;
        std::memcpy(&value, from, sizeof(float));
        from += sizeof(float);
        set(values[c], value);
      }
    }
  }

  const World* world_ = nullptr;
  std::vector<std::uint32_t> own_;
  std::vector<double> numbers_;
  double first_ = 0;
  double all_ = 0;
  std::vector<List> lists_;
  std::vector<Transfer> to_owners_, to_users_;
  std::vector<MPI_Request> requests_;
};

}  // namespace silt::mpi
