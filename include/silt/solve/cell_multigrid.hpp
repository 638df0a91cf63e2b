// SPDX-License-Identifier: MIT
// Additive multigrid on background cells, a preconditioner for the pressure equation of particles.
//
// Because the stencil of MPS is wide, only smooth errors remain after one division by the diagonal,
// and smooth errors are resolved on cells of two spacings. Therefore
//
//     z = D⁻¹ r + P V(Pᵀ r)
//
// with P the linear interpolation from the centres of the occupied cells, and V one V-cycle over
// the cells and their coarsenings:
//
//     particles   · ·· · · ·· ·        Σ_j w_ij (p_i − p_j)
//     level 0     | □ | □ | □ | □ |    5 (7) points; conductances from the second moments of w
//     …                                see cell_cycle.hpp
//
// Bitwise identical for any number of threads.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_cycle.hpp>
#include <silt/solve/cell_interpolation.hpp>
#include <silt/solve/cell_level.hpp>
#include <silt/solve/cell_multigrid_settings.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace silt {

/// Cycle does the V-cycle over the cells:
///
///   cycle.finest()    the finest CellLevel, to be filled except for its diagonal
///   cycle.prepare()   once it is filled
///   cycle.solve()     x = V b of the finest level
/// If processes share the cells, as in mpi::SharedCellCycle,
///
///   cycle.share(system, occupied, corners)   the occupied cells that a process has to know, from
///   those
///                                            that its unknowns occupy and interpolate from
///   cycle.add_of_others(cells, values)       of numbered cells, adds those of other processes
template <int Dim, class Cycle = CellCycle<Dim>>
class CellMultigrid {
 public:
  using Settings = CellMultigridSettings;
  static constexpr bool shares_unknowns = requires(
      Cycle cycle, const LinearSystem& system, std::span<const GridCell<Dim>> cells) {
    cycle.share(system, cells, cells);
  };

  CellMultigrid() = default;
  /// Throws if the settings are out of range.
  explicit CellMultigrid(const Settings& settings) : settings_(settings), cycle_(settings) {
    settings.check();
  }

  /// If the system has no geometry, only the diagonal is used.
  void prepare(const LinearSystem& system) {
    inverse_.resize(system.size());
    for_each(system.size(), [&](Index i) { inverse_[i] = 1 / system.diagonal[i]; });
    uses_cells_ = !system.geometry.points.empty() || shares_unknowns;
    if (!uses_cells_) return;
    build_finest_level(system);
    cycle_.prepare();
  }

  void apply(const std::vector<double>& r, std::vector<double>& z) { apply_and_multiply(r, z); }
  /// As apply(); returns r·z [-].
  double apply_and_multiply(const std::vector<double>& r, std::vector<double>& z) {
    Level& finest = cycle_.finest();
    if (uses_cells_) {
      to_particles_.restrict_to(finest.b, r.data());
      cycle_.solve();
    }
    if (uses_cells_ && finest.size() > 0) {
      return to_particles_.interpolate(finest.x, inverse_.data(), r.data(), z.data());
    }
    return ordered_sum(r.size(), 0.0, [&](Index i) {
      z[i] = inverse_[i] * r[i];
      return r[i] * z[i];
    });
  }

  /// Number of levels in the last solve; 0 if it was done without cells.
  Index levels() const noexcept { return uses_cells_ ? cycle_.levels() : 0; }

 private:
  using Level = CellLevel<Dim>;
  using Point = std::array<double, Dim>;

  void build_finest_level(const LinearSystem& system) {
    const auto& geometry = system.geometry;
    const double per_edge = 1 / (settings_.cell_size * geometry.spacing);
    const auto takes_part = [&](Index i) {
      return system.diagonal[i] >= settings_.min_diagonal * geometry.full_diagonal;
    };
    const auto point = [&](Index i) {
      Point x;
      for (std::size_t k = 0; k < Dim; ++k) x[k] = geometry.points[i][k] * per_edge;
      return x;
    };
    to_particles_.locate(system.size(), point, takes_part);
    const auto number_cells = [&] {
      to_particles_.occupied_cells(occupied_);
      if constexpr (!shares_unknowns) finest_cells_.number(occupied_, CellOrder::chessboard);
    };
    for_each_task(2, [&](Index task) { task == 0 ? number_cells() : to_particles_.sort(); });
    if constexpr (shares_unknowns) {
      finest_cells_.number(cycle_.share(system, occupied_, to_particles_.corner_cells()),
                           CellOrder::chessboard);
    }
    to_particles_.build(finest_cells_);
    Level& level = cycle_.finest();
    level.reset(finest_cells_.size());
    level.cells.assign(finest_cells_.cells());
    level.reds = finest_cells_.reds();

    // The masses m_i = Σ w_ij to the free surface and the stiffnesses ½ Σ_j w_ij Δx²/edge² of the
    // particles are distributed to the cells by Pᵀ; a link has the mean stiffness of its cells. The
    // second moment of an incomplete stencil is scaled with its sum of weights.
    to_particles_.restrict_to(level.mass, geometry.to_surface.data());
    const double scale = geometry.second_moment / (2 * squared(settings_.cell_size));
    stiffness_of_points_.resize(system.size());
    for_each(system.size(), [&](Index i) {
      stiffness_of_points_[i] =
          static_cast<float>(scale * (system.diagonal[i] - double(geometry.to_surface[i])));
    });
    stiffness_.resize(level.size());
    to_particles_.restrict_to(stiffness_, stiffness_of_points_.data());
    if constexpr (shares_unknowns) {
      cycle_.add_of_others(finest_cells_, level.mass);
      cycle_.add_of_others(finest_cells_, stiffness_);
    }
    level.links.build(level.size(), [&](Index c, auto&& add) {
      for (std::size_t k = 0; k < Dim; ++k) {
        for (const bool behind : {false, true}) {
          const std::uint32_t other = finest_cells_.beside(level.cells[c], k, behind);
          if (other == BackgroundCells<Dim>::none) continue;
          const float conductance = (stiffness_[c] + stiffness_[other]) / 2;
          if (conductance > 0) add({other, conductance});
        }
      }
    });
  }

  Settings settings_;
  Buffer<double> inverse_;  // of the system's diagonal
  Buffer<GridCell<Dim>> occupied_;
  BackgroundCells<Dim> finest_cells_;
  CellInterpolation<Dim> to_particles_;
  Buffer<float> stiffness_of_points_;
  Buffer<float> stiffness_;  // by finest cell
  Cycle cycle_;
  bool uses_cells_ = false;
};

}  // namespace silt
