// SPDX-License-Identifier: MIT
// The V-cycle over background cells that several processes share, by the library hypre (BoomerAMG).
//
//   owner   one process for each cell: it has its equation, a row of the matrix     cell_owners.hpp
//   users   all that occupy a cell, interpolate from it, or own one beside it       cell_exchange.hpp
//
// Sums over the particles in a cell go from users to owners, corrections from owners to users.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/cell_exchange.hpp>
#include <silt/mpi/cell_owners.hpp>
#include <silt/mpi/world.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_level.hpp>
#include <silt/solve/cell_multigrid_settings.hpp>
#include <silt/solve/hypre_multigrid.hpp>

#include <HYPRE.h>

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace silt::mpi {

/// For systems whose SharedUnknowns are those of particles of distribute(), see CellMultigrid. Copies
/// need their own share() and prepare().
template <int Dim>
class SharedCellCycle {
 public:
  using Level = CellLevel<Dim>;
  using Cell = GridCell<Dim>;

  SharedCellCycle() = default;
  /// The settings have no effect: hypre has its own.
  explicit SharedCellCycle(const CellMultigridSettings&) {}

  std::vector<Cell> share(const LinearSystem& system, std::span<const Cell> occupied,
                          std::span<const Cell> corners) {
    world_ = static_cast<const World*>(system.shared->processes);
    agree_.emplace(*world_);
    has_users_ = false;
    owners_.clear();
    std::map<Cell, bool> used;  // and whether they are occupied here
    for (const Cell& cell : corners) used[cell] = false;
    for (const Cell& cell : occupied) used[cell] = true;
    owners_.find(*world_, *agree_, used);
    std::map<Cell, bool> beside;
    for (const auto& [cell, owner] : owners_.all()) {
      if (owner != world_->rank()) continue;
      for_each_beside(cell, [&](const Cell& next) {
        if (!used.contains(next)) beside[next] = false;
      });
    }
    owners_.find(*world_, *agree_, beside);
    std::vector<Cell> cells;
    for (const auto& [cell, owner] : owners_.all()) cells.push_back(cell);
    return cells;
  }

  template <class Values>
  void add_of_others(const BackgroundCells<Dim>& cells, Values& values) {
    if (!has_users_) exchange_.find(*world_, *agree_, cells, owners_);
    has_users_ = true;
    (*agree_)();
    exchange_.add_to_owners(values);
    exchange_.give_to_users(values);
  }

  Level& finest() { return level_; }

  /// Throws if hypre fails, or cannot number the cells.
  void prepare() {
    if (exchange_.all() > double(std::numeric_limits<HYPRE_BigInt>::max())) {
      fail("mpi: " + to_text(exchange_.all()) +
           " cells of the pressure solver are more than this hypre can number; build hypre with "
           "64-bit integers");
    }
    (*agree_)([&] {
      level_.finish(CellMultigridSettings::min_mass);
      matrix_.clear();
      matrix_.first_row = HYPRE_BigInt(exchange_.first());
      for (const std::uint32_t c : exchange_.own()) {
        matrix_.add_row();
        matrix_.add(number(c), level_.diagonal[c] > 0 ? double(level_.diagonal[c]) : 1);
        for (const auto& [other, conductance] : level_.links[c]) {
          matrix_.add(number(other), -double(conductance));
        }
      }
      b_.resize(exchange_.own().size());
      x_.resize(b_.size());
      multigrid_.set_rows(matrix_);
      return Reduced();
    });
    // One aggressive level halves the time of many cells, with 8 % more iterations; few take no time.
    const bool are_many = exchange_.all() > 4096;
    multigrid_.prepare(world_->communicator(), matrix_, {.aggressive_levels = are_many ? 1 : 0});
  }

  // The solver has just made an agreement.
  void solve() {
    const auto& own = exchange_.own();
    exchange_.add_to_owners(level_.b);
    for (Index k = 0; k < own.size(); ++k) b_[k] = double(level_.b[own[k]]);
    multigrid_.cycle(b_, x_);
    for (Index k = 0; k < own.size(); ++k) level_.x[own[k]] = float(x_[k]);
    exchange_.give_to_users(level_.x);
  }

  /// As hypre's are not known: 1.
  Index levels() const noexcept { return 1; }

 private:
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
  HYPRE_BigInt number(Index cell) const { return HYPRE_BigInt(exchange_.number(cell)); }

  const World* world_ = nullptr;
  std::optional<Agreement> agree_;
  CellOwners<Dim> owners_;
  CellExchange<Dim> exchange_;
  bool has_users_ = false;
  Level level_;
  silt::detail::HypreMatrix matrix_;
  silt::detail::HypreMultigrid multigrid_;
  std::vector<double> b_, x_;
};

}  // namespace silt::mpi
