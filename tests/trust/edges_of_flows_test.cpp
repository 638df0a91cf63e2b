// SPDX-License-Identifier: MIT
// Flows at the edges of what is defined: particles at the same point, at exactly the effective
// radius, in any units. A result is finite and symmetric, or an error names the particles.
// Only with --all: schemes and units at their edges.
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace silt::test::edges_of_flows_test {
namespace {

using mps::Kind;

template <class Scheme, class P>
auto flow_of(const P& particles, const mps::FlowSettings<P::dimension, Scheme>& settings) {
  constexpr int Dim = P::dimension;
  using Real = typename P::Real;
  return Simulation{particles, UniformGrid<Dim, Real>{}, mps::Flow<Scheme, Dim, Real>(settings),
                    SemiImplicit{}};
}

template <class Scheme>
class FlowOf : public ::testing::Test {};
using Schemes = ::testing::Types<mps::Case00, mps::Case10, mps::RecommendedForWallParticles>;
TYPED_TEST_SUITE(FlowOf, Schemes);

TYPED_TEST(FlowOf, CoincidentParticlesIsRefusedWithBothIds) {
  for (const Kind kind : {Kind::fluid, Kind::wall, Kind::dummy}) {
    auto particles = blob<2, double>(4, 1);
    mps::add_particle(particles, particles[position][5], kind);
    auto sim = flow_of<TypeParam>(particles, {.spacing = 1});
    const Bytes before = state_of(sim.particles());
    EXPECT_TRUE(refuses([&] { sim.step(1e-3); }, {"same position", "ids 5 and 16", "step 0"}));
    EXPECT_TRUE(state_of(sim.particles()) == before);
  }
  auto box = cube<2, double>(0, 8);
  box.periodic[0] = true;
  auto sim = flow_of<TypeParam>(fluid_at<2, double>({{0, 1}, {8, 1}, {4, 1}}, box), {.spacing = 1});
  EXPECT_TRUE(refuses([&] { sim.step(1e-3); }, {"same position", "ids 0 and 1"}));
}

// Two particles that move towards each other, in empty space.
auto approaching(const Vec<2>& apart, double speed) {
  auto pair = fluid_at<2, double>({Vec<2>(-apart / 2), Vec<2>(apart / 2)});
  pair[velocity][0] = Vec<2>(speed, -speed / 3);
  pair[velocity][1] = -pair[velocity][0];
  return pair;
}

TYPED_TEST(FlowOf, AlmostCoincidentParticlesIsSymmetricOrRefused) {
  bool was_refused = false;
  for (double r = 2; r > 0; r /= 2) {
    auto sim =
        flow_of<TypeParam>(approaching({r, r / 4}, 1e-3), {.spacing = 1, .gravity = Vec<2>(0, 0)});
    try {
      sim.step(0.1);
    } catch (const Error& error) {
      EXPECT_TRUE(refuses([&] { throw error; }, {"same position", "ids 0 and 1"})) << r;
      was_refused = true;
      continue;
    }
    EXPECT_FALSE(was_refused) << r;
    const auto u = sim.particles()[velocity];
    EXPECT_TRUE(is_finite(Vec<2>(u[0]))) << r;
    EXPECT_TRUE(u[0] == -u[1]) << r;
    EXPECT_LE(u[0].norm(), 1.1e-3) << r;
  }
  EXPECT_TRUE(was_refused);
}

TYPED_TEST(FlowOf, ParticlesAtExactlyTheRadiusIsThatOfIsolatedOnes) {
  const double re = 3;
  const mps::FlowSettings<2, TypeParam> settings{
      .spacing = 1, .gravity = Vec<2>(0, 0), .radius = re, .laplacian_radius = re};
  for (const double r : {re, std::nextafter(re, 4.0), std::nextafter(re, 0.0)}) {
    auto sim = flow_of<TypeParam>(approaching({r, 0}, 1e-3), settings);
    const Vec<2> before = sim.particles()[velocity][0];
    sim.step(0.1);
    const auto u = sim.particles()[velocity];
    EXPECT_TRUE(u[0] == -u[1]);
    EXPECT_LT((u[0] - before).norm(), 1e-15);
    // The original method evaluates the density after it has moved the particles.
    const double n = sim.particles()[mps::number_density][0];
    const bool are_moved = mps::SourceOf<TypeParam>::needs_moved_particles;
    EXPECT_TRUE(r < re || are_moved ? n >= 0 && n < 1e-3 : n == 0) << n;
  }
}

TYPED_TEST(FlowOf, ParticlesAtHalfAPeriodIsSymmetric) {
  // The smallest box that a search accepts for this radius.
  const double re = 3;
  auto box = cube<2, double>(-3, 3);
  box.periodic.fill(true);
  for (const double off : {0.0, 4e-16, -4e-16}) {
    auto pair = approaching({3 + off, 0}, 1e-3);
    pair.set_box(box);
    auto sim = flow_of<TypeParam>(
        pair, {.spacing = 1, .gravity = Vec<2>(0, 0), .radius = re, .laplacian_radius = re});
    sim.step(0.1);
    const auto u = sim.particles()[velocity];
    EXPECT_TRUE(is_finite(Vec<2>(u[0])));
    EXPECT_TRUE(u[0] == -u[1]);
  }
}

TYPED_TEST(FlowOf, PositionsWithTooFewDigitsIsRefused) {
  auto particles = blob<2, double>(4, 1);
  particles[position][5][1] = 1e15;
  auto sim = flow_of<TypeParam>(particles, {.spacing = 1});
  const Bytes before = state_of(sim.particles());
  EXPECT_TRUE(refuses([&] { sim.step(1e-3); },
                      {"mps::Flow: x = (", "a hundredth of the spacing 1 m", "particle 5"}));
  EXPECT_TRUE(state_of(sim.particles()) == before);
}

TYPED_TEST(FlowOf, NoParticlesOrOneOrSolidsAloneCanBeStepped) {
  const std::vector<std::vector<Kind>> all{{},
                                           {Kind::fluid},
                                           {Kind::wall},
                                           {Kind::dummy},
                                           {Kind::wall, Kind::wall, Kind::dummy},
                                           {Kind::fluid, Kind::dummy},
                                           {Kind::fluid, Kind::wall}};
  for (const auto& kinds : all) {
    mps::Fluid<2> particles;
    for (Index k = 0; k < kinds.size(); ++k) {
      mps::add_particle(particles, Vec<2>(double(k), 0), kinds[k]);
    }
    auto sim = flow_of<TypeParam>(particles, {.spacing = 1, .viscosity = 1e-3});
    for (int k = 0; k < 3; ++k) sim.step(1e-2);
    for (Index i = 0; i < kinds.size(); ++i) {
      const auto& u = sim.particles()[velocity][i];
      EXPECT_TRUE(is_finite(Vec<2>(u)));
      EXPECT_EQ(kinds[i] == Kind::fluid, u.norm() > 0);
    }
    EXPECT_TRUE(is_finite(sim.interaction().energy().imbalance()));
    EXPECT_TRUE(is_finite(sim.interaction().energy_of(sim.snapshot()).total()));
    EXPECT_GT(sim.interaction().time_step_limits(sim.particles()).smallest(), 0);
  }
}

// Velocities after a step over the initial speed, of a block that is compressed, in units of length
// of l0: the same for any l0. Nothing if it is refused.
template <class Real>
std::optional<std::vector<Vec<2>>> scaled_velocities(double l0) {
  try {
    auto block = blob<2, Real>(5, Real(l0));
    for (Index i = 0; i < block.size(); ++i) {
      block[velocity][i] = Real(0.05) * (block[position][12] - block[position][i]);
    }
    auto sim = flow_of<mps::Case10>(
        block, {.spacing = l0, .viscosity = 0, .gravity = Vec<2>(0, 0), .max_time_step = 1});
    sim.step(1);
    std::vector<Vec<2>> u;
    for (const auto& each : sim.particles()[velocity]) {
      u.push_back(each.template cast<double>() / l0);
    }
    return u;
  } catch (const Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("FlowSettings: spacing = "))
        << l0 << ": " << error.what();
    return {};
  }
}

template <class Real>
void expect_scaled_velocities() {
  constexpr bool is_double = sizeof(Real) == sizeof(double);
  const auto usual = scaled_velocities<Real>(1);
  ASSERT_TRUE(usual);
  for (int exponent = is_double ? -1074 : -148; exponent < (is_double ? 1020 : 124);
       exponent += is_double ? 16 : 4) {
    const double l0 = std::ldexp(1.0, exponent);
    const auto u = scaled_velocities<Real>(l0);
    if (std::abs(exponent) <= 36) {
      EXPECT_TRUE(u) << "2^" << exponent;
    }
    if (!u) continue;
    double error = 0;
    for (Index i = 0; i < u->size(); ++i) {
      error = std::max(error, ((*u)[i] - (*usual)[i]).norm());
    }
    EXPECT_LT(error, is_double ? 1e-6 : 1e-3) << "2^" << exponent;
  }
}

TEST(Flow, InAnyUnitsHasScaledVelocitiesOrIsRefused) { expect_scaled_velocities<double>(); }
TEST(Flow, InAnyUnitsHasScaledVelocitiesOrIsRefusedInFloat) { expect_scaled_velocities<float>(); }

}  // namespace
}  // namespace silt::test::edges_of_flows_test
