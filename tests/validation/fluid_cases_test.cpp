// SPDX-License-Identifier: MIT
// Exact solutions, and the corresponding flows at a low resolution. docs/verification.md has them
// at full resolution.
// Only with --all: a comparison of whole flows.
#include "support/fluid_cases/all.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace silt::test::fluid_cases_test {
namespace {

using namespace fluid_cases;

TEST(OscillatingDropSolution, HasThePeriodsAndSemiAxesOfMonaghanAndRafiee) {
  // 2013, A0/B0 = 1 and 0.4.
  EXPECT_NEAR(OscillatingDrop{.a0 = 1}.period(), 4.827, 1e-3);
  EXPECT_NEAR(OscillatingDrop{.a0 = 0.4}.period(), 4.526, 1e-3);
  double max_axis = 0;
  for (double t = 0; t < 5; t += 0.01) max_axis = std::max(max_axis, OscillatingDrop{}.at(t).a);
  EXPECT_NEAR(max_axis, 1.932, 1e-3);
}

TEST(OscillatingDropSolution, ConservesAreaAndEnergy) {
  const OscillatingDrop drop;
  // Energy over m/8, of the velocity (A x, −A y) and the potential B0² r²/2.
  const auto energy = [&](const OscillatingDrop::State& s) {
    return (s.rate * s.rate + drop.b0 * drop.b0) * (s.a * s.a + s.b * s.b);
  };
  const auto later = drop.at(10);
  EXPECT_NEAR(later.a * later.b, 1, 1e-9);
  EXPECT_NEAR(energy(later), energy(drop.start()), 1e-8);
}

TEST(OscillatingDropSolution, IsMonaghansEllipseWithoutForce) {
  // J.J. Monaghan (1994): A0 = 100 1/s, at 0.0076 s.
  const auto stretched = OscillatingDrop{.a0 = 100, .b0 = 0}.at(0.0076);
  EXPECT_NEAR(stretched.a, 1.9445, 1e-4);
  EXPECT_NEAR(stretched.b, 0.5143, 1e-4);
}

TEST(RotatingSquareSolution, IsZeroOnTheSidesAndSatisfiesPoissonsEquation) {
  const RotatingSquare square{.side = 2, .omega = 3};
  EXPECT_NEAR(square.pressure_at({0, 0}) / (density * 9 * 4), -0.14734, 1e-5);
  EXPECT_NEAR(square.pressure_at({1, 0.3}), 0, 1e-6);
  const double h = 1e-2;
  const Vec<2> x{0.2, -0.4};
  double laplacian = -4 * square.pressure_at(x);
  for (const Vec<2>& step : {Vec<2>(h, 0), Vec<2>(-h, 0), Vec<2>(0, h), Vec<2>(0, -h)}) {
    laplacian += square.pressure_at(x + step);
  }
  EXPECT_NEAR(laplacian / (h * h) / (2 * density * 9), 1, 1e-2);
}

TEST(TaylorGreenSolution, DecaysAtTheRateOfViscosity) {
  const TaylorGreen flow;
  EXPECT_NEAR(flow.decay(), -0.7896, 1e-4);
  EXPECT_NEAR(flow.velocity_at({0, 0.25}, 0)[0], -1, 1e-12);
}

TEST(StandingWaveSolution, HasThePeriodOfLinearTheory) {
  EXPECT_NEAR(StandingWave{}.period(), 0.8018, 1e-4);
  EXPECT_NEAR((StandingWave{.length = 2, .depth = 1}.period()), 1.1339, 1e-4);
}

TEST(LargestGap, IsTheLargestEmptyCircleOfALatticeWithoutAndWithAHole) {
  auto fluid = taylor_green(10).start;
  EXPECT_NEAR(largest_gap(fluid, 0.1), 0.1 * std::sqrt(0.5), 1e-12);
  fluid.remove_if([](Index i) { return i == 0; });
  EXPECT_NEAR(largest_gap(fluid, 0.1), 0.1, 1e-12);
}

TEST(LargestBody, IsTheFractionOfParticlesInTheLargerOfTwoBodies) {
  mps::Fluid<2> fluid;
  for (const double x : {0.0, 1.0, 2.0, 5.0}) mps::add_particle(fluid, {x, 0}, mps::Kind::fluid);
  EXPECT_EQ(largest_body(fluid, 1.5), 0.75);
}

// All findings of a case.
template <class Scheme>
std::vector<Finding> run(const Choice& choice) {
  const FluidCase flow = make(choice);
  auto simulation = simulation_of<Scheme>(flow, {});
  Notes notes(flow);
  simulation.run({.until = flow.until}, notes);
  return flow.findings(notes.history());
}

// The finding whose name begins with `begin`.
Finding named(const std::vector<Finding>& findings, const std::string& begin) {
  for (const Finding& finding : findings) {
    if (finding.quantity.starts_with(begin)) return finding;
  }
  fail("there is no finding " + begin);
}

TEST(FallingBlock, HasNoPressureAndKeepsItsShapeInPnuMps) {
  for (const Finding& finding : run<mps::Case10>({.name = "falling_block", .spacing = 0.05})) {
    EXPECT_TRUE(finding.holds()) << finding.quantity << " is " << finding.measured;
  }
}

TEST(RotatingSquare, ConservesItsAngularMomentumForOneTurn) {
  const auto findings = run<mps::Recommended>({.name = "rotating_square", .spacing = 0.05});
  const Finding spin = named(findings, "angular momentum");
  EXPECT_LT(spin.error(), 0.02) << spin.measured;
}

TEST(OscillatingDrop, HasThePeriodOfTheExactSolutionSlow) {
  const auto findings =
      run<mps::Recommended>({.name = "oscillating_drop", .spacing = 0.05, .swing = 0.4});
  for (const char* quantity : {"period", "longest semi-axis"}) {
    const Finding finding = named(findings, quantity);
    EXPECT_TRUE(finding.holds()) << quantity << ' ' << finding.measured;
  }
}

}  // namespace
}  // namespace silt::test::fluid_cases_test
