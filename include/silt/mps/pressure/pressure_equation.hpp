// SPDX-License-Identifier: MIT
// The pressure equation ∇²P = source as a symmetric system. The unknowns are the pressures of the
// fluid and wall particles that do not lie on the free surface; with OuterSurface, also of those.
//
//   Σ_j w_ij (P_i − P_j) = −source_i λ n0 / (2d),   P_j = 0 on the free surface, no dummies in Σ
//
// Positive definite for a body of fluid with a free surface. Without one (a closed full tank), the
// pressure is defined up to a constant.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/shared_particles.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/operators.hpp>
#include <silt/mps/pressure/shared_pressures.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace silt::mps {

/// Assembles the equation of a flow, solves it, and sets the pressures.
class PressureEquation {
 public:
  /// Numbers the unknowns, which are the fluid and wall particles off the free surface that have a
  /// neighbour with pressure, and assembles the system. `neighbours` is a search or a
  /// Neighbourhood; source(i) returns ∇²P [Pa/m²].
  template <FluidParticles P, class S, class T, class Source>
  void assemble(const P& particles, const S& neighbours, const T& stencil, Source&& source) {
    assemble(particles, neighbours, stencil, source, AllButDummies<P>{particles});
  }
  /// The same with the pressure boundary of a flow: particles for which has_pressure(i) is true have
  /// a pressure; on the free surface it is unknown where weight_of_surface(i), which enters the
  /// equation with P = 0, is positive.
  template <FluidParticles P, class S, class T, class Source, class Boundary>
  void assemble(const P& particles, const S& neighbours, const T& stencil, Source&& source,
                const Boundary& boundary) {
    system_.shared.reset();
    number_unknowns(particles, neighbours, stencil, boundary);
    if constexpr (Shared<P>) {
      system_.shared = shared_pressures(particles, row_of_,
                                        unknowns_.size() + system_.columns_of_others);
    }
    system_.diagonal.resize(unknowns_.size());
    system_.right_side.resize(unknowns_.size());
    auto& geometry = system_.geometry;
    geometry.spacing = double(stencil.spacing);
    geometry.full_diagonal = double(stencil.n0);
    geometry.second_moment = double(stencil.lambda) / (T::dimension * squared(geometry.spacing));
    geometry.points.resize(unknowns_.size());
    geometry.to_surface.resize(unknowns_.size());
    last_column_.resize(unknowns_.size());
    const auto x = particles[position];
    const double scale = double(stencil.lambda) * double(stencil.n0) / (2 * T::dimension);
    const auto fill_row = [&](Index row, auto&& add) {
      const Index i = unknowns_[row];
      double to_surface = boundary.weight_of_surface(i);
      double diagonal = to_surface;
      std::uint32_t last_column = static_cast<std::uint32_t>(row);
      for_each_weighted(neighbours, i, stencil, [&](Index j, const auto&, auto weight, auto) {
        const std::uint32_t column = row_of_[j];
        if (column == excluded || !is_significant(weight, stencil)) return;
        const double w = double(static_cast<float>(weight));  // as stored in the system
        diagonal += w;
        if (column == zero) {
          to_surface += w;
        } else {
          add(column, -w);
          if (column < unknowns_.size()) last_column = std::max(last_column, column);
        }
      });
      system_.diagonal[row] = diagonal;
      system_.right_side[row] = -double(source(i)) * scale;
      geometry.to_surface[row] = static_cast<float>(to_surface);
      last_column_[row] = last_column;
      for (int k = 0; k < P::dimension; ++k) geometry.points[row][Index(k)] = double(x[i][k]);
    };
    system_.off_diagonal.build(unknowns_.size(), system_.columns(), fill_row);
    find_open_rows();
    find_closed_bodies();
    if constexpr (Shared<P>) join_closed_bodies(particles.process().rank);
    balance_closed_bodies();
  }

  /// Solves for the pressures, with the present ones as initial guess; particles that are not
  /// unknowns get P = 0. Pressures are changed only if the solve converged.
  template <FluidParticles P, class L>
  SolveReport solve(P& particles, L& solver) {
    static_assert(!Shared<P> || requires { requires L::shares_unknowns; },
                  "mps: this solver does not know the unknowns of other processes; use mpi::Flow "
                  "instead of mps::Flow (see shares_unknowns in silt/solve/jacobi.hpp)");
    using Real = typename P::Real;
    const auto values = particles[pressure];
    solution_.resize(system_.columns());
    for_each(unknowns_.size(), [&](Index row) { solution_[row] = double(values[unknowns_[row]]); });
    system_.remove_constants(solution_);
    const SolveReport report = solver.solve(system_, solution_);
    if (report.reason == SolveReport::Reason::not_converged ||
        report.reason == SolveReport::Reason::broke_down) {
      return report;
    }
    set_reference_pressures();
    for_each(values.size(), [&](Index i) {
      values[i] = row_of_[i] < unknowns_.size() ? Real(solution_[row_of_[i]]) : Real(0);
    });
    return report;
  }

  const LinearSystem& system() const noexcept { return system_; }

 private:
  // Values of row_of_ for particles without a row: those with P = 0, and those without pressure.
  static constexpr std::uint32_t zero = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t excluded = zero - 1;

  // Weights below single-precision round-off of a full neighbourhood are ignored. A body connected
  // with a surface by such weights only would have a nearly singular system.
  template <class Real, class T>
  static bool is_significant(Real weight, const T& stencil) {
    return static_cast<float>(weight) > 0x1p-26f * static_cast<float>(stencil.n0);
  }

  template <class P>
  struct AllButDummies {
    const P& particles;

    bool has_pressure(Index i) const { return particles.with_halo(kind)[i] != Kind::dummy; }
    double weight_of_surface(Index) const { return 0; }
  };

  template <class P, class S, class T, class Boundary>
  void number_unknowns(const P& particles, const S& neighbours, const T& stencil,
                       const Boundary& boundary) {
    const auto on_surface = particles[surface];
    row_of_.resize(particles.total());
    for_each(particles.size(), [&](Index i) {
      row_of_[i] = zero;
      if (!boundary.has_pressure(i)) {
        row_of_[i] = excluded;
        return;
      }
      if (on_surface[i] && !(boundary.weight_of_surface(i) > 0)) return;
      const bool is_connected = any_weighted(neighbours, i, stencil, [&](Index j, auto w) {
        return boundary.has_pressure(particles.owner(j)) && is_significant(w, stencil);
      });
      if (is_connected) row_of_[i] = 0;
    });
    unknowns_.clear();
    for (Index i = 0; i < particles.size(); ++i) {
      if (row_of_[i] != 0) continue;
      row_of_[i] = static_cast<std::uint32_t>(unknowns_.size());
      unknowns_.push_back(static_cast<std::uint32_t>(i));
    }
    silt::detail::share(particles, row_of_);
    // Behind the own columns, those of others.
    system_.columns_of_others = 0;
    for (Index j = particles.size(); j < particles.local(); ++j) {
      if (row_of_[j] >= excluded) continue;
      row_of_[j] = static_cast<std::uint32_t>(unknowns_.size() + system_.columns_of_others++);
    }
    for (Index i = particles.local(); i < particles.total(); ++i) {
      row_of_[i] = row_of_[particles.owner(i)];
    }
  }

  // Those that can be reached from the free surface.
  void find_open_rows() {
    const Index n = unknowns_.size();
    const auto& entries = system_.off_diagonal;
    is_open_.assign(system_.columns(), 0);
    // Free surfaces are mostly at the top, with the last rows: one pass downwards, which follows
    // the last connection of each row, reaches nearly all rows.
    for (Index row = n; row-- > 0;) {
      is_open_[row] = system_.geometry.to_surface[row] > 0 || is_open_[last_column_[row]];
    }
    do {
      for (Index row = 0; row < n; ++row) {
        if (is_open_[row] || !entries.has_entry_in(row, is_open_)) continue;
        flood(row, [&](Index r) { return !is_open_[r]; }, [&](Index r) { is_open_[r] = true; });
      }
    } while (others_have_opened());
  }
  // Whether rows of other processes are open that were not.
  bool others_have_opened() {
    if (!system_.shared) return false;
    std::vector<double> marks(is_open_.begin(), is_open_.end());
    system_.sum_of_all(0);
    system_.refresh(marks);
    double opened = 0;
    for (Index column = system_.size(); column < marks.size(); ++column) {
      if (marks[column] > 0 && !is_open_[column]) ++opened;
      is_open_[column] = marks[column] > 0;
    }
    return system_.sum_of_all(opened) > 0;
  }

  // A body of fluid without a free surface (a closed full tank) has a pressure up to a constant.
  void find_closed_bodies() {
    const Index n = unknowns_.size();
    auto& body = system_.closed_body;
    system_.closed_bodies = 0;
    body.clear();
    for (Index row = 0; row < n; ++row) {
      if (is_open_[row]) continue;
      if (body.empty()) body.assign(n, 0);
      if (body[row] > 0) continue;
      const auto number = static_cast<std::uint32_t>(++system_.closed_bodies);
      flood(row, [&](Index r) { return body[r] == 0; }, [&](Index r) { body[r] = number; });
    }
  }
  // Numbers those of all processes, of which one may be a part here and a part there.
  void join_closed_bodies(int rank) {
    auto& body = system_.closed_body;
    if (!(system_.sum_of_all(double(system_.closed_bodies)) > 0)) return;
    body.resize(system_.size(), 0);
    // A label for each of the own bodies: the lowest of its parts.
    constexpr double none = std::numeric_limits<double>::infinity();
    std::vector<double> label(system_.closed_bodies + 1, none);
    for (Index k = 1; k < label.size(); ++k) label[k] = 0x1p32 * rank + double(k);
    std::vector<double> labels(system_.columns());
    double lowered = 0;
    system_.sum_of_all(0);
    do {
      for (Index row = 0; row < body.size(); ++row) labels[row] = label[body[row]];
      system_.refresh(labels);
      lowered = 0;
      for (Index row = 0; row < body.size(); ++row) {
        if (body[row] == 0) continue;
        double& own = label[body[row]];
        system_.off_diagonal.for_each_entry(row, [&](Index column, double) {
          if (column < body.size() || !(labels[column] < own)) return;
          own = labels[column];
          lowered = 1;
        });
      }
    } while (system_.sum_of_all(lowered) > 0);
    // From the lowest label on.
    std::vector<std::uint32_t> number(label.size(), 0);
    std::uint32_t bodies = 0;
    for (double last = -none;;) {
      double next = none;
      for (const double each : label) {
        if (each > last) next = std::min(next, each);
      }
      double minus_next = -next;
      system_.shared->largest(std::span(&minus_next, 1));
      if (minus_next == -none) break;
      last = -minus_next;
      ++bodies;
      for (Index k = 1; k < label.size(); ++k) {
        if (label[k] == last) number[k] = bodies;
      }
    }
    for (std::uint32_t& each : body) each = number[each];
    system_.closed_bodies = bodies;
  }

  // Marks the row and all rows that can be reached from it over rows for which is_new is true.
  template <class IsNew, class Mark>
  void flood(Index row, IsNew&& is_new, Mark&& mark) {
    mark(row);
    front_.assign(1, static_cast<std::uint32_t>(row));
    while (!front_.empty()) {
      const Index next = front_.back();
      front_.pop_back();
      system_.off_diagonal.for_each_entry(next, [&](Index column, double) {
        if (column >= system_.size() || !is_new(column)) return;
        mark(column);
        front_.push_back(static_cast<std::uint32_t>(column));
      });
    }
  }

  // A closed body cannot expand: its sources are shifted so that they sum to zero.
  void balance_closed_bodies() {
    if (system_.closed_bodies == 0) return;
    auto& b = system_.right_side;
    const auto& body = system_.closed_body;
    const auto max_of_bodies = [&] {
      std::vector<double> largest(system_.closed_bodies + 1, 0);
      for (Index row = 0; row < b.size(); ++row) {
        largest[body[row]] = std::max(largest[body[row]], std::abs(b[row]));
      }
      if (system_.shared) system_.shared->largest(largest);
      return largest;
    };
    const auto original = max_of_bodies();
    system_.remove_constants(b);
    system_.remove_constants(b);  // removes the round-off of the first call
    // If all sources were equal, only round-off is left.
    const auto balanced = max_of_bodies();
    for (Index row = 0; row < b.size(); ++row) {
      if (body[row] > 0 && balanced[body[row]] <= 1e-14 * original[body[row]]) b[row] = 0;
    }
  }

  // The constant of a closed body is chosen such that its minimum pressure is zero.
  void set_reference_pressures() {
    const auto& body = system_.closed_body;
    if (system_.closed_bodies == 0) return;
    std::vector<double> minus_minimum(system_.closed_bodies + 1,
                                      -std::numeric_limits<double>::infinity());
    for (Index row = 0; row < body.size(); ++row) {
      minus_minimum[body[row]] = std::max(minus_minimum[body[row]], -solution_[row]);
    }
    if (system_.shared) system_.shared->largest(minus_minimum);
    for (Index row = 0; row < body.size(); ++row) {
      if (body[row] > 0) solution_[row] += minus_minimum[body[row]];
    }
  }

  LinearSystem system_;
  std::vector<std::uint32_t> unknowns_;     // particle of each row
  std::vector<std::uint32_t> row_of_;       // row of each particle; ghosts have that of their owner
  std::vector<std::uint32_t> last_column_;  // last column with an entry, or the row itself
  std::vector<std::uint8_t> is_open_;       // columns connected with a free surface
  std::vector<std::uint32_t> front_;        // of flood()
  std::vector<double> solution_;
};

/// P ← max(P, 0).
template <FluidParticles P>
void clip_negative_pressure(P& particles) {
  const auto p = particles[pressure];
  for_each(p.size(), [&](Index i) { p[i] = std::max(p[i], typename P::Real(0)); });
}

}  // namespace silt::mps
