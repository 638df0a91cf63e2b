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
#include <silt/solve/background_cells.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace silt {

template <int Dim>
class CellMultigrid {
 public:
  struct Settings {
    double cell = 2;               ///< edge of the finest cells over the particle spacing [-]
    double weak = 0.2;             ///< rows below this share of a full diagonal stay out [-]
    int sweeps = 2;                ///< before and after each correction
    Index solved_directly = 150;   ///< cells of the coarsest level
  };

  CellMultigrid() = default;
  /// Throws if the settings are out of range.
  explicit CellMultigrid(const Settings& settings) : settings_(settings) {
    require_between("CellMultigrid: cell", settings.cell, {1, 16});
    require_between("CellMultigrid: weak", settings.weak, {0, 1});
    require_between("CellMultigrid: sweeps", settings.sweeps, {1, 16});
    require_positive("CellMultigrid: solved_directly", double(settings.solved_directly));
  }

  /// Without the system's geometry, the diagonal alone.
  void prepare(const LinearSystem& system) {
    inverse_.resize(system.size());
    for_each(system.size(), [&](Index i) { inverse_[i] = 1 / system.diagonal[i]; });
    levels_.clear();
    if (system.geometry.points.empty()) return;
    lay_finest_cells(system);
    while (levels_.back().size() > settings_.solved_directly && coarsen()) {
    }
    invert_coarsest();
  }

  void apply(const std::vector<double>& r, std::vector<double>& z) {
    if (levels_.empty() || levels_[0].size() == 0) {
      for_each(r.size(), [&](Index i) { z[i] = inverse_[i] * r[i]; });
      return;
    }
    Level& finest = levels_[0];
    for_each(finest.size(), [&](Index c) {
      float sum = 0;
      for (Index k = finest.first_below[c]; k < finest.first_below[c + 1]; ++k) {
        sum += finest.share_below[k] * float(r[finest.below[k]]);
      }
      finest.b[c] = sum;
    });
    cycle(0);
    for_each(r.size(), [&](Index i) {
      float sum = 0;
      for (int k = 0; k < corners; ++k) {
        const Corner& corner = from_finest_[i * corners + static_cast<Index>(k)];
        sum += corner.share * finest.x[corner.cell];
      }
      z[i] = inverse_[i] * r[i] + double(sum);
    });
  }

  Index levels() const noexcept { return levels_.size(); }

 private:
  static constexpr int corners = 1 << Dim;
  static constexpr int faces = 2 * Dim;
  using Cell = GridCell<Dim>;
  using Numbering = BackgroundCells<Dim>;

  // Share of a coarse value in a fine one; a share of 0 stands for a missing cell.
  struct Corner {
    std::uint32_t cell = 0;
    float share = 0;
  };

  struct Level {
    std::vector<Cell> cells;           // red ones first
    Index reds = 0;
    std::vector<std::uint32_t> beside;  // by face: 2 k and 2 k + 1 along axis k; itself where none
    std::vector<float> conductance;     // by face, 0 where none
    std::vector<float> mass;
    std::vector<float> diagonal;
    std::vector<float> inverse;         // of the diagonal
    std::vector<float> x, b, r;
    std::vector<Corner> from_above;     // interpolation from the next coarser level
    // Transposed interpolation from this level to what is below it, particles or finer cells.
    std::vector<Index> first_below;
    std::vector<std::uint32_t> below;
    std::vector<float> share_below;

    Index size() const { return cells.size(); }
  };

  void lay_finest_cells(const LinearSystem& system) {
    const auto& geometry = system.geometry;
    const double h = settings_.cell * geometry.spacing;
    const Index n = system.size();
    const auto takes_part = [&](Index i) {
      return system.diagonal[i] >= settings_.weak * geometry.full_diagonal;
    };
    const auto at = [&](Index i, int k) { return geometry.points[i][Index(k)] / h; };

    std::vector<Cell> cells(n);
    std::vector<Cell> occupied;
    for_each(n, [&](Index i) {
      if (!takes_part(i)) return;
      for (int k = 0; k < Dim; ++k) cells[i][Index(k)] = std::int64_t(std::floor(at(i, k)));
    });
    for (Index i = 0; i < n; ++i) {
      if (takes_part(i)) occupied.push_back(cells[i]);
    }
    Numbering numbering(std::move(occupied));
    Level& level = add_level(numbering);

    // K_a = ½ Σ_i Σ_j w_ij Δx_a² / h², and Σ_i of the weights to the free surface.
    std::vector<std::array<double, Dim>> stiffness(level.size(), std::array<double, Dim>{});
    std::vector<double> masses(level.size(), 0.0);
    for (Index i = 0; i < n; ++i) {
      if (!takes_part(i)) continue;
      const Index c = numbering.find(cells[i]);
      for (int k = 0; k < Dim; ++k) {
        stiffness[c][Index(k)] += geometry.second_moments[i][Index(k)] / (2 * h * h);
      }
      masses[c] += geometry.to_surface[i];
    }
    for (Index c = 0; c < level.size(); ++c) {
      level.mass[c] = float(masses[c]);
      for (int f = 0; f < faces; ++f) {
        const Index other = level.beside[c * faces + Index(f)];
        if (other == c) continue;
        level.conductance[c * faces + Index(f)] =
            float((stiffness[c][Index(f / 2)] + stiffness[other][Index(f / 2)]) / 2);
      }
    }
    finish_diagonal(level, 1e-6f);

    from_finest_.assign(n * corners, Corner{});
    for_each(n, [&](Index i) {
      if (!takes_part(i)) return;
      std::array<double, Dim> x;
      for (int k = 0; k < Dim; ++k) x[Index(k)] = at(i, k);
      interpolate(numbering, x, &from_finest_[i * corners]);
    });
    transpose(from_finest_, level);
  }

  // The next level; false where it would hardly be smaller.
  bool coarsen() {
    const Index n = levels_.back().size();
    std::vector<Cell> parents(n);
    for (Index c = 0; c < n; ++c) {
      for (std::size_t k = 0; k < Dim; ++k) parents[c][k] = levels_.back().cells[c][k] >> 1;
    }
    Numbering numbering(parents);
    if (numbering.cells().size() * 4 > n * 3) return false;
    Level& coarse = add_level(numbering);
    Level& fine = levels_[levels_.size() - 2];

    std::vector<double> conductance(coarse.size() * faces, 0.0);
    std::vector<double> masses(coarse.size(), 0.0);
    for (Index c = 0; c < n; ++c) {
      const Index parent = numbering.find(parents[c]);
      masses[parent] += double(fine.mass[c]);
      for (int f = 0; f < faces; ++f) {
        const Index other = fine.beside[c * faces + Index(f)];
        if (other == c || parents[other] == parents[c]) continue;
        conductance[parent * faces + Index(f)] +=
            double(fine.conductance[c * faces + Index(f)]) / 2;
      }
    }
    std::transform(masses.begin(), masses.end(), coarse.mass.begin(), [](double m) { return float(m); });
    std::transform(conductance.begin(), conductance.end(), coarse.conductance.begin(),
                   [](double k) { return float(k); });
    finish_diagonal(coarse, 1e-6f * std::pow(4.0f, float(levels_.size() - 1)));

    fine.from_above.assign(n * corners, Corner{});
    for_each(n, [&](Index c) {
      std::array<double, Dim> x;
      for (std::size_t k = 0; k < Dim; ++k) x[k] = (double(fine.cells[c][k]) + 0.5) / 2;
      interpolate(numbering, x, &fine.from_above[c * corners]);
    });
    transpose(fine.from_above, coarse);
    return true;
  }

  Level& add_level(const Numbering& numbering) {
    Level& level = levels_.emplace_back();
    level.cells = numbering.cells();
    level.reds = numbering.reds();
    const Index n = level.size();
    level.beside.resize(n * faces);
    level.conductance.assign(n * faces, 0);
    for_each(n, [&](Index c) {
      for (int f = 0; f < faces; ++f) {
        Cell next = level.cells[c];
        next[Index(f / 2)] += f % 2 == 0 ? -1 : 1;
        const std::uint32_t other = numbering.find(next);
        level.beside[c * faces + Index(f)] = other == Numbering::none ? std::uint32_t(c) : other;
      }
    });
    for (auto* values : {&level.mass, &level.diagonal, &level.inverse, &level.x, &level.b, &level.r}) {
      values->assign(n, 0);
    }
    return level;
  }

  // Cells that touch no surface get a little mass: an all-closed body would be singular.
  void finish_diagonal(Level& level, float floor) const {
    for_each(level.size(), [&](Index c) {
      float sum = 0;
      for (int f = 0; f < faces; ++f) sum += level.conductance[c * faces + Index(f)];
      level.mass[c] = std::max(level.mass[c], floor * sum);
      level.diagonal[c] = sum + level.mass[c];
      level.inverse[c] = level.diagonal[c] > 0 ? 1 / level.diagonal[c] : 0;
    });
  }

  // Linear interpolation at x, in cells, from the cells' centres; those that are missing are left
  // out and the others' shares grow in proportion.
  static void interpolate(const Numbering& numbering, const std::array<double, Dim>& x,
                          Corner* to) {
    Cell low;
    std::array<double, Dim> beyond;
    for (std::size_t k = 0; k < Dim; ++k) {
      const double shifted = x[k] - 0.5;
      low[k] = std::int64_t(std::floor(shifted));
      beyond[k] = shifted - std::floor(shifted);
    }
    double sum = 0;
    std::array<double, corners> shares{};
    for (int corner = 0; corner < corners; ++corner) {
      Cell cell = low;
      double share = 1;
      for (std::size_t k = 0; k < Dim; ++k) {
        const bool high = (corner >> k) & 1;
        cell[k] += high;
        share *= high ? beyond[k] : 1 - beyond[k];
      }
      const std::uint32_t found = share > 0 ? numbering.find(cell) : Numbering::none;
      if (found == Numbering::none) continue;
      to[corner].cell = found;
      shares[Index(corner)] = share;
      sum += share;
    }
    for (int corner = 0; corner < corners && sum > 0; ++corner) {
      to[corner].share = float(shares[Index(corner)] / sum);
    }
  }

  static void transpose(const std::vector<Corner>& corners_of, Level& level) {
    level.first_below.assign(level.size() + 1, 0);
    for (const Corner& corner : corners_of) {
      if (corner.share > 0) ++level.first_below[corner.cell + 1];
    }
    std::partial_sum(level.first_below.begin(), level.first_below.end(),
                     level.first_below.begin());
    level.below.resize(level.first_below.back());
    level.share_below.resize(level.first_below.back());
    std::vector<Index> next(level.first_below.begin(), level.first_below.end() - 1);
    for (Index k = 0; k < corners_of.size(); ++k) {
      if (!(corners_of[k].share > 0)) continue;
      const Index at = next[corners_of[k].cell]++;
      level.below[at] = std::uint32_t(k / corners);
      level.share_below[at] = corners_of[k].share;
    }
  }

  // The coarsest level's inverse, where it is small enough to be solved directly.
  void invert_coarsest() {
    const Level& level = levels_.back();
    const auto n = static_cast<Eigen::Index>(level.size());
    if (level.size() > 4 * settings_.solved_directly) return;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (Index c = 0; c < level.size(); ++c) {
      const auto row = static_cast<Eigen::Index>(c);
      A(row, row) = level.diagonal[c] > 0 ? double(level.diagonal[c]) : 1;
      for (int f = 0; f < faces; ++f) {
        const Index other = level.beside[c * faces + Index(f)];
        if (other == c) continue;
        A(row, static_cast<Eigen::Index>(other)) -=
            double(level.conductance[c * faces + Index(f)]);
      }
    }
    const Eigen::MatrixXd inverse = A.llt().solve(Eigen::MatrixXd::Identity(n, n));
    coarsest_inverse_ = inverse.cast<float>();
  }

  void cycle(Index l) {
    Level& level = levels_[l];
    const bool is_coarsest = l + 1 == levels_.size();
    if (is_coarsest && level.size() <= 4 * settings_.solved_directly) {
      const auto n = static_cast<Eigen::Index>(level.size());
      Eigen::Map<Eigen::VectorXf>(level.x.data(), n).noalias() =
          coarsest_inverse_ * Eigen::Map<const Eigen::VectorXf>(level.b.data(), n);
      return;
    }
    std::fill(level.x.begin(), level.x.end(), 0.0f);
    for (int sweep = 0; sweep < settings_.sweeps; ++sweep) {
      relax(level, 0, level.reds);
      relax(level, level.reds, level.size());
    }
    if (!is_coarsest) {
      Level& coarse = levels_[l + 1];
      for_each(level.size(), [&](Index c) {
        level.r[c] = level.b[c] - level.x[c] * level.diagonal[c] + flow_in(level, c);
      });
      for_each(coarse.size(), [&](Index c) {
        float sum = 0;
        for (Index k = coarse.first_below[c]; k < coarse.first_below[c + 1]; ++k) {
          sum += coarse.share_below[k] * level.r[coarse.below[k]];
        }
        coarse.b[c] = sum;
      });
      cycle(l + 1);
      for_each(level.size(), [&](Index c) {
        for (int k = 0; k < corners; ++k) {
          const Corner& corner = level.from_above[c * corners + Index(k)];
          level.x[c] += corner.share * coarse.x[corner.cell];
        }
      });
    }
    for (int sweep = 0; sweep < settings_.sweeps; ++sweep) {
      relax(level, level.reds, level.size());
      relax(level, 0, level.reds);
    }
  }

  static float flow_in(const Level& level, Index c) {
    float sum = 0;
    for (int f = 0; f < faces; ++f) {
      sum += level.conductance[c * faces + Index(f)] * level.x[level.beside[c * faces + Index(f)]];
    }
    return sum;
  }

  // Gauss–Seidel over one colour: none of its cells is beside another.
  static void relax(Level& level, Index from, Index to) {
    for_each(to - from, [&](Index k) {
      const Index c = from + k;
      level.x[c] = (level.b[c] + flow_in(level, c)) * level.inverse[c];
    });
  }

  Settings settings_;
  std::vector<double> inverse_;
  std::vector<Level> levels_;
  std::vector<Corner> from_finest_;  // by row of the system
  Eigen::MatrixXf coarsest_inverse_;
};

}  // namespace silt
