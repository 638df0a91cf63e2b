// SPDX-License-Identifier: MIT
// The pressure in the steps of a flow: where it is unknown, the equation for it, and its solution.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/mixture.hpp>
#include <silt/mps/operator/corrected_gradient.hpp>
#include <silt/mps/operator/kept_moments.hpp>
#include <silt/mps/policy/source.hpp>
#include <silt/mps/pressure/pressure_equation.hpp>
#include <silt/mps/pressure/pressure_rise.hpp>
#include <silt/mps/pressure/solve_check.hpp>
#include <silt/mps/record/flow_seconds.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/view/flow_operators.hpp>
#include <silt/mps/view/particle_view.hpp>
#include <silt/mps/view/pressure_boundary.hpp>

#include <concepts>
#include <type_traits>
#include <utility>

namespace silt::mps {

/// Finds the pressures of a flow from ∇²P = source, with the policies of a Scheme and a Solver. In
/// each step, begin(), find_boundary() and solve() are called in this order.
template <class Scheme, int Dim, class RealType, LinearSolver Solver>
class FlowPressure {
 public:
  using Real = RealType;

  /// Throws if a setting of the solver is out of range.
  FlowPressure(const SourceOf<Scheme>& source, Solver solver)
      : source_(source), solver_(std::move(solver)) {
    solver_.check();
  }

  /// Before the velocities are changed: begins the step of the source.
  template <FluidParticles P>
  void begin(const StepView<Scheme, P>& step) {
    moments_.clear();
    if constexpr (BeginsSteps<SourceOf<Scheme>>) {
      static_assert(requires { source_.begin(step); },
                    "mps: begin() of the source cannot be called with a const StepView");
      source_.begin(step);
    }
  }

  /// Finds n (5), the free surface (13), (17), and which particles have a pressure. From then until
  /// the gradient of the pressure has been found, particles must not move.
  template <FluidParticles P>
  void find_boundary(P& particles, const FlowOperators<Scheme, Dim, Real>& operators,
                     const SurfaceOf<Scheme>& criterion) {
    if constexpr (std::same_as<GradientOf<Scheme>, CorrectedGradient>) {
      moments_.begin(particles.size());
    }
    boundary_.find(particles, operators, criterion);
  }

  /// ∇²P = source      (9), (16), with the pressures of the previous step as initial guess. Throws
  /// if the solve does not converge. Velocities and pressures of ghosts must be up to date;
  /// afterwards, those pressures are again. The positions are those of a time [s].
  template <FluidParticles P>
  void solve(P& particles, const StepView<Scheme, P>& step, const PressureRise<Scheme, P>& rise,
             double time, FlowSeconds& seconds) {
    find_surface_pressures(step, time);
    // In the first step, the pressures before it are unknown to sources that use them: zero, in
    // most cases. A kick would be left.
    constexpr int max_passes = 30;
    const int passes = UsesLastPressure<SourceOf<Scheme>> && step.is_first ? max_passes : 1;
    for (int pass = 0; pass < passes; ++pass) {
      timed(seconds.assembly, [&] {
        const auto source_of = [&](Index i) {
          return run_inlined([&] { return source(step, i, rise); });
        };
        equation_.assemble(particles, step.operators.pressure_neighbours(),
                           step.operators.laplacian_stencil(), source_of, boundary_,
                           step.operators.bulk_volumes());
      });
      timed(seconds.solve, [&] { report_ = equation_.solve(particles, solver_); });
      check_solve(particles, report_, step.time_step);
      if (step.settings.clip_negative_pressure) clip_negative_pressure(particles);
      particles.refresh_ghosts(pressure);
      if (report_.iterations == 0) return;  // they were the pressures of this step
    }
  }

  /// Iterations and residual of the last solve, also of one that failed.
  const SolveReport& report() const noexcept { return report_; }
  const PressureBoundary<Scheme>& boundary() const noexcept { return boundary_; }
  const KeptMoments<Dim, Real>& moments() const noexcept { return moments_; }

 private:
  // ∇²P of particle i, without what images are known to add to it: (9), (16).
  template <class P>
  double source(const StepView<Scheme, P>& step, Index i,
                const PressureRise<Scheme, P>& rise) const {
    const double weight = boundary_.weight_of_surface(i);
    double own = weight > 0 ? source_of_surface(step, i, weight) : source_.value(step.at(i));
    if constexpr (is_in_mixture<Scheme>) {
      // ∇·u = −(1/ε) Dε/Dt at the end of the step.
      if (!(weight > 0)) own += step.settings.density / step.time_step * relative_rate(step, i);
    }
    return own - step.at(i).laplacian_of_rises(rise);
  }
  // (1/ε) Dε/Dt around particle i [1/s], as n_i changes by it: a mean with the weights of n_i.
  // Those of the particles alone differ, as each has its own way past the second phase. As a
  // source, they made energy without limit.
  template <class Step>
  static double relative_rate(const Step& step, Index i) {
    const auto& volumes = step.operators.bulk_volumes();
    const auto rate = step.particles.with_ghosts(fluid_fraction_rate);
    const auto& stencil = step.operators.stencil();
    double weights = double(stencil.kernel.weight(Real(0)) * volumes[i]);
    double sum = weights * double(volumes[i] * rate[i]);
    step.operators.for_each(i, [&](const auto& j) {
      weights += double(j.weight);
      sum += double(j.weight * volumes[j.index] * rate[j.index]);
    });
    return sum / weights;
  }
  // That with which the pressure outside of the surface has this weight.
  template <class Step>
  double source_of_surface(const Step& step, Index i, double weight) const {
    if (surface_pressures_.empty()) return 0;
    const auto& stencil = step.operators.laplacian_stencil();
    return -2 * Dim / double(stencil.lambda * stencil.n0) * weight * surface_pressures_[i];
  }
  template <class Step>
  void find_surface_pressures(const Step& step, double time) {
    const auto& pressure_at = step.settings.surface_pressure;
    if (!pressure_at) return;
    const auto& particles = step.particles;
    const auto x = particles[position];
    surface_pressures_.resize(particles.size());
    for_each(particles.size(), [&](Index i) {
      surface_pressures_[i] = 0;
      const double weight = boundary_.weight_of_surface(i);
      if (!(weight > 0)) return;
      // Where the surface is outside of the cell. At an edge of the surface, a linear pressure is
      // met then.
      const Vec<Dim> outwards = -step.at(i).laplacian_moment().template cast<double>() / weight;
      surface_pressures_[i] = pressure_at(x[i].template cast<double>() + outwards, time);
    });
    const Index broken =
        first_where(particles.size(), [&](Index i) { return !is_finite(surface_pressures_[i]); });
    if (broken == no_index) return;
    fail({"FlowSettings: surface_pressure = ", surface_pressures_[broken], " Pa at ",
          to_text(typename std::remove_cvref_t<decltype(particles)>::Vec(x[broken])), " m and ",
          time, " s is not finite; return a finite pressure"},
         {.particle = broken, .id = particles.id(broken)});
  }

  SourceOf<Scheme> source_;  // which may keep something from begin() to the end of the step
  Solver solver_;
  PressureBoundary<Scheme> boundary_;
  KeptMoments<Dim, Real> moments_;
  PressureEquation equation_;
  Buffer<double>
      surface_pressures_;  // of particles whose cell is on the surface [Pa]; empty: all 0
  SolveReport report_;
};

}  // namespace silt::mps
