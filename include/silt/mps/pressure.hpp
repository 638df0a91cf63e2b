// SPDX-License-Identifier: MIT
// The pressure equation ∇²P = source as a symmetric system over the particles that carry pressure and
// do not lie on the free surface.
//
//   Σ_j w_ij (P_i − P_j) = −source_i λ n0 / (2d),   P_j = 0 on the free surface, no dummies in Σ
#pragma once

#include <silt/core/linear_system.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/operators.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace silt::mps {

class PressureEquation {
 public:
  /// Numbers the unknowns: fluid and wall particles off the surface that have a neighbour with
  /// pressure. source(i) gives ∇²P [Pa/m²].
  template <FluidParticles P, class S, class T, class Source>
  void assemble(const P& particles, const S& search, const T& stencil, Source&& source) {
    number_unknowns(particles, search, stencil);
    const auto kinds = particles.with_ghosts(kind);
    system_.diagonal.resize(unknowns_.size());
    system_.right_side.resize(unknowns_.size());
    auto& geometry = system_.geometry;
    geometry.spacing = double(stencil.spacing);
    geometry.full_diagonal = double(stencil.n0);
    geometry.points.resize(unknowns_.size());
    geometry.second_moments.resize(unknowns_.size());
    geometry.to_surface.resize(unknowns_.size());
    const auto x = particles[position];
    const double scale = double(stencil.lambda) * double(stencil.n0) / (2 * T::dimension);
    system_.off_diagonal.build(unknowns_.size(), [&](Index row, auto&& add) {
      const Index i = unknowns_[row];
      double diagonal = 0;
      double to_surface = 0;
      std::array<double, 3> point{};
      std::array<double, 3> second_moments{};
      for (int k = 0; k < P::dimension; ++k) point[Index(k)] = double(x[i][k]);
      for_each_weighted(search, i, stencil, [&](Index j, const auto& r_ij, auto, auto w) {
        if (kinds[j] == Kind::dummy) return;
        diagonal += double(w);
        const Index column = row_of_[particles.owner(j)];
        if (column == nowhere) {
          to_surface += double(w);
          return;
        }
        add({column, -double(w)});
        for (int k = 0; k < P::dimension; ++k) {
          second_moments[Index(k)] += double(w) * squared(double(r_ij[k]));
        }
      });
      system_.diagonal[row] = diagonal;
      system_.right_side[row] = -double(source(i)) * scale;
      geometry.points[row] = point;
      geometry.second_moments[row] = second_moments;
      geometry.to_surface[row] = to_surface;
    });
    find_closed_bodies();
    // Fluid that cannot leave cannot expand: in a closed body the sources add up to nothing.
    system_.remove_constants(system_.right_side);
  }

  /// Solves from the pressures the particles have, and gives them the new ones; elsewhere P = 0.
  /// They are left as they were unless the solve converged.
  template <FluidParticles P, class L>
  SolveReport solve(P& particles, L& solver) {
    using Real = typename P::Real;
    const auto values = particles[pressure];
    solution_.resize(unknowns_.size());
    for_each(unknowns_.size(), [&](Index row) { solution_[row] = double(values[unknowns_[row]]); });
    const SolveReport report = solver.solve(system_, solution_);
    if (report.reason == SolveReport::Reason::not_converged ||
        report.reason == SolveReport::Reason::broke_down) {
      return report;
    }
    settle_closed_bodies();
    for_each(values.size(), [&](Index i) {
      values[i] = row_of_[i] == nowhere ? Real(0) : Real(solution_[row_of_[i]]);
    });
    return report;
  }

  const LinearSystem& system() const noexcept { return system_; }

 private:
  template <class P, class S, class T>
  void number_unknowns(const P& particles, const S& search, const T& stencil) {
    const auto kinds = particles[kind];
    const auto kinds_around = particles.with_ghosts(kind);
    const auto on_surface = particles[surface];
    is_unknown_.resize(particles.size());
    for_each(particles.size(), [&](Index i) {
      bool connected = false;
      if (kinds[i] != Kind::dummy && !on_surface[i]) {
        for_each_weighted(search, i, stencil, [&](Index j, const auto&, auto, auto w) {
          connected |= kinds_around[j] != Kind::dummy && w > 0;
        });
      }
      is_unknown_[i] = connected;
    });
    unknowns_.clear();
    row_of_.assign(particles.size(), nowhere);
    for (Index i = 0; i < particles.size(); ++i) {
      if (!is_unknown_[i]) continue;
      row_of_[i] = unknowns_.size();
      unknowns_.push_back(i);
    }
  }

  // A body of fluid with no free surface (a closed full tank) fixes its pressure up to a constant
  // only. Such bodies are found by walking from the surface: what is not reached is closed.
  void find_closed_bodies() {
    constexpr Index open = 0;
    auto& body = system_.closed_body;
    body.assign(unknowns_.size(), nowhere);
    system_.closed_bodies = 0;
    for (Index row = 0; row < unknowns_.size(); ++row) {
      if (system_.geometry.to_surface[row] > 0 && body[row] == nowhere) flood(row, open);
    }
    for (Index row = 0; row < unknowns_.size(); ++row) {
      if (body[row] == nowhere) flood(row, ++system_.closed_bodies);
    }
  }

  void flood(Index row, Index body) {
    front_.assign(1, row);
    system_.closed_body[row] = body;
    while (!front_.empty()) {
      const Index at = front_.back();
      front_.pop_back();
      for (const auto& [column, value] : system_.off_diagonal[at]) {
        if (system_.closed_body[column] != nowhere || value == 0) continue;
        system_.closed_body[column] = body;
        front_.push_back(column);
      }
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
  std::vector<Index> unknowns_;  // particle of each row
  std::vector<Index> row_of_;    // row of each particle, nowhere: P = 0
  std::vector<char> is_unknown_;
  std::vector<Index> front_;
  std::vector<double> solution_;
};

}  // namespace silt::mps
