// SPDX-License-Identifier: MIT
// The V-cycle over background cells that several processes share, by the library hypre (BoomerAMG).
//
//   directory   every cell has a process, by its position, that knows who occupies it
//   owner       the first of those that occupy a cell has its equation, a row of the matrix
//   users       all that occupy it, interpolate from it, or own a cell beside it
//
// Sums over the particles in a cell go from users to owners, corrections from owners to users.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/world.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_level.hpp>
#include <silt/solve/cell_multigrid_settings.hpp>

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt::mpi {

namespace detail {
/// Throws if a call of hypre failed since the last check.
inline void check_hypre() {
  const HYPRE_Int code = HYPRE_GetError();
  if (code == 0) return;
  HYPRE_ClearAllErrors();
  fail("mpi: hypre failed with the error flags " + std::to_string(code) +
       "; end the job and start it again");
}
}  // namespace detail

/// For systems whose SharedUnknowns are those of particles of distribute(), see CellMultigrid.
template <int Dim>
class CellCycle {
 public:
  using Level = CellLevel<Dim>;
  using Cell = GridCell<Dim>;

  CellCycle() = default;
  explicit CellCycle(const CellMultigridSettings&) {}
  // Copies need their own share() and prepare().
  CellCycle(const CellCycle&) {}
  CellCycle& operator=(const CellCycle&) {
    release();
    return *this;
  }
  ~CellCycle() { release(); }

  std::vector<Cell> share(const LinearSystem& system, std::span<const Cell> occupied,
                          std::span<const Cell> corners) {
    world_ = static_cast<const World*>(system.shared->processes());
    agree_.emplace(*world_);
    owners_.clear();
    directory_.clear();
    is_known_for_.reset();
    std::map<Cell, bool> asked;  // and whether it is occupied here
    for (const Cell& cell : corners) asked[cell] = false;
    for (const Cell& cell : occupied) asked[cell] = true;
    ask_directory(asked);
    std::map<Cell, bool> beside;
    for (const auto& [cell, owner] : owners_) {
      if (owner != world_->rank()) continue;
      for_each_beside(cell, [&](const Cell& next) {
        if (!asked.contains(next)) beside[next] = false;
      });
    }
    ask_directory(beside);
    std::vector<Cell> cells;
    for (const auto& [cell, owner] : owners_) cells.push_back(cell);
    return cells;
  }

  template <class Values>
  void add_of_others(const BackgroundCells<Dim>& cells, Values& values) {
    if (!is_known_for_ || *is_known_for_ != cells.size()) find_users(cells);
    add_to_owners(values);
    give_to_users(values);
  }

  Level& finest() { return level_; }

  void prepare() {
    release();
    level_.finish(min_mass);
    const HYPRE_BigInt first = first_, last = first_ + HYPRE_BigInt(own_.size()) - 1;
    std::vector<HYPRE_Int> entries;
    std::vector<HYPRE_BigInt> columns;
    std::vector<double> values;
    (*agree_)([&] {
      rows_.clear();
      for (const std::uint32_t c : own_) {
        rows_.push_back(numbers_[c]);
        const auto begin = columns.size();
        columns.push_back(numbers_[c]);
        values.push_back(level_.diagonal[c] > 0 ? double(level_.diagonal[c]) : 1);
        for (const auto& [other, conductance] : level_.links[c]) {
          columns.push_back(numbers_[other]);
          values.push_back(-double(conductance));
        }
        entries.push_back(HYPRE_Int(columns.size() - begin));
      }
      vector_.resize(own_.size());
      return Reduced();
    });
    const auto n = HYPRE_Int(own_.size());
    HYPRE_IJMatrixCreate(world_->communicator(), first, last, first, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(matrix_);
    HYPRE_IJMatrixSetValues(matrix_, n, entries.data(), rows_.data(), columns.data(),
                            values.data());
    HYPRE_IJMatrixAssemble(matrix_);
    for (HYPRE_IJVector* vector : {&b_, &x_}) {
      HYPRE_IJVectorCreate(world_->communicator(), first, last, vector);
      HYPRE_IJVectorSetObjectType(*vector, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*vector);
      std::fill(vector_.begin(), vector_.end(), 0.0);
      HYPRE_IJVectorSetValues(*vector, n, rows_.data(), vector_.data());
      HYPRE_IJVectorAssemble(*vector);
    }
    HYPRE_BoomerAMGCreate(&multigrid_);
    HYPRE_BoomerAMGSetRelaxType(multigrid_, 6);  // symmetric Gauss–Seidel
    HYPRE_BoomerAMGSetTol(multigrid_, 0);
    HYPRE_BoomerAMGSetMaxIter(multigrid_, 1);
    HYPRE_BoomerAMGSetup(multigrid_, parcsr(matrix_), parcsr(b_), parcsr(x_));
    detail::check_hypre();
  }

  // Called between reductions of the solver, so that all come here or none.
  void solve() {
    const auto n = HYPRE_Int(own_.size());
    add_to_owners(level_.b);
    for (Index k = 0; k < own_.size(); ++k) vector_[k] = double(level_.b[own_[k]]);
    HYPRE_IJVectorSetValues(b_, n, rows_.data(), vector_.data());
    std::fill(vector_.begin(), vector_.end(), 0.0);
    HYPRE_IJVectorSetValues(x_, n, rows_.data(), vector_.data());
    HYPRE_BoomerAMGSolve(multigrid_, parcsr(matrix_), parcsr(b_), parcsr(x_));
    HYPRE_ClearAllErrors();  // that one cycle does not converge
    HYPRE_IJVectorGetValues(x_, n, rows_.data(), vector_.data());
    for (Index k = 0; k < own_.size(); ++k) level_.x[own_[k]] = float(vector_[k]);
    give_to_users(level_.x);
  }

  Index levels() const noexcept { return 1; }

 private:
  static constexpr float min_mass = 1e-6f;

  template <class F>
  static void for_each_beside(const Cell& cell, F&& f) {
    for (std::size_t k = 0; k < Dim; ++k) {
      for (const std::int64_t direction : {-1, 1}) {
        Cell next = cell;
        next[k] += direction;
        f(next);
      }
    }
  }

  // Cells of a block, which are mostly asked for by the same processes, are in one directory.
  Index directory_of(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t k : cell) {
      hash = (hash ^ std::uint64_t(k >> 3)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    return Index(hash % std::uint64_t(world_->size()));
  }

  std::vector<Message> exchange(std::vector<Writer>& writers) const {
    std::vector<Message> messages;
    for (Index process = 0; process < writers.size(); ++process) {
      if (writers[process].bytes().empty()) continue;
      messages.push_back({int(process), std::move(writers[process].bytes())});
    }
    return exchange_messages(*world_, *agree_, messages);
  }

  // Tells it which of the cells are occupied here, and finds the owners of those that are occupied.
  void ask_directory(const std::map<Cell, bool>& cells) {
    std::vector<Writer> writers(Index(world_->size()));
    std::vector<std::vector<Cell>> asked(writers.size());
    for (const auto& [cell, is_occupied] : cells) {
      const Index process = directory_of(cell);
      writers[process](cell);
      writers[process](is_occupied);
      asked[process].push_back(cell);
    }
    const auto questions = exchange(writers);
    const auto for_each_question = [&](auto&& f) {
      for (const Message& message : questions) {
        Reader read(message.bytes);
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
    std::vector<Writer> answers(writers.size());
    for_each_question([&](int process, const Cell& cell, bool) {
      const auto found = directory_.find(cell);
      answers[Index(process)](found == directory_.end() ? none : found->second);
    });
    for (const Message& message : exchange(answers)) {
      Reader read(message.bytes);
      for (const Cell& cell : asked[Index(message.process)]) {
        int owner = none;
        read(owner);
        if (owner != none) owners_[cell] = owner;
      }
    }
  }

  // The transfers between owners and users, and the numbers of the cells of all processes.
  void find_users(const BackgroundCells<Dim>& cells) {
    is_known_for_ = cells.size();
    own_.clear();
    numbers_.assign(cells.size(), 0);
    std::vector<Writer> writers(Index(world_->size()));
    std::vector<std::vector<std::uint32_t>> used(writers.size());
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
      const Cell& cell = cells.cells()[c];
      const int owner = owners_.at(cell);
      if (owner == world_->rank()) {
        own_.push_back(c);
      } else {
        writers[Index(owner)](cell);
        used[Index(owner)].push_back(c);
      }
    }
    number_own();
    const auto wishes = exchange(writers);
    lists_.clear();
    const auto list_with = [&](int process) -> List& {
      const auto found = std::ranges::find(lists_, process, &List::process);
      return found == lists_.end() ? lists_.emplace_back(List{process, {}, {}}) : *found;
    };
    std::vector<Writer> answers(writers.size());
    for (const Message& message : wishes) {
      Reader read(message.bytes);
      while (!read.is_at_end()) {
        Cell cell;
        read(cell);
        const std::uint32_t c = cells.find(cell);
        list_with(message.process).owned.push_back(c);
        answers[Index(message.process)](numbers_[c]);
      }
    }
    for (const Message& message : exchange(answers)) {
      Reader read(message.bytes);
      auto& list = list_with(message.process);
      list.used = std::move(used[Index(message.process)]);
      for (const std::uint32_t c : list.used) read(numbers_[c]);
    }
    (*agree_)([&] {
      to_owners_.clear();
      to_users_.clear();
      for (const List& each : lists_) {
        const Index used_bytes = each.used.size() * sizeof(float);
        const Index owned_bytes = each.owned.size() * sizeof(float);
        to_owners_.push_back({each.process, Bytes(used_bytes), Bytes(owned_bytes)});
        to_users_.push_back({each.process, Bytes(owned_bytes), Bytes(used_bytes)});
      }
      requests_.reserve(2 * lists_.size());
      return Reduced();
    });
  }
  void number_own() {
    const Reduced all = (*agree_)([&] {
      Reduced own;
      own.sum[0] = double(own_.size());
      return own;
    });
    if (all.sum[0] > double(std::numeric_limits<HYPRE_BigInt>::max())) {
      fail("mpi: " + to_text(all.sum[0]) +
           " cells of the pressure solver are more than this hypre can number; build hypre with "
           "64-bit integers");
    }
    double own = double(own_.size()), before = 0;
    detail::check(MPI_Exscan(&own, &before, 1, MPI_DOUBLE, MPI_SUM, world_->communicator()),
                  "MPI_Exscan");
    first_ = world_->is_first() ? 0 : HYPRE_BigInt(before);
    for (Index k = 0; k < own_.size(); ++k) numbers_[own_[k]] = first_ + HYPRE_BigInt(k);
  }

  template <class Values>
  void add_to_owners(Values& values) {
    write(values, &List::used, to_owners_);
    do_transfers(*world_, to_owners_, requests_);
    for (Index k = 0; k < lists_.size(); ++k) {
      for (Index n = 0; n < lists_[k].owned.size(); ++n) {
        values[lists_[k].owned[n]] += read(to_owners_[k], n);
      }
    }
  }
  template <class Values>
  void give_to_users(Values& values) {
    write(values, &List::owned, to_users_);
    do_transfers(*world_, to_users_, requests_);
    for (Index k = 0; k < lists_.size(); ++k) {
      for (Index n = 0; n < lists_[k].used.size(); ++n) {
        values[lists_[k].used[n]] = read(to_users_[k], n);
      }
    }
  }

  // Cells that another process owns or uses, in the same order there.
  struct List {
    int process;
    std::vector<std::uint32_t> used;   // by this process, of the other one
    std::vector<std::uint32_t> owned;  // by this process, used by the other one
  };
  template <class Values>
  void write(const Values& values, std::vector<std::uint32_t> List::*cells,
             std::vector<Transfer>& transfers) const {
    for (Index k = 0; k < lists_.size(); ++k) {
      const auto& list = lists_[k].*cells;
      for (Index n = 0; n < list.size(); ++n) {
        const float value = values[list[n]];
        std::memcpy(&transfers[k].to[n * sizeof(float)], &value, sizeof(float));
      }
    }
  }
  static float read(const Transfer& transfer, Index n) {
    float value = 0;
    std::memcpy(&value, &transfer.from[n * sizeof(float)], sizeof(float));
    return value;
  }

  static HYPRE_ParCSRMatrix parcsr(HYPRE_IJMatrix matrix) {
    void* object = nullptr;
    HYPRE_IJMatrixGetObject(matrix, &object);
    return static_cast<HYPRE_ParCSRMatrix>(object);
  }
  static HYPRE_ParVector parcsr(HYPRE_IJVector vector) {
    void* object = nullptr;
    HYPRE_IJVectorGetObject(vector, &object);
    return static_cast<HYPRE_ParVector>(object);
  }
  void release() {
    if (multigrid_) HYPRE_BoomerAMGDestroy(multigrid_);
    if (matrix_) HYPRE_IJMatrixDestroy(matrix_);
    for (HYPRE_IJVector vector : {b_, x_}) {
      if (vector) HYPRE_IJVectorDestroy(vector);
    }
    multigrid_ = nullptr;
    matrix_ = nullptr;
    b_ = x_ = nullptr;
  }

  static constexpr int none = -1;

  const World* world_ = nullptr;
  std::optional<Agreement> agree_;
  std::map<Cell, int> owners_;     // of the cells here
  std::map<Cell, int> directory_;  // of those of which this process is the directory
  Level level_;
  std::optional<Index> is_known_for_;  // number of cells
  std::vector<std::uint32_t> own_;
  std::vector<HYPRE_BigInt> numbers_;  // of all cells here
  std::vector<List> lists_;
  std::vector<Transfer> to_owners_, to_users_;
  std::vector<MPI_Request> requests_;
  HYPRE_BigInt first_ = 0;
  std::vector<HYPRE_BigInt> rows_;
  std::vector<double> vector_;
  HYPRE_Solver multigrid_ = nullptr;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector b_ = nullptr;
  HYPRE_IJVector x_ = nullptr;
};

}  // namespace silt::mpi
