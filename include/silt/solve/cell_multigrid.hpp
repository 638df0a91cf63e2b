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
//     level 1     |   □   |   □   |    edges doubled, see cell_coarsening.hpp
//     …           until few cells are left, for which a direct solver is used
//
// V is computed in single precision. Sweeps are red–black before the coarse correction and
// black–red after it, so that V is symmetric. Bitwise identical for any number of threads.
#pragma once

#include <silt/core/eigen.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_coarsening.hpp>
#include <silt/solve/cell_interpolation.hpp>
#include <silt/solve/cell_level.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace silt {

template <int Dim>
class CellMultigrid {
 public:
  struct Settings {
    double cell_size = 2;  ///< edge of the finest cells, in particle spacings [-]
    /// Rows with a smaller diagonal, relative to that of a full neighbourhood, are not part of
    /// V [-].
    double min_diagonal = 0.2;
    int sweeps = 2;                 ///< before and after each correction
    Index max_coarsest_cells = 16;  ///< coarsening stops at this number of cells, at most 64
  };

  CellMultigrid() = default;
  /// Throws if the settings are out of range.
  explicit CellMultigrid(const Settings& settings) : settings_(settings) {
    require_between("CellMultigrid: cell_size", settings.cell_size, {1, 16});
    require_between("CellMultigrid: min_diagonal", settings.min_diagonal, {0, 1});
    require_between("CellMultigrid: sweeps", settings.sweeps, {1, 16});
    require_between("CellMultigrid: max_coarsest_cells", double(settings.max_coarsest_cells),
                    {1, double(max_direct)});
  }

  /// If the system has no geometry, only the diagonal is used.
  void prepare(const LinearSystem& system) {
    inverse_.resize(system.size());
    for_each(system.size(), [&](Index i) { inverse_[i] = 1 / system.diagonal[i]; });
    used_ = 0;
    if (system.geometry.points.empty()) return;
    build_finest_level(system);
    while (coarsest().size() > settings_.max_coarsest_cells && coarsen()) {
    }
    invert_coarsest();
  }

  void apply(const std::vector<double>& r, std::vector<double>& z) {
    if (used_ == 0 || levels_[0].size() == 0) {
      for_each(r.size(), [&](Index i) { z[i] = inverse_[i] * r[i]; });
      return;
    }
    Level& finest = levels_[0];
    to_particles_.restrict_to(finest.b, [&](Index i) { return r[i]; });
    cycle(0);
    to_particles_.interpolate(finest.x, [&](Index i, float correction) {
      z[i] = inverse_[i] * r[i] + double(correction);
    });
  }

  Index levels() const noexcept { return used_; }

 private:
  using Level = CellLevel<Dim>;
  using Point = std::array<double, Dim>;
  // Maximum number of cells of a direct solve, so that its matrix needs no heap memory.
  static constexpr int max_direct = 64;
  // Minimum mass of a cell over the sum of its conductances, on the finest level.
  static constexpr float min_mass = 1e-6f;
  template <class Real>
  using SmallMatrix =
      Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, max_direct, max_direct>;

  Level& coarsest() { return levels_[used_ - 1]; }

  void build_finest_level(const LinearSystem& system) {
    const auto& geometry = system.geometry;
    const double edge = settings_.cell_size * geometry.spacing;
    const auto takes_part = [&](Index i) {
      return system.diagonal[i] >= settings_.min_diagonal * geometry.full_diagonal;
    };
    const auto point = [&](Index i) {
      Point x;
      for (std::size_t k = 0; k < Dim; ++k) x[k] = geometry.points[i][k] / edge;
      return x;
    };
    const auto number_cells = [&] {
      occupied_.clear();
      for (Index i = 0; i < system.size(); ++i) {
        if (takes_part(i)) occupied_.push_back(cell_at(point(i)));
      }
      finest_cells_.number(occupied_, CellOrder::chessboard);
    };
    const auto sort_points = [&] { to_particles_.sort(system.size(), point, takes_part); };
    for_each_task(2, [&](Index task) { task == 0 ? number_cells() : sort_points(); });
    to_particles_.build(finest_cells_, point);
    if (levels_.empty()) levels_.emplace_back();
    used_ = 1;
    Level& level = levels_[0];
    level.reset(finest_cells_.size());
    level.cells.assign(finest_cells_.cells().begin(), finest_cells_.cells().end());
    level.reds = finest_cells_.reds();

    // The masses m_i = Σ w_ij to the free surface and the stiffnesses ½ Σ_j w_ij Δx²/edge² of the
    // particles are distributed to the cells by Pᵀ; a link has the mean stiffness of its cells. The
    // second moment of an incomplete stencil is scaled with its sum of weights.
    to_particles_.restrict_to(level.mass, [&](Index i) { return geometry.to_surface[i]; });
    const double scale = geometry.second_moment / (2 * squared(settings_.cell_size));
    stiffness_.resize(level.size());
    to_particles_.restrict_to(stiffness_, [&](Index i) {
      return scale * (system.diagonal[i] - double(geometry.to_surface[i]));
    });
    level.links.build(level.size(), [&](Index c, auto&& add) {
      for (std::size_t k = 0; k < Dim; ++k) {
        for (const std::int64_t direction : {-1, 1}) {
          GridCell<Dim> next = level.cells[c];
          next[k] += direction;
          const std::uint32_t other = finest_cells_.find(next);
          if (other == BackgroundCells<Dim>::none) continue;
          const float conductance = (stiffness_[c] + stiffness_[other]) / 2;
          if (conductance > 0) add({other, conductance});
        }
      }
    });
    level.finish(min_mass);
  }

  static GridCell<Dim> cell_at(const Point& x) {
    GridCell<Dim> cell;
    for (std::size_t k = 0; k < Dim; ++k) cell[k] = std::int64_t(std::floor(x[k]));
    return cell;
  }

  // Adds a coarser level; false if it would not be sufficiently smaller.
  bool coarsen() {
    if (used_ == levels_.size()) levels_.emplace_back();
    if (coarsenings_.size() < used_) coarsenings_.emplace_back();
    Level& coarse = levels_[used_];
    if (!coarsenings_[used_ - 1].build(levels_[used_ - 1], coarse)) return false;
    coarse.finish(min_mass * std::pow(4.0f, float(used_)));
    ++used_;
    return true;
  }

  // Also applied if coarsening ended with more than max_coarsest_cells.
  static bool has_direct_solve(const Level& level) { return level.size() <= max_direct; }

  void invert_coarsest() {
    const Level& level = coarsest();
    if (!has_direct_solve(level)) return;
    const auto n = static_cast<Eigen::Index>(level.size());
    SmallMatrix<double> A = SmallMatrix<double>::Zero(n, n);
    for (Index c = 0; c < level.size(); ++c) {
      const auto row = static_cast<Eigen::Index>(c);
      A(row, row) = level.diagonal[c] > 0 ? double(level.diagonal[c]) : 1;
      for (const auto& [other, conductance] : level.links[c]) {
        A(row, static_cast<Eigen::Index>(other)) -= double(conductance);
      }
    }
    invert(A);
    coarsest_inverse_ = A.template cast<float>();
  }

  // Gauss–Jordan elimination of a symmetric positive definite matrix, which needs no pivoting. Not
  // by Eigen, whose products are fused multiply-adds on some processors.
  static void invert(SmallMatrix<double>& A) {
    const Eigen::Index n = A.rows();
    for (Eigen::Index k = 0; k < n; ++k) {
      const double pivot = A(k, k);
      A(k, k) = 1;
      for (Eigen::Index i = 0; i < n; ++i) A(i, k) /= pivot;
      for (Eigen::Index j = 0; j < n; ++j) {
        if (j == k) continue;
        const double factor = A(k, j);
        A(k, j) = 0;
        for (Eigen::Index i = 0; i < n; ++i) A(i, j) -= A(i, k) * factor;
      }
    }
  }

  void solve_coarsest(const std::vector<float>& b, std::vector<float>& x) const {
    std::fill(x.begin(), x.end(), 0.0f);
    for (Index j = 0; j < b.size(); ++j) {
      const float* const column = coarsest_inverse_.col(static_cast<Eigen::Index>(j)).data();
      for (Index i = 0; i < x.size(); ++i) x[i] += column[i] * b[j];
    }
  }

  void cycle(Index l) {
    Level& level = levels_[l];
    const bool is_coarsest = l + 1 == used_;
    if (is_coarsest && has_direct_solve(level)) {
      solve_coarsest(level.b, level.x);
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
      coarsenings_[l].restrict_to(coarse.b, level.r);
      cycle(l + 1);
      coarsenings_[l].add_interpolated(coarse.x, level.x);
    }
    for (int sweep = 0; sweep < settings_.sweeps; ++sweep) {
      level.relax(Level::black);
      level.relax(Level::red);
    }
  }

  Settings settings_;
  std::vector<double> inverse_;  // of the system's diagonal
  std::vector<GridCell<Dim>> occupied_;
  BackgroundCells<Dim> finest_cells_;
  CellInterpolation<Dim> to_particles_;
  std::vector<float> stiffness_;  // by finest cell
  std::vector<Level> levels_;     // only the first used_ are valid; the others keep their memory
  std::vector<CellCoarsening<Dim>> coarsenings_;  // from each level to the next
  Index used_ = 0;                                // number of levels
  SmallMatrix<float> coarsest_inverse_;
};

}  // namespace silt
