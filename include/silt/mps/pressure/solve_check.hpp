// SPDX-License-Identifier: MIT
// The reasons for which the solve of a pressure equation fails.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <cmath>

namespace silt::mps {

/// Throws if the solve of a step of time_step [s] did not converge; the pressures of the particles
/// are those from which it started.
template <FluidParticles P>
void check_solve(const P& particles, const SolveReport& report, double time_step) {
  if (report.reason == SolveReport::Reason::converged ||
      report.reason == SolveReport::Reason::nothing_to_solve) {
    return;
  }
  const auto p = particles[pressure];
  const Index broken = first_where(p.size(), [&](Index i) { return !is_finite(p[i]); });
  if (broken != no_index) {
    fail(
        {"mps::Flow: the pressure ", double(p[broken]), " Pa is not finite; set a finite pressure"},
        {.particle = broken, .id = particles.id(broken)});
  }
  if (!is_finite(report.residual)) {
    const double highest = largest(p.size(), 0.0, [&](Index i) { return std::abs(double(p[i])); });
    fail(
        {"mps::Flow: time_step = ", time_step, " s and pressures of up to ", highest,
         " Pa give a pressure equation that overflows; set a longer time step or lower pressures"});
  }
  fail({"mps::Flow: the pressure solve did not converge: residual ", report.residual, " after ",
        report.iterations, " iterations for ", report.unknowns,
        " unknowns; decrease the time step, or increase max_iterations or tolerance"});
}

}  // namespace silt::mps
