// SPDX-License-Identifier: MIT
// Additive multigrid on background cells as preconditioner for the pressure equation of particles.
//
// The wide stencil of MPS leaves only smooth errors after one division by the diagonal, and smooth
// errors are seen as well on cells of two spacings. So
//
//     z = D⁻¹ r + P V(Pᵀ r)
//
// with P the linear interpolation from the centres of the occupied cells, and V one V-cycle over the
// cells and their coarsenings:
//
//     particles   · ·· · · ·· ·        Σ_j w_ij (p_i − p_j)
//     level 0     | □ | □ | □ | □ |    5 (7) points; conductances from the second moments of w
//     level 1     |   □   |   □   |    edges doubled; conductances: half the sum of those crossed
//     …           until few cells are left, which are solved directly
//
// Single precision inside; sweeps are red–black, before the correction in one order and after it in
// the other, so that V is symmetric. The same bits for any number of threads.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/linear_system.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/cell_level.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace silt {

template <int Dim>
class CellMultigrid {
 public:
  struct Settings {
    double cell = 2;               ///< edge of the finest cells over the particle spacing [-]
    double weak = 0.2;             ///< rows below this share of a full diagonal stay out [-]
    int sweeps = 2;                ///< before and after each correction
    Index solved_directly = 16;    ///< cells of the coarsest level, at most 64
  };

  CellMultigrid() = default;
  /// Throws if the settings are out of range.
  explicit CellMultigrid(const Settings& settings) : settings_(settings) {
    require_between("CellMultigrid: cell", settings.cell, {1, 16});
    require_between("CellMultigrid: weak", settings.weak, {0, 1});
    require_between("CellMultigrid: sweeps", settings.sweeps, {1, 16});
    require_between("CellMultigrid: solved_directly", double(settings.solved_directly),
                    {1, double(most_directly)});
  }

  /// Without the system's geometry, the diagonal alone.
  void prepare(const LinearSystem& system) {
    inverse_.resize(system.size());
    for_each(system.size(), [&](Index i) { inverse_[i] = 1 / system.diagonal[i]; });
    used_ = 0;
    if (system.geometry.points.empty()) return;
    lay_finest_cells(system);
    while (coarsest().size() > settings_.solved_directly && coarsen()) {
    }
    invert_coarsest();
  }

  void apply(const std::vector<double>& r, std::vector<double>& z) {
    if (used_ == 0 || levels_[0].size() == 0) {
      for_each(r.size(), [&](Index i) { z[i] = inverse_[i] * r[i]; });
      return;
    }
    Level& finest = levels_[0];
    finest.to_finer.restrict_to(finest.b, [&](Index i) { return r[i]; });
    cycle(0);
    finest.to_finer.interpolate(finest.x, [&](Index i, float correction) {
      z[i] = inverse_[i] * r[i] + double(correction);
    });
  }

  Index levels() const noexcept { return used_; }

 private:
  using Level = CellLevel<Dim>;
  using Point = std::array<double, Dim>;
  // Of few cells, so that it needs no memory of the heap.
  static constexpr int most_directly = 64;
  template <class Real>
  using SmallMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                    most_directly, most_directly>;

  Level& add_level() {
    if (used_ == levels_.size()) levels_.emplace_back();
    return levels_[used_++];
  }
  Level& coarsest() { return levels_[used_ - 1]; }

  void lay_finest_cells(const LinearSystem& system) {
    const auto& geometry = system.geometry;
    const double edge = settings_.cell * geometry.spacing;
    const auto takes_part = [&](Index i) {
      return system.diagonal[i] >= settings_.weak * geometry.full_diagonal;
    };
    const auto point = [&](Index i) {
      Point x;
      for (std::size_t k = 0; k < Dim; ++k) x[k] = geometry.points[i][k] / edge;
      return x;
    };
    occupied_.clear();
    for (Index i = 0; i < system.size(); ++i) {
      if (takes_part(i)) occupied_.push_back(cell_at(point(i)));
    }
    Level& level = add_level();
    level.cells.number(occupied_, CellOrder::chessboard);
    level.lay_out();
    level.to_finer.build(system.size(), level.cells, point, takes_part);

    // The particles' masses m_i = Σ w_ij to the free surface and stiffnesses ½ Σ_j w_ij Δx² / edge²
    // along each axis, shared among the cells as the residual is; a face has the mean of its cells'.
    level.to_finer.restrict_to(level.mass, [&](Index i) { return geometry.to_surface[i]; });
    const float scale = float(1 / (2 * squared(settings_.cell)));
    for (std::size_t k = 0; k < Dim; ++k) {
      level.to_finer.restrict_to(level.b, [&](Index i) { return geometry.second_moments[i][k]; });
      for_each(level.size(), [&](Index c) {
        for (const Index f : {2 * k, 2 * k + 1}) {
          const Index other = level.beside[c][f];
          if (other != c) level.conductance[c][f] = scale * (level.b[c] + level.b[other]) / 2;
        }
      });
    }
    level.finish(1e-6f);
  }

  static GridCell<Dim> cell_at(const Point& x) {
    GridCell<Dim> cell;
    for (std::size_t k = 0; k < Dim; ++k) cell[k] = std::int64_t(std::floor(x[k]));
    return cell;
  }

  // The next level; false where it would hardly be smaller.
  bool coarsen() {
    const Index n = coarsest().size();
    occupied_.resize(n);
    for_each(n, [&](Index c) {
      for (std::size_t k = 0; k < Dim; ++k) occupied_[c][k] = coarsest().cells.cells()[c][k] >> 1;
    });
    Level& coarse = add_level();
    Level& fine = levels_[used_ - 2];
    coarse.cells.number(occupied_, CellOrder::chessboard);
    if (coarse.size() * 4 > n * 3) {
      --used_;
      return false;
    }
    coarse.lay_out();
    coarse.to_finer.build(
        n, coarse.cells,
        [&](Index c) {
          Point x;
          for (std::size_t k = 0; k < Dim; ++k) x[k] = (double(fine.cells.cells()[c][k]) + 0.5) / 2;
          return x;
        },
        [](Index) { return true; });
    for_each(coarse.size(), [&](Index parent) { sum_children(fine, coarse, parent); });
    coarse.finish(1e-6f * std::pow(4.0f, float(used_ - 1)));
    return true;
  }

  static void sum_children(const Level& fine, Level& coarse, Index parent) {
    for (Index child = 0; child < Index(1) << Dim; ++child) {
      GridCell<Dim> cell = coarse.cells.cells()[parent];
      for (std::size_t k = 0; k < Dim; ++k) cell[k] = 2 * cell[k] + std::int64_t((child >> k) & 1);
      const std::uint32_t c = fine.cells.find(cell);
      if (c == BackgroundCells<Dim>::none) continue;
      coarse.mass[parent] += fine.mass[c];
      for (std::size_t k = 0; k < Dim; ++k) {
        const Index outer = 2 * k + ((child >> k) & 1);
        coarse.conductance[parent][outer] += fine.conductance[c][outer] / 2;
      }
    }
  }

  // Where coarsening ends early, a few more are as well.
  static bool is_solved_directly(const Level& level) { return level.size() <= most_directly; }

  void invert_coarsest() {
    const Level& level = coarsest();
    if (!is_solved_directly(level)) return;
    const auto n = static_cast<Eigen::Index>(level.size());
    SmallMatrix<double> A = SmallMatrix<double>::Zero(n, n);
    for (Index c = 0; c < level.size(); ++c) {
      const auto row = static_cast<Eigen::Index>(c);
      A(row, row) = level.diagonal[c] > 0 ? double(level.diagonal[c]) : 1;
      for (Index f = 0; f < Level::faces; ++f) {
        const Index other = level.beside[c][f];
        if (other != c) A(row, static_cast<Eigen::Index>(other)) -= double(level.conductance[c][f]);
      }
    }
    const SmallMatrix<double> inverse = A.llt().solve(SmallMatrix<double>::Identity(n, n));
    coarsest_inverse_ = inverse.template cast<float>();
  }

  void cycle(Index l) {
    Level& level = levels_[l];
    const bool is_coarsest = l + 1 == used_;
    if (is_coarsest && is_solved_directly(level)) {
      const auto n = static_cast<Eigen::Index>(level.size());
      Eigen::Map<Eigen::VectorXf>(level.x.data(), n).noalias() =
          coarsest_inverse_ * Eigen::Map<const Eigen::VectorXf>(level.b.data(), n);
      return;
    }
    std::fill(level.x.begin(), level.x.end(), 0.0f);
    for (int sweep = 0; sweep < settings_.sweeps; ++sweep) {
      level.relax(Level::red);
      level.relax(Level::black);
    }
    if (!is_coarsest) {
      Level& coarse = levels_[l + 1];
      level.find_residual();
      coarse.to_finer.restrict_to(coarse.b, [&](Index c) { return level.r[c]; });
      cycle(l + 1);
      coarse.to_finer.interpolate(coarse.x, [&](Index c, float correction) {
        level.x[c] += correction;
      });
    }
    for (int sweep = 0; sweep < settings_.sweeps; ++sweep) {
      level.relax(Level::black);
      level.relax(Level::red);
    }
  }

  Settings settings_;
  std::vector<double> inverse_;  // of the system's diagonal
  std::vector<Level> levels_;    // those of earlier systems keep their memory
  Index used_ = 0;
  std::vector<GridCell<Dim>> occupied_;
  SmallMatrix<float> coarsest_inverse_;
};

}  // namespace silt
