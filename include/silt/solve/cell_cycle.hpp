// SPDX-License-Identifier: MIT
// One V-cycle over the background cells of a multigrid and their coarsenings,
//
//     level 0     | □ | □ | □ | □ |    5 (7) points; conductances from the second moments of w
//     level 1     |   □   |   □   |    edges doubled, see cell_coarsening.hpp
//     …           until few cells are left, for which a direct solver is used
//
// in single precision. Sweeps are red–black before the coarse correction and black–red after it, so
// that it is symmetric; between them, the residual is in the red cells, and only their corrections
// have an effect. Bitwise identical for any number of threads.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/eigen.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_coarsening.hpp>
#include <silt/solve/cell_level.hpp>
#include <silt/solve/cell_multigrid_settings.hpp>

#include <algorithm>
#include <cmath>

namespace silt {

/// The cells of one process.
template <int Dim>
class CellCycle {
 public:
  using Level = CellLevel<Dim>;
  /// Maximum number of cells of a direct solve, so that its matrix needs no heap memory.
  static constexpr int max_direct = CellMultigridSettings::max_direct;

  CellCycle() = default;
  /// Settings must be valid.
  explicit CellCycle(const CellMultigridSettings& settings) : settings_(settings) {}

  // See CellMultigrid.

  Level& finest() {
    if (levels_.empty()) levels_.emplace_back();
    return levels_[0];
  }
  void prepare() {
    finest().finish(CellMultigridSettings::min_mass);
    used_ = 1;
    while (coarsest().size() > settings_.max_coarsest_cells && coarsen()) {
    }
    invert_coarsest();
  }
  void solve() {
    if (levels_[0].size() > 0) cycle(0);
  }

  /// Number of levels, with the finest one.
  Index levels() const noexcept { return used_; }

 private:
  template <class Real>
  using SmallMatrix =
      Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, max_direct, max_direct>;

  Level& coarsest() { return levels_[used_ - 1]; }

  // Adds a coarser level; false if it would not be sufficiently smaller.
  bool coarsen() {
    if (used_ == levels_.size()) levels_.emplace_back();
    if (coarsenings_.size() < used_) coarsenings_.emplace_back();
    Level& coarse = levels_[used_];
    if (!coarsenings_[used_ - 1].build(levels_[used_ - 1], coarse)) return false;
    coarse.finish(CellMultigridSettings::min_mass * std::pow(4.0f, float(used_)));
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

  void solve_coarsest(const Buffer<float>& b, Buffer<float>& x) const {
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
    level.relax_reds_from_zero();
    level.relax(Level::black);
    for (int sweep = 1; sweep < settings_.sweeps; ++sweep) {
      level.relax(Level::red);
      level.relax(Level::black);
    }
    if (!is_coarsest) {
      Level& coarse = levels_[l + 1];
      level.find_red_residual();
      coarsenings_[l].restrict_to(coarse.b, level.r);
      cycle(l + 1);
      coarsenings_[l].add_interpolated(coarse.x, level.x);
    }
    for (int sweep = 0; sweep < settings_.sweeps; ++sweep) {
      level.relax(Level::black);
      level.relax(Level::red);
    }
  }

  CellMultigridSettings settings_;
  Buffer<Level> levels_;  // only the first used_ are valid; the others keep their memory
  Buffer<CellCoarsening<Dim>> coarsenings_;  // from each level to the next
  Index used_ = 0;                           // number of levels
  SmallMatrix<float> coarsest_inverse_;
};

}  // namespace silt
