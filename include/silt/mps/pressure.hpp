// SPDX-License-Identifier: MIT
// The pressure equation ∇²P = source as a symmetric system over the particles that carry pressure,
// which are those of fluid and walls, and do not lie on the free surface.
//
//   Σ_j w_ij (P_i − P_j) = −source_i λ n0 / (2d),   P_j = 0 on the free surface, no dummies in Σ
//
// Positive definite for a body of fluid that touches a surface. One that does not (a closed full
// tank) has its pressure up to a constant.
#pragma once

#include <silt/core/linear_system.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/operators.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace silt::mps {

class PressureEquation {
 public:
  /// Numbers the unknowns: fluid and wall particles off the surface that have a neighbour with
  /// pressure. `neighbours` is a search or a Neighbourhood; source(i) gives ∇²P [Pa/m²].
  template <FluidParticles P, class S, class T, class Source>
  void assemble(const P& particles, const S& neighbours, const T& stencil, Source&& source) {
    const auto kinds = particles[kind];
    assemble(particles, neighbours, stencil, source,
             [&](Index i) { return kinds[i] != Kind::dummy; });
  }
  /// The same where carries_pressure(i) says which particles take part, instead of all but dummies.
  template <FluidParticles P, class S, class T, class Source, class Carries>
  void assemble(const P& particles, const S& neighbours, const T& stencil, Source&& source,
                Carries&& carries_pressure) {
    number_unknowns(particles, neighbours, stencil, carries_pressure);
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
    system_.off_diagonal.build(unknowns_.size(), [&](Index row, auto&& add) {
      const Index i = unknowns_[row];
      double diagonal = 0;
      double to_surface = 0;
      std::uint32_t last_column = static_cast<std::uint32_t>(row);
      for_each_weighted(neighbours, i, stencil, [&](Index j, const auto&, auto weight, auto) {
        const std::uint32_t column = row_of_[j];
        if (column == dummy || !links(weight, stencil)) return;
        const double w = double(static_cast<float>(weight));  // as the system keeps it
        diagonal += w;
        if (column == zero) {
          to_surface += w;
        } else {
          add(column, -w);
          last_column = std::max(last_column, column);
        }
      });
      system_.diagonal[row] = diagonal;
      system_.right_side[row] = -double(source(i)) * scale;
      geometry.to_surface[row] = static_cast<float>(to_surface);
      last_column_[row] = last_column;
      for (int k = 0; k < P::dimension; ++k) geometry.points[row][Index(k)] = double(x[i][k]);
    });
    find_closed_bodies();
    balance_closed_bodies();
  }

  /// Solves from the pressures the particles have, and gives them the new ones; elsewhere P = 0.
  /// They are left as they were unless the solve converged.
  template <FluidParticles P, class L>
  SolveReport solve(P& particles, L& solver) {
    using Real = typename P::Real;
    const auto values = particles[pressure];
    solution_.resize(unknowns_.size());
    for_each(unknowns_.size(), [&](Index row) { solution_[row] = double(values[unknowns_[row]]); });
    system_.remove_constants(solution_);
    const SolveReport report = solver.solve(system_, solution_);
    if (report.reason == SolveReport::Reason::not_converged ||
        report.reason == SolveReport::Reason::broke_down) {
      return report;
    }
    settle_closed_bodies();
    for_each(values.size(), [&](Index i) {
      values[i] = row_of_[i] < unknowns_.size() ? Real(solution_[row_of_[i]]) : Real(0);
    });
    return report;
  }

  const LinearSystem& system() const noexcept { return system_; }

 private:
  // What stands in row_of_ for particles without a row: those with P = 0, and dummies.
  static constexpr std::uint32_t zero = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t dummy = zero - 1;

  // A weight that single precision loses among those of a full neighbourhood is none. Else a body
  // that all but lost touch with a surface had a pressure of its source over next to nothing, which
  // no solver finds in double precision.
  template <class Real, class T>
  static bool links(Real weight, const T& stencil) {
    return static_cast<float>(weight) > 0x1p-26f * static_cast<float>(stencil.n0);
  }

  template <class P, class S, class T, class Carries>
  void number_unknowns(const P& particles, const S& neighbours, const T& stencil,
                       const Carries& carries_pressure) {
    const auto on_surface = particles[surface];
    row_of_.resize(particles.total());
    for_each(particles.size(), [&](Index i) {
      row_of_[i] = zero;
      if (!carries_pressure(i)) {
        row_of_[i] = dummy;
        return;
      }
      if (on_surface[i]) return;
      const bool is_connected = any_weighted(neighbours, i, stencil, [&](Index j, auto w) {
        return carries_pressure(particles.owner(j)) && links(w, stencil);
      });
      if (is_connected) row_of_[i] = 0;
    });
    unknowns_.clear();
    for (Index i = 0; i < particles.size(); ++i) {
      if (row_of_[i] != 0) continue;
      row_of_[i] = static_cast<std::uint32_t>(unknowns_.size());
      unknowns_.push_back(static_cast<std::uint32_t>(i));
    }
    for (Index i = particles.size(); i < particles.total(); ++i) {
      row_of_[i] = row_of_[particles.owner(i)];
    }
  }

  // A body of fluid with no free surface (a closed full tank) fixes its pressure up to a constant
  // only. Such bodies are found by walking from the surface: what is not reached is closed.
  void find_closed_bodies() {
    const Index n = unknowns_.size();
    const auto& entries = system_.off_diagonal;
    is_open_.assign(n, 0);
    // Surfaces mostly lie on top, so that one pass downwards reaches nearly all, from the last that
    // each row is connected with.
    for (Index row = n; row-- > 0;) {
      is_open_[row] = system_.geometry.to_surface[row] > 0 || is_open_[last_column_[row]];
    }
    for (Index row = 0; row < n; ++row) {
      if (is_open_[row] || !entries.has_entry_in(row, is_open_)) continue;
      flood(row, [&](Index at) { return !is_open_[at]; }, [&](Index at) { is_open_[at] = true; });
    }
    auto& body = system_.closed_body;
    system_.closed_bodies = 0;
    body.clear();
    for (Index row = 0; row < n; ++row) {
      if (is_open_[row]) continue;
      if (body.empty()) body.assign(n, 0);
      if (body[row] > 0) continue;
      const auto number = static_cast<std::uint32_t>(++system_.closed_bodies);
      flood(row, [&](Index at) { return body[at] == 0; }, [&](Index at) { body[at] = number; });
    }
  }

  // Marks the row and all that can be reached from it over rows that are new.
  template <class IsNew, class Mark>
  void flood(Index row, IsNew&& is_new, Mark&& mark) {
    mark(row);
    front_.assign(1, static_cast<std::uint32_t>(row));
    while (!front_.empty()) {
      const Index at = front_.back();
      front_.pop_back();
      system_.off_diagonal.for_each_entry(at, [&](Index column, double) {
        if (!is_new(column)) return;
        mark(column);
        front_.push_back(static_cast<std::uint32_t>(column));
      });
    }
  }

  // Fluid that cannot leave cannot expand: in a closed body the sources add up to nothing.
  void balance_closed_bodies() {
    if (system_.closed_bodies == 0) return;
    auto& b = system_.right_side;
    const auto& body = system_.closed_body;
    const auto find_largest = [&] {
      std::vector<double> largest(system_.closed_bodies + 1, 0);
      for (Index row = 0; row < b.size(); ++row) {
        largest[body[row]] = std::max(largest[body[row]], std::abs(b[row]));
      }
      return largest;
    };
    const auto before = find_largest();
    system_.remove_constants(b);
    system_.remove_constants(b);  // what rounding left of them
    // Sources that were all alike leave nothing but rounding, which is no pressure's.
    const auto after = find_largest();
    for (Index row = 0; row < b.size(); ++row) {
      if (body[row] > 0 && after[body[row]] <= 1e-14 * before[body[row]]) b[row] = 0;
    }
  }

  // Of all pressures that differ by a constant, a closed body takes those whose lowest is zero.
  void settle_closed_bodies() {
    const auto& body = system_.closed_body;
    if (system_.closed_bodies == 0) return;
    std::vector<double> lowest(system_.closed_bodies + 1, std::numeric_limits<double>::infinity());
    for (Index row = 0; row < body.size(); ++row) {
      lowest[body[row]] = std::min(lowest[body[row]], solution_[row]);
    }
    for (Index row = 0; row < body.size(); ++row) {
      if (body[row] > 0) solution_[row] -= lowest[body[row]];
    }
  }

  LinearSystem system_;
  std::vector<std::uint32_t> unknowns_;     // particle of each row
  std::vector<std::uint32_t> row_of_;       // row of each particle, ghosts as their owners
  std::vector<std::uint32_t> last_column_;  // with an entry in each row, or the row itself
  std::vector<std::uint8_t> is_open_;       // rows that a surface reaches
  std::vector<std::uint32_t> front_;
  std::vector<double> solution_;
};

}  // namespace silt::mps
