// SPDX-License-Identifier: MIT
// Moves the particles of a pool to where the recommended scheme leaves them at rest.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/filling/near_points.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/recommended.hpp>
#include <silt/mps/view/flow_operators.hpp>
#include <silt/mps/view/pressure_boundary.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace silt::mps::detail {

/// Particles of a pool that are moved apart, and then to a state of rest of Recommended:
///
///   n_i = n0                         inside                           [TanakaMasunaga2010] (16)
///   n_i ≤ n0                         where a neighbour is on the surface
///   Σ_j w_ij (h_j − h_i) = a_i h_i   on the surface, h the depth; see OuterSurface
///
/// With these, the source of the pressure equation is that of a pressure ρ g h, which solves it.
/// There are more unknowns than equations: each of Newton's steps is the shortest one,
/// Δx = −Jᵀ (J Jᵀ)⁻¹ r.
template <int Dim>
class Packing {
 public:
  using Vec = silt::Vec<Dim>;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  using Water = Fluid<Dim>;
  static constexpr int up = Dim - 1;

  /// The level is infinite if there is no surface.
  Packing(const FlowSettings<Dim, Recommended>& settings, double level,
          const std::vector<Vec>& points)
      : settings_(settings), level_(level), operators_(settings_) {
    for (const Vec& x : points) add_particle(water_, x, Kind::fluid);
  }

  /// Of the particles [m].
  auto positions() const { return water_[position]; }
  /// The largest of the residuals of the equations above, over n0 and in spacings [-].
  double deviation() const { return deviation_; }

  /// Moves the particles.
  void pack() {
    spread_out();
    come_to_rest();
  }

 private:
  struct Neighbour {
    std::uint32_t index;
    std::uint32_t map;  // of its position to that of its image; none: it is seen itself
    double share;
  };
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Map {
    Matrix rotation;
    Vec shift;
  };
  struct Row {
    std::uint32_t first = 0, end = 0;
  };
  // ∂r_i/∂x_j, with j in the row of i, and i in the column of j. In single precision: the sums wait
  // for memory, and both have the same values.
  struct Slope {
    std::uint32_t index;
    silt::Vec<Dim, float> value;

    Vec as_double() const { return value.template cast<double>(); }
  };
  struct Set {
    Buffer<Neighbour> neighbours;
    Buffer<Map> maps;
    Buffer<Slope> slopes;  // of each neighbour
  };

  // Numbers of iterations; in space, each takes ten times as long.
  static constexpr int spreading_rounds = 10, moves_per_round = 5;
  static constexpr int even_steps = Dim == 2 ? 30 : 15, most_steps = Dim == 2 ? 100 : 50;
  static constexpr int most_iterations = 60;
  static constexpr double tolerance = Dim == 2 ? 1e-7 : 1e-4;
  // Spacings: closer to walls, particles would collide with their images; on the surface, those
  // that are closer to it have too little pressure to be held below a wall that leans over them.
  static constexpr double clearance = 0.42, wished_clearance = 0.46, wished_depth = 0.3;

  // Moves particles apart: away from where they are crowded.
  void spread_out() {
    constexpr double strength = 0.3, most = 0.1;  // spacings
    const double l0 = settings_.spacing;
    moves_.resize(water_.size());
    for (int round = 0; round < spreading_rounds; ++round) {
      find_rows();
      for (int k = 0; k < moves_per_round; ++k) {
        for_each(water_.size(), [&](Index i) { moves_[i] = strength * l0 * crowding(i); });
        move(most * l0);
      }
    }
  }

  // Newton's steps. In the first ones, particles move apart, too, as far as the equations allow.
  // Images appear and vanish at edges of walls, so that a solution may not exist where it is looked
  // for: particles that get no nearer to one are displaced. The best state is kept.
  void come_to_rest() {
    const Index size = water_.size();
    is_held_.assign(size, 0);
    deviation_ = std::numeric_limits<double>::infinity();
    Buffer<Vec> best;
    constexpr int patience = 8;
    int last_success = even_steps;
    for (int k = 0; k <= most_steps; ++k) {
      find_rows();
      linearise();
      const double largest_residual =
          largest(size, 0.0, [&](Index i) { return std::abs(residuals_[i]); });
      if (k >= even_steps) {
        // An inequality that was active once is kept as an equation, lest it alternates.
        for_each(size, [&](Index i) { is_held_[i] |= is_active_[i]; });
        if (largest_residual < deviation_) {
          if (largest_residual < deviation_ / 2) last_success = k;
          deviation_ = largest_residual;
          best.assign(water_[position].begin(), water_[position].end());
        }
        if (deviation_ < tolerance || k == most_steps) break;
      }
      const bool is_stuck = k - last_success > patience;
      if (is_stuck) last_success = k;
      wish(k < even_steps);
      if (is_stuck) displace(0.1 * largest_residual, Index(k));
      find_moves();
      move(0.1 * settings_.spacing);
    }
    std::copy(best.begin(), best.end(), water_[position].begin());
  }

  // Where particles should move, if the equations allow it.
  void wish(bool apart) {
    constexpr double strength = 0.2, part = 0.5;
    const double l0 = settings_.spacing;
    wishes_.resize(water_.size());
    const auto x = water_[position];
    const auto on_surface = water_[surface];
    for_each(water_.size(), [&](Index i) {
      wishes_[i] = apart ? Vec(strength * l0 * crowding(i)) : Vec(Vec::Zero());
      operators_.walls().for_each_wall(i, [&](const Vec& normal, double height) {
        wishes_[i] += part * std::max(0.0, wished_clearance * l0 - height) * normal;
      });
      if (!has_surface() || !on_surface[i]) return;
      wishes_[i][up] -= part * std::max(0.0, wished_depth * l0 - (level_ - x[i][up]));
    });
  }
  // Particles with a larger residual than `least`.
  void displace(double least, Index round) {
    // Multiples of irrational numbers are as good as random ones.
    constexpr double irrational[] = {0.6180339887, 0.7548776662, 0.8191725134};
    constexpr double most = 0.05;  // spacings
    for_each(water_.size(), [&](Index i) {
      if (!(std::abs(residuals_[i]) > least)) return;
      for (int axis = 0; axis < Dim; ++axis) {
        const double any = double(i + 1 + round) * irrational[axis];
        wishes_[i][axis] += most * settings_.spacing * (2 * (any - std::floor(any)) - 1);
      }
    });
  }
  bool has_surface() const { return level_ < std::numeric_limits<double>::infinity(); }

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

  void find_rows() {
    near_.sort(water_[position], double(operators_.reach()));
    operators_.find(water_, near_);
    boundary_.find(water_, operators_, settings_.surface);
    const Index size = water_.size();
    const auto& stencil = operators_.stencil();
    begin_.assign(water_[position].begin(), water_[position].end());
    rows_.assign(size, Row{});
    sets_.resize(row_sets(size));
    const auto x = water_.with_ghosts(position);
    for_each_range<rows_together>(size, [&](Index first, Index last) {
      Set& set = sets_[first / rows_together];
      set.neighbours.clear();
      set.maps.clear();
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
        operators_.for_each(i, [&](const auto& j) {
          using J = std::remove_cvref_t<decltype(j)>;
          const std::uint32_t owner = std::uint32_t(water_.owner(j.index));
          if constexpr (J::is_image) {
            const Vec to = x[j.index] + j.shift - j.rotation * x[owner];
            set.neighbours.push_back({owner, add_map(j.rotation, to), j.share});
          } else {
            double share = 1;
            if (!operators_.walls().sees_all(i)) {
              share = std::min(1.0, j.weight / stencil.weight(j.r_ij.norm()));
            }
            if (owner == j.index) {
              set.neighbours.push_back({owner, none, share});
            } else {
              set.neighbours.push_back(
                  {owner, add_map(Matrix::Identity(), x[j.index] - x[owner]), share});
            }
          }
        });
        rows_[i].end = std::uint32_t(set.neighbours.size());
      }
    });
  }

  // l0/n0 Σ w r_ij/r² with the images beyond the level, from where particles are crowded.
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

  // Moves particles by moves_, but by at most `most` [m], and not into walls.
  void move(double most) {
    const auto x = water_[position];
    const auto& walls = operators_.walls();
    for_each(water_.size(), [&](Index i) {
      const double length = moves_[i].norm();
      const Vec part = length > most ? Vec(most / length * moves_[i]) : moves_[i];
      x[i] = begin_[i] + walls.before_walls(i, Vec(x[i] + part - begin_[i]), clearance);
    });
  }

  // The residuals, and their derivatives.
  void linearise() {
    const Index size = water_.size();
    const auto& stencil = operators_.stencil();
    const double l0 = stencil.spacing;
    const auto x = water_[position];
    const auto on_surface = water_[surface];
    residuals_.assign(size, 0);
    is_active_.assign(size, 0);
    own_slopes_.assign(size, Vec(Vec::Zero()));
    for (Set& set : sets_) set.slopes.resize(set.neighbours.size());
    const bool is_closed = !has_surface();
    Buffer<double> densities(size);
    for_each(size, [&](Index i) {
      double n = 0;
      for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t) {
        const double r = (at - x[i]).norm();
        if (r < stencil.re) n += j.share * stencil.weight(r);
      });
      densities[i] = n;
    });
    double mean = stencil.n0;
    if (is_closed) {
      mean = ordered_sum(size, 0.0, [&](Index i) { return densities[i]; }) / double(size);
    }
    for_each(size, [&](Index i) {
      Set& set = sets_[i / rows_together];
      const double n = densities[i];
      const double depth = level_ - x[i][up];
      double of_density = 0, of_rise = 0, residual = 0;
      Vec of_moment = Vec::Zero();
      const auto depth_of = [&](const Neighbour& j, const Vec& at) {
        const double h = level_ - at[up];
        // As PressureRise has it.
        return on_surface[j.index] ? std::max(h, 3 * (x[j.index][up] - level_)) : h;
      };
      if (on_surface[i] && !is_closed) {
        double rise = 0;
        Vec moment = Vec::Zero();
        for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t) {
          const Vec r_ij = at - x[i];
          const double r = r_ij.norm();
          if (!(r < stencil.re)) return;
          const double w = j.share * stencil.weight(r);
          rise += w * (depth_of(j, at) - depth);
          moment += w * r_ij;
        });
        const double missing = 0.8 * stencil.mean_height * (stencil.n0 - n);
        const double flat = stencil.n0 - stencil.above;
        const double plane = stencil.n0 - 2 * stencil.above + stencil.weight(0);
        const double unbounded = 0.5 + (n - flat) / plane;
        const double height = std::clamp(unbounded, 0.2, 1.0);
        const double per_density = height == unbounded ? l0 / plane : 0;
        const double full = moment.norm();
        const double base = std::max(full, missing);
        if (!(base > 0)) return;
        residual = (rise * height * l0 / base - depth) / l0;
        of_rise = height * l0 / base / l0;
        of_density = rise * per_density / base / l0;
        if (full >= missing) {
          of_moment = -rise * height * l0 / (full * full * full) * moment / l0;
        } else {
          of_density += rise * height * l0 / squared(missing) * 0.8 * stencil.mean_height / l0;
        }
        own_slopes_[i][up] += 1 / l0;
      } else {
        residual = (n - mean) / stencil.n0;
        bool is_near_surface = false;
        if (!is_closed) {
          for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t) {
            if (on_surface[j.index] && (at - x[i]).norm() < stencil.re) is_near_surface = true;
          });
        }
        if (is_near_surface && !(residual > 0) && !is_held_[i]) return;
        of_density = 1 / stencil.n0;
      }
      is_active_[i] = 1;
      residuals_[i] = residual;
      Vec own = own_slopes_[i];
      for_each_in_row(i, [&](const Neighbour& j, const Vec& at, std::uint32_t k) {
        set.slopes[k] = {j.index, silt::Vec<Dim, float>::Zero()};
        const Vec r_ij = at - x[i];
        const double r = r_ij.norm();
        if (!(r < stencil.re)) return;
        const Vec w_slope = (j.share * stencil.slope(r) / r) * r_ij;
        Vec slope = of_density * w_slope;
        double w = 0;
        if (of_rise != 0) {
          w = j.share * stencil.weight(r);
          slope += of_rise * (depth_of(j, at) - depth) * w_slope + w * of_moment +
                   of_moment.dot(r_ij) * w_slope;
        }
        own -= slope;
        own[up] += of_rise * w;
        slope[up] -= of_rise * w;
        if (j.map != none) slope = set.maps[j.map].rotation.transpose() * Vec(slope);
        set.slopes[k].value = slope.template cast<float>();
      });
      own_slopes_[i] = own;
    });
    find_columns();
  }

  // Where each particle occurs in the rows: Jᵀ.
  void find_columns() {
    const Index size = water_.size();
    column_ends_.assign(size + 1, 0);
    for (Index i = 0; i < size; ++i) {
      if (!is_active_[i]) continue;
      const Set& set = sets_[i / rows_together];
      for (std::uint32_t k = rows_[i].first; k < rows_[i].end; ++k)
        ++column_ends_[set.slopes[k].index + 1];
    }
    for (Index j = 0; j < size; ++j) column_ends_[j + 1] += column_ends_[j];
    columns_.resize(column_ends_[size]);
    Buffer<std::uint32_t> next(column_ends_.begin(), column_ends_.end());
    for (Index i = 0; i < size; ++i) {
      if (!is_active_[i]) continue;
      const Set& set = sets_[i / rows_together];
      for (std::uint32_t k = rows_[i].first; k < rows_[i].end; ++k) {
        columns_[next[set.slopes[k].index]++] = {std::uint32_t(i), set.slopes[k].value};
      }
    }
  }
  // Jᵀ y
  void spread_back(const Buffer<double>& y, Buffer<Vec>& moves) const {
    for_each(water_.size(), [&](Index j) {
      Vec sum = y[j] * own_slopes_[j];
      for (std::uint32_t c = column_ends_[j]; c < column_ends_[j + 1]; ++c) {
        sum += y[columns_[c].index] * columns_[c].as_double();
      }
      moves[j] = sum;
    });
  }

  // moves_ = s − Jᵀ (J Jᵀ + ε D)⁻¹ (r + J s), with the wishes s and the diagonal D, by conjugate
  // gradients.
  void find_moves() {
    const Index size = water_.size();
    moves_.resize(size);
    constexpr double damping = 1e-3;  // ε
    Buffer<double> y(size, 0.0), rest(size), diagonal(size, 1.0), search(size), product(size);
    for_each(size, [&](Index i) {
      if (!is_active_[i]) {
        rest[i] = 0;
        return;
      }
      const Set& set = sets_[i / rows_together];
      double sum = own_slopes_[i].squaredNorm();
      for (std::uint32_t k = rows_[i].first; k < rows_[i].end; ++k)
        sum += set.slopes[k].as_double().squaredNorm();
      diagonal[i] = std::max(sum, 1e-300);
      double moved = residuals_[i] + own_slopes_[i].dot(wishes_[i]);
      for (std::uint32_t k = rows_[i].first; k < rows_[i].end; ++k) {
        moved += set.slopes[k].as_double().dot(wishes_[set.slopes[k].index]);
      }
      rest[i] = -moved;
    });
    const auto dot = [&](const auto& a, const auto& b) {
      return ordered_sum(size, 0.0, [&](Index i) { return a[i] * b[i]; });
    };
    const auto scaled = [&](const auto& a) {
      return ordered_sum(size, 0.0, [&](Index i) { return a[i] * a[i] / diagonal[i]; });
    };
    double rho = scaled(rest);
    const double aim = 1e-6 * rho;
    for_each(size, [&](Index i) { search[i] = rest[i] / diagonal[i]; });
    for (int k = 0; k < most_iterations && rho > aim && rho > 0; ++k) {
      spread_back(search, moves_);
      for_each(size, [&](Index i) {
        product[i] = 0;
        if (!is_active_[i]) return;
        const Set& set = sets_[i / rows_together];
        double sum = own_slopes_[i].dot(moves_[i]);
        for (std::uint32_t n = rows_[i].first; n < rows_[i].end; ++n) {
          sum += set.slopes[n].as_double().dot(moves_[set.slopes[n].index]);
        }
        product[i] = sum + damping * diagonal[i] * search[i];
      });
      const double alpha = rho / dot(search, product);
      for_each(size, [&](Index i) {
        y[i] += alpha * search[i];
        rest[i] -= alpha * product[i];
      });
      const double next = scaled(rest);
      const double beta = next / rho;
      rho = next;
      for_each(size, [&](Index i) { search[i] = rest[i] / diagonal[i] + beta * search[i]; });
    }
    spread_back(y, moves_);
    for_each(size, [&](Index i) { moves_[i] += wishes_[i]; });
  }

  FlowSettings<Dim, Recommended> settings_;
  double level_;
  FlowOperators<Recommended, Dim, double> operators_;
  PressureBoundary<Recommended> boundary_;
  NearPoints<Dim> near_;
  Water water_;
  Buffer<Vec> begin_;  // where the rows were found
  Buffer<Row> rows_;
  Buffer<Set> sets_;
  Buffer<double> residuals_;
  Buffer<std::uint8_t> is_active_;
  Buffer<Vec> own_slopes_;
  Buffer<std::uint32_t> column_ends_;
  Buffer<Slope> columns_;
  Buffer<Vec> moves_, wishes_;
  Buffer<std::uint8_t> is_held_;
  double deviation_ = 0;
};

}  // namespace silt::mps::detail
