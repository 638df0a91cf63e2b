// SPDX-License-Identifier: MIT
// The equations of particles that the recommended scheme leaves at rest.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/geometry/shares_of_lines.hpp>
#include <silt/mps/filling/near_points.hpp>
#include <silt/mps/filling/slopes.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/recommended.hpp>
#include <silt/mps/view/flow_operators.hpp>
#include <silt/mps/view/pressure_boundary.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

namespace silt::mps::detail {

/// Particles of a pool, and the equations of a state of rest of Recommended:
///
///   n_i = n0                         inside                           [TanakaMasunaga2010] (16)
///   n_i ≤ n0                         where a neighbour is on the surface
///   Σ_j w_ij (h_j − h_i) = a_i h_i   on the surface, h the depth; see OuterSurface
///
/// With these, the source of the pressure equation is that of a pressure ρ g h, which solves it.
template <int Dim>
class RestEquations {
 public:
  using Vec = silt::Vec<Dim>;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  static constexpr int up = Dim - 1;

  /// The level is infinite if there is no surface.
  RestEquations(const FlowSettings<Dim, Recommended>& settings, double level,
                const std::vector<Vec>& points)
      : settings_(settings), level_(level), operators_(settings_) {
    for (const Vec& x : points) add_particle(water_, x, Kind::fluid);
    is_kept_.assign(water_.size(), 0);
  }

  Index size() const { return water_.size(); }
  auto positions() { return water_[position]; }
  auto positions() const { return water_[position]; }
  bool is_on_surface(Index i) const { return has_surface() && water_[surface][i] != 0; }
  double depth(Index i) const { return level_ - water_[position][i][up]; }  ///< [m]
  const auto& walls() const { return operators_.walls(); }

  /// Finds the neighbours at the present positions. What follows is of the positions then, and of
  /// these neighbours where they are when it is called.
  void find_neighbours() {
    near_.sort(water_[position], double(operators_.reach()));
    operators_.find(water_, near_);
    boundary_.find(water_, operators_, settings_.surface);
    const Index size = water_.size();
    const auto& stencil = operators_.stencil();
    rows_.assign(size, Row{});
    sets_.resize(row_sets(size));
    const auto x = water_.with_ghosts(position);
    for_each_range<rows_together>(size, [&](Index first, Index last) {
      Set& set = sets_[first / rows_together];
      set.neighbours.clear();
      set.maps.clear();
      set.share_slopes.clear();
      for (Index i = first; i < last; ++i) {
        rows_[i].first = std::uint32_t(set.neighbours.size());
        const std::uint32_t maps_before = std::uint32_t(set.maps.size());
        const auto add_map = [&](const Matrix& rotation, const Vec& shift) {
          for (std::uint32_t m = std::uint32_t(set.maps.size()); m-- > maps_before;) {
            if (set.maps[m].rotation == rotation &&
                (set.maps[m].shift - shift).norm() < 1e-9 * settings_.spacing) {
              return m;
            }
          }
          set.maps.push_back({rotation, shift});
          return std::uint32_t(set.maps.size() - 1);
        };
        const auto share_slope = [&](double share, Index j, const Mirror<Dim>& mirror) {
          if (share == 1) return none;
          const auto& near = operators_.walls().near();
          const auto found = SharesOfLines<Dim>(near[i]).share_of(near.position(j), mirror);
          set.share_slopes.push_back({found.slope, found.slope_of_image});
          return std::uint32_t(set.share_slopes.size() - 1);
        };
        operators_.for_each(i, [&](const auto& j) {
          using J = std::remove_cvref_t<decltype(j)>;
          const std::uint32_t owner = std::uint32_t(water_.owner(j.index));
          if constexpr (J::is_image) {
            const Vec to = x[j.index] + j.shift - j.rotation * x[owner];
            set.neighbours.push_back({owner, add_map(j.rotation, to), j.share,
                                      share_slope(j.share, j.index, {j.rotation, to})});
          } else {
            double share = 1;
            if (!operators_.walls().sees_all(i)) {
              share = std::min(1.0, j.weight / stencil.weight(j.r_ij.norm()));
            }
            if (owner == j.index) {
              set.neighbours.push_back({owner, none, share, share_slope(share, j.index, {})});
            } else {
              set.neighbours.push_back(
                  {owner, add_map(Matrix::Identity(), x[j.index] - x[owner]), share, none});
            }
          }
        });
        rows_[i].end = std::uint32_t(set.neighbours.size());
      }
    });
  }

  /// l0/n0 Σ w r_ij/r² with the images beyond the level, from where particles are crowded.
  Vec crowding(Index i) const {
    const auto& stencil = operators_.stencil();
    const Vec x_i = water_[position][i];
    const double re2 = squared(stencil.re);
    Vec sum = Vec::Zero();
    const auto add = [&](const Vec& r, double share) {
      const double r2 = r.squaredNorm();
      if (!(r2 < re2) || r2 == 0) return;
      sum -= share * stencil.weight(std::sqrt(r2)) / r2 * r;
    };
    const double below = level_ - x_i[up];
    const bool is_near = below < stencil.re;
    const auto add_mirrored = [&](const Vec& r, double share) {
      Vec mirrored = r;
      mirrored[up] = 2 * below - r[up];
      add(mirrored, share);
    };
    for_each_in_row(i, [&](const Neighbour& j, const Vec& x, std::uint32_t) {
      const Vec r = x - x_i;
      add(r, j.share);
      if (is_near) add_mirrored(r, j.share);
    });
    if (is_near) add_mirrored(Vec::Zero(), 1);
    return stencil.spacing / stencil.n0 * sum;
  }

  /// Finds the residuals and their derivatives.
  void linearise() {
    Buffer<double> densities(size());
    for_each(size(), [&](Index i) { densities[i] = density(i); });
    double mean = operators_.stencil().n0;
    if (!has_surface()) {
      mean = ordered_sum(size(), 0.0, [&](Index i) { return densities[i]; }) / double(size());
    }
    residuals_.assign(size(), 0);
    slopes_.clear(size(), [&](Index i) { return rows_[i].end - rows_[i].first; });
    for_each(size(), [&](Index i) {
      const Equation equation = is_on_surface(i) ? equation_of_depth(i, densities[i])
                                                 : equation_of_density(i, densities[i], mean);
      if (!equation.is_active) return;
      residuals_[i] = equation.residual;
      add_slopes(i, equation);
    });
    slopes_.end();
  }
  /// From now on, an inequality that is active is an equation, lest it alternates.
  void keep_active() {
    for_each(size(), [&](Index i) { is_kept_[i] |= slopes_.is_active(i); });
  }

  /// Of the equations, over n0 and in spacings [-].
  const Buffer<double>& residuals() const { return residuals_; }
  const Slopes<Dim>& slopes() const { return slopes_; }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Neighbour {
    std::uint32_t index;
    std::uint32_t map;  // of its position to that of its image; none: it is seen itself
    double share;
    std::uint32_t slope;  // of the share; none: it is constant
  };
  // A share's derivatives by the positions of the particle and of its neighbour's image [1/m].
  struct ShareSlope {
    Vec own, of_image;
  };
  struct Map {
    Matrix rotation;
    Vec shift;
  };
  struct Row {
    std::uint32_t first = 0, end = 0;
  };
  struct Set {
    Buffer<Neighbour> neighbours;
    Buffer<Map> maps;
    Buffer<ShareSlope> share_slopes;
  };

  // The equation of a particle, and its derivatives by what it is a function of.
  struct Equation {
    bool is_active = true;
    double residual = 0;
    double of_density = 0;        // by n
    double of_rise = 0;           // by Σ w (h_j − h_i)
    Vec of_moment = Vec::Zero();  // by Σ w r_ij
    double of_depth = 0;          // by h_i, but for that of the rise
  };

  bool has_surface() const { return level_ < std::numeric_limits<double>::infinity(); }

  double density(Index i) const {
    const auto& stencil = operators_.stencil();
    const Vec x_i = water_[position][i];
    double n = 0;
    for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t) {
      const double r = (at - x_i).norm();
      if (r < stencil.re) n += j.share * stencil.weight(r);
    });
    return n;
  }
  // Of a neighbour, as PressureRise has it.
  double depth_of(const Neighbour& j, const Vec& at) const {
    const double h = level_ - at[up];
    return water_[surface][j.index] ? std::max(h, -3 * depth(j.index)) : h;
  }

  Equation equation_of_density(Index i, double n, double mean) const {
    const auto& stencil = operators_.stencil();
    Equation found{.residual = (n - mean) / stencil.n0, .of_density = 1 / stencil.n0};
    if (found.residual > 0 || is_kept_[i] || !has_surface()) return found;
    const Vec x_i = water_[position][i];
    for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t) {
      if (water_[surface][j.index] && (at - x_i).norm() < stencil.re) found.is_active = false;
    });
    return found;
  }
  // See OuterSurface.
  Equation equation_of_depth(Index i, double n) const {
    const auto& stencil = operators_.stencil();
    const double l0 = stencil.spacing;
    const Vec x_i = water_[position][i];
    double rise = 0;
    Vec moment = Vec::Zero();
    for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t) {
      const Vec r_ij = at - x_i;
      const double r = r_ij.norm();
      if (!(r < stencil.re)) return;
      const double w = j.share * stencil.weight(r);
      rise += w * (depth_of(j, at) - depth(i));
      moment += w * r_ij;
    });
    const double missing = 0.8 * stencil.mean_height * (stencil.n0 - n);
    const double flat = stencil.n0 - stencil.above;
    const double plane = stencil.n0 - 2 * stencil.above + stencil.weight(0);
    const double unbounded = 0.5 + (n - flat) / plane;
    const double height = std::clamp(unbounded, 0.2, 1.0);  // spacings
    const double full = moment.norm();
    const double base = std::max(full, missing);
    Equation found;
    found.is_active = base > 0;
    if (!found.is_active) return found;
    found.residual = rise * height / base - depth(i) / l0;
    found.of_rise = height / base;
    found.of_density = height == unbounded ? rise / (plane * base) : 0;
    found.of_depth = -1 / l0;
    const double of_base = -rise * height / squared(base);
    if (full >= missing) {
      found.of_moment = of_base / full * moment;
    } else {
      found.of_density -= of_base * 0.8 * stencil.mean_height;
    }
    return found;
  }
  void add_slopes(Index i, const Equation& equation) {
    const Set& set = sets_[i / rows_together];
    const auto& stencil = operators_.stencil();
    const Vec x_i = water_[position][i];
    Vec own = -equation.of_depth * Vec::Unit(up);
    for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t k) {
      const Vec r_ij = at - x_i;
      const double r = r_ij.norm();
      if (!(r < stencil.re)) return slopes_.set(i, k - rows_[i].first, j.index, Vec::Zero());
      const double w = j.share * stencil.weight(r);
      double of_w = equation.of_density;
      if (equation.of_rise != 0) {
        of_w += equation.of_rise * (depth_of(j, at) - depth(i)) + equation.of_moment.dot(r_ij);
      }
      Vec slope = of_w * (j.share * stencil.slope(r) / r) * r_ij + w * equation.of_moment;
      slope[up] -= equation.of_rise * w;
      own -= slope;
      if (j.slope != none) {
        const ShareSlope& of_share = set.share_slopes[j.slope];
        own += of_w * stencil.weight(r) * of_share.own;
        slope += of_w * stencil.weight(r) * of_share.of_image;
      }
      if (j.map != none) slope = set.maps[j.map].rotation.transpose() * Vec(slope);
      slopes_.set(i, k - rows_[i].first, j.index, slope);
    });
    slopes_.set_own(i, own);
  }

  // f(neighbour, position, number) of the row of i, at the present positions.
  template <class F>
  void for_each_in_row(Index i, F&& f) const {
    const Set& set = sets_[i / rows_together];
    const auto x = water_[position];
    for (std::uint32_t k = rows_[i].first; k < rows_[i].end; ++k) {
      const Neighbour& j = set.neighbours[k];
      if (j.map == none) {
        f(j, Vec(x[j.index]), k);
      } else {
        const Map& map = set.maps[j.map];
        f(j, Vec(map.rotation * x[j.index] + map.shift), k);
      }
    }
  }

  FlowSettings<Dim, Recommended> settings_;
  double level_;
  FlowOperators<Recommended, Dim, double> operators_;
  PressureBoundary<Recommended> boundary_;
  NearPoints<Dim> near_;
  Fluid<Dim> water_;
  Buffer<Row> rows_;
  Buffer<Set> sets_;
  Buffer<double> residuals_;
  Buffer<std::uint8_t> is_kept_;  // whether n_i ≤ n0 is n_i = n0
  Slopes<Dim> slopes_;
};

}  // namespace silt::mps::detail
