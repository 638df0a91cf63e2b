// SPDX-License-Identifier: MIT
// The pressure equation ∇²P = source as a symmetric system. The unknowns are the pressures of the
// fluid and wall particles that do not lie on the free surface; with OuterSurface, also of those.
//
//   Σ_j w_ij (P_i − P_j) = −source_i λ n0 / (2d),   P_j = 0 on the free surface, no dummies in Σ
//
// Positive definite for a body of fluid with a free surface; without one, see closed_bodies.hpp.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/operators.hpp>
#include <silt/mps/pressure/closed_bodies.hpp>
#include <silt/mps/pressure/shared_pressures.hpp>

#include <algorithm>
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
    assemble(particles, neighbours, stencil, source, boundary, EqualVolumes{});
  }
  /// The same with BulkVolumes: a row is multiplied by that of its particle, as its weights have
  /// those of the neighbours. The system is symmetric then. And with the response R of a second
  /// phase, which gives way to a change of the pressure since the last step (k):
  ///
  ///   Σ_j w_ij (P_i − P_j) + Σ_j R_ij w_ij [(P_i − P_j) − (P_i − P_j)^k] = −source_i λ n0 / (2d)
  template <FluidParticles P, class S, class T, class Source, class Boundary, class Volumes>
  void assemble(const P& particles, const S& neighbours, const T& stencil, Source&& source,
                const Boundary& boundary, const Volumes& volumes) {
    using Processes = silt::detail::Processes<P>;
    system_.shared.reset();
    number_unknowns(particles, neighbours, stencil, boundary);
    if constexpr (Processes::are_several) {
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
    const float least_weight = negligible_weight(stencil);
    const Index unknowns = unknowns_.size();
    const std::uint32_t* const row_of = row_of_.data();
    const auto last = particles.with_ghosts(pressure);
    const auto fill_row = [&, least_weight, unknowns, row_of](Index row, auto&& add) {
      const Index i = unknowns_[row];
      const double volume = double(volumes[i]);
      const double response_of_own = double(volumes.response(i, i));
      double to_surface = boundary.weight_of_surface(i) * volume * (1 + response_of_own);
      double of_last = 0;  // Σ_j R w (P_i − P_j)^k
      if constexpr (!Volumes::are_one) {
        of_last = response_of_own * boundary.weight_of_surface(i) * volume * double(last[i]);
      }
      double diagonal = to_surface;
      std::uint32_t last_column = static_cast<std::uint32_t>(row);
      for_each_weighted(neighbours, i, stencil, [&](Index j, const auto&, auto weight, auto) {
        const std::uint32_t column = row_of[j];
        float stored = static_cast<float>(weight);  // as in the system
        double of_response = 0;
        if constexpr (!Volumes::are_one) {
          of_response = double(volumes.response(i, j));
          stored = static_cast<float>(double(weight) * volume * (1 + of_response));
        }
        if (column == excluded || !(stored > least_weight)) return;
        const double w = double(stored);
        if constexpr (!Volumes::are_one) {
          of_last += of_response / (1 + of_response) * w * double(last[i] - last[j]);
        }
        diagonal += w;
        if (column == zero) {
          to_surface += w;
        } else {
          add(column, -w);
          if (!Processes::are_several || column < unknowns) {
            last_column = std::max(last_column, column);
          }
        }
      });
      system_.diagonal[row] = diagonal;
      system_.right_side[row] = -double(source(i)) * scale * volume + of_last;
      geometry.to_surface[row] = static_cast<float>(to_surface);
      last_column_[row] = last_column;
      for (int k = 0; k < P::dimension; ++k) geometry.points[row][Index(k)] = double(x[i][k]);
    };
    system_.off_diagonal.build(unknowns_.size(), system_.columns(), fill_row);
    closed_bodies_.find(system_, last_column_);
    if constexpr (Processes::are_several) {
      ClosedBodies::join(system_, process_of(particles).rank);
    }
    ClosedBodies::balance(system_);
  }

  /// Solves for the pressures, with the present ones as initial guess; particles that are not
  /// unknowns get P = 0. Pressures are changed only if the solve converged.
  template <FluidParticles P, class L>
  SolveReport solve(P& particles, L& solver) {
    static_assert(silt::detail::are_of_one_process<P> || requires { requires L::shares_unknowns; },
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
    ClosedBodies::set_minimum_to_zero(system_, solution_);
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
    return static_cast<float>(weight) > negligible_weight(stencil);
  }
  template <class T>
  static float negligible_weight(const T& stencil) {
    return 0x1p-26f * static_cast<float>(stencil.n0);
  }

  struct EqualVolumes {
    static constexpr bool are_one = true;
    constexpr double operator[](Index) const { return 1; }
    constexpr double response(Index, Index) const { return 0; }
  };
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

  LinearSystem system_;
  Buffer<std::uint32_t> unknowns_;     // particle of each row
  Buffer<std::uint32_t> row_of_;       // row of each particle; ghosts have that of their owner
  Buffer<std::uint32_t> last_column_;  // last column with an entry, or the row itself
  ClosedBodies closed_bodies_;
  std::vector<double> solution_;
};

/// P ← max(P, 0).
template <FluidParticles P>
void clip_negative_pressure(P& particles) {
  const auto p = particles[pressure];
  for_each(p.size(), [&](Index i) { p[i] = std::max(p[i], typename P::Real(0)); });
}

}  // namespace silt::mps
