// SPDX-License-Identifier: MIT
// The watch: a step that went wrong throws, with the grain, the wall, the value and what to do, and
// the simulation is as before the step.
#include <silt/dem.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/euler.hpp"
#include "support/fluid.hpp"
#include "support/grains.hpp"
#include "support/triangles.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace silt::test::watch_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double R = pebble.radius;

const dem::CundallStrack soft{.normal_stiffness = 1e3};

// A step of dt fails with these words about the grain with this id, and changes nothing.
template <class Sim>
void expect_refused(Sim& sim, double dt, const std::string& words, Id id) {
  const auto before = sim.particles();
  try {
    sim.step(dt);
    ADD_FAILURE() << "no error with: " << words;
    return;
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_EQ(error.where().id, std::optional<Id>(id)) << text;
    EXPECT_EQ(error.where().step, std::optional<std::uint64_t>(sim.steps())) << text;
    EXPECT_EQ(error.where().time, std::optional<double>(sim.time())) << text;
  }
  for (Index i = 0; i < before.size(); ++i) {
    EXPECT_EQ(sim.particles()[position][i], before[position][i]);
    EXPECT_EQ(sim.particles()[velocity][i], before[velocity][i]);
  }
}

TEST(Watch, RefusesAGrainThatMovesByMoreThanHalfItsRadius) {
  for (const double share : {0.49, 0.51}) {
    const double dt = 1e-4;
    Simulation sim{one_grain<3>({0, 0, 0}, {0, 0, share * R / dt}), BruteForce<3>{},
                   dem::Contacts{soft}, Leapfrog{}};
    if (share < 0.5) {
      sim.step(dt);
    } else {
      expect_refused(
          sim, dt, "velocity = (0, 0, 51) m/s moved a grain with the radius 0.01 m by 0.0051 m", 0);
    }
  }
}

TEST(Watch, ComparesEachGrainWithItsOwnRadius) {
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, {.radius = 1e-3, .density = 2500});
  dem::add_grain(grains, {1, 0}, {.radius = 1e-2, .density = 2500});
  grains[velocity][1] = {1, 0};
  Simulation sim{grains, BruteForce<2>{}, dem::Contacts{soft}, Leapfrog{}};
  sim.step(4e-3);  // 4 small radii, but only 0.4 of its own
  sim.particles()[velocity][0] = {1, 0};
  expect_refused(sim, 4e-3, "radius 0.001 m by 0.004 m in a step", 0);
}

TEST(Watch, RefusesAGrainThatWouldPassThroughAnother) {
  Simulation sim{two_grains<3>(R, {-1e4, 0, 0}), BruteForce<3>{}, dem::Contacts{soft}, Leapfrog{}};
  expect_refused(sim, 1e-5, "more than max_displacement = 0.5 of the radius", 1);
}

// The mesh is so soft that the grain is not stopped before its centre has passed.
TEST(Watch, RefusesAGrainThatPassesThroughASoftMesh) {
  const dem::CundallStrack very_soft{.normal_stiffness = 10};
  Triangles square;
  add_patch(square, 1, [](double u, double v) { return Vec<3>(u - 0.6, v - 0.5, 0); });
  Simulation sim{one_grain<3>({0, 0, 1.01 * R}, {0, 0, -15}), BruteForce<3>{},
                 dem::Contacts{very_soft, dem::MeshWall<double>{square}}, Leapfrog{}};
  try {
    for (int k = 0; k < 1000; ++k) sim.step(1e-5);
    ADD_FAILURE() << "z = " << sim.particles()[position][0][2];
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("grain 0 and wall 0 overlap by"), std::string::npos) << text;
    EXPECT_NE(text.find("max_overlap = 0.5 of the radius 0.01 m"), std::string::npos) << text;
  }
  EXPECT_GT(sim.particles()[position][0][2], R / 2 - 15 * 1e-5);
}

TEST(Watch, RefusesGrainsThatOverlapByMoreThanHalfTheSmallerRadius) {
  for (const double overlap : {0.49, 0.51}) {
    dem::Grains<3> grains;
    dem::add_grain(grains, {0, 0, 0}, {.radius = 3 * R, .density = 2500});
    dem::add_grain(grains, {(4 - overlap) * R, 0, 0}, pebble);
    Simulation sim{grains, BruteForce<3>{}, dem::Contacts{soft}, Leapfrog{}};
    if (overlap < 0.5) {
      sim.step(1e-6);
      EXPECT_EQ(sim.interaction().size(), 1u);
    } else {
      expect_refused(sim, 1e-6, "grains 0 and 1 overlap by 0.0051 m", 0);
    }
  }
}

TEST(Watch, RefusesAGrainDeepInAWallByTheNumberOfTheWall) {
  const dem::BoxWall<3> tray{.box = {.lower = {-1, -1, 0}, .upper = {1, 1, infinity}}};
  const dem::Cylinder<> post{
      .from = {0.5, 0, 0}, .to = {0.5, 0, 1}, .radius = 0.1, .grains = dem::Side::outside};
  Simulation sim{one_grain<3>({0.6 + 0.4 * R, 0, 0.5}, {0, 0, 0}), BruteForce<3>{},
                 dem::Contacts{soft, tray, post}, Leapfrog{}};
  expect_refused(sim, 1e-6, "grain 0 and wall 1 overlap by 0.006 m", 0);
}

TEST(Watch, RefusesAGrainBehindAPlane) {
  Simulation sim{one_grain<3>({0, 0, -3 * R}, {0, 0, 0}), BruteForce<3>{},
                 dem::Contacts{soft, dem::Plane<3>{}}, Leapfrog{}};
  expect_refused(sim, 1e-6, "grain 0 and wall 0 overlap by 0.04 m", 0);
}

TEST(Watch, RefusesTwoWallsThatCloseOnAGrain) {
  const dem::Moving lid{dem::Plane<3>{.point = {0, 0, 2 * R}, .normal = {0, 0, -1}},
                        dem::Translation<3>{{0, 0, -1}}};
  Simulation sim{one_grain<3>({0, 0, R}, {0, 0, 0}), BruteForce<3>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e4}, dem::Plane<3>{}, lid},
                 Leapfrog{}};
  try {
    for (int k = 0; k < 2000; ++k) sim.step(1e-5);
    ADD_FAILURE() << "walls have passed each other";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("overlap by"), std::string::npos) << error.what();
  }
  EXPECT_LT(sim.time(), 1.1 * R);  // the walls are 0.9 R apart
}

TEST(Watch, RefusesAWallThatMovesByMoreThanHalfARadius) {
  const dem::Moving wall{dem::Plane<3>{.point = {0, 0, -1}}, dem::Translation<3>{{0, 0, 1}}};
  Simulation sim{one_grain<3>({0, 0, 0}, {0, 0, 0}), BruteForce<3>{}, dem::Contacts{soft, wall},
                 Leapfrog{}};
  sim.step(0.4 * R);
  EXPECT_TRUE(refuses([&] { sim.step(0.6 * R); }, {"a wall moved 0.006 m in a step"}));
}

TEST(Watch, RefusesAStepThatDoesNotResolveAVibration) {
  const dem::Moving floor{dem::Plane<3>{},
                          dem::Vibration<3>{.amplitude = {0, 0, 1e-6}, .frequency = 1e4}};
  Simulation sim{one_grain<3>({0, 0, 2 * R}, {0, 0, 0}), BruteForce<3>{},
                 dem::Contacts{soft, floor}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(1.1e-5); },
                      {"time_step = 1.1e-05 s is longer than 1/10 of the period"}));
  sim.step(1e-5);
  sim.step();
  EXPECT_NEAR(sim.last_time_step(), 1e-4 / 20, 1e-12);
}

TEST(Watch, RefusesFloatPositionsWithTooFewDigits) {
  const auto at = [](float x) {
    dem::Grains<2, float> grains;
    dem::add_grain(grains, {x, 0}, {.radius = 1e-3, .density = 2500});
    return Simulation{grains, BruteForce<2, float>{},
                      dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e3}}, Leapfrog{}};
  };
  auto near = at(80);
  near.step(1e-6);
  auto far = at(90);
  expect_refused(far, 1e-6, "m is known to 1.07288e-05 m only", 0);
}

TEST(Watch, HasNoLimitsIfTheyAreInfinite) {
  auto contacts = dem::Contacts{soft, dem::Plane<3>{}}.with(
      {.max_overlap = infinity, .max_displacement = infinity});
  auto grains = two_grains<3>(-1.5 * R, {0, 0, 0});
  dem::add_grain(grains, {1, 0, -5 * R}, pebble);
  dem::add_grain(grains, {0, 1, 1}, pebble);
  grains[velocity][3] = {1e6, 0, 0};
  Simulation sim{grains, BruteForce<3>{}, contacts, Leapfrog{}};
  sim.step(1e-6);
  EXPECT_EQ(sim.interaction().size(), 4u);
}

TEST(Watch, RefusesLimitsThatAreNotPositive) {
  const dem::Contacts contacts{soft};
  EXPECT_TRUE(
      refuses([&] { contacts.with({.max_overlap = 0}); }, {"max_overlap = 0 must be positive"}));
  EXPECT_TRUE(
      refuses([&] { contacts.with({.max_displacement = -1}); }, {"max_displacement = -1 must be"}));
  EXPECT_TRUE(refuses([&] { contacts.with({.max_overlap = std::nan("")}); }, {"must be positive"}));
}

TEST(Watch, ChecksTheStepsOfAnyIntegrator) {
  Simulation sim{one_grain<3>({0, 0, 0}, {51, 0, 0}), BruteForce<3>{}, dem::Contacts{soft},
                 Euler{}};
  expect_refused(sim, 1e-4, "by 0.0051 m in a step", 0);
}

// An interaction of the user with a check of its own.
struct ColdOnly {
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P&, S&, double) const {}
  template <class P>
  void check_step(const P& particles, const FinishedStep& step) const {
    const Index hot = find_too_far_moved(particles, step, 0.1, [](Index) { return 0.1; });
    if (hot != no_index) fail("too hot", {.particle = hot, .id = particles.id(hot)});
  }
};

TEST(Watch, CallsTheCheckOfAnInteraction) {
  Simulation sim{one_grain<3>({0, 0, 0}, {1, 0, 0}), BruteForce<3>{},
                 Forces{Gravity<3>{{0, 0, -9.81}}, ColdOnly{}}, Leapfrog{}};
  sim.step(0.09);
  expect_refused(sim, 0.11, "too hot", 0);
}

// Neither the velocity before the step nor the force alone takes a particle so far.
TEST(Watch, RefusesAParticleOfAFlowThatMovesByMoreThanASpacing) {
  for (const double share : {0.4, 0.6}) {
    auto water = blob<2, double>(6, 1);
    for (auto& u : water[velocity]) u = {share, 0};
    const mps::Flow<mps::Case10> flow({.spacing = 1, .gravity = {share, 0}});
    Simulation sim{water, UniformGrid<2>{}, flow, SemiImplicit{}};
    if (share < 0.5) {
      sim.step(1);
    } else {
      expect_refused(sim, 1, "moved a particle by 1.2 m in a step, more than the spacing 1 m", 0);
    }
  }
}

}  // namespace
}  // namespace silt::test::watch_test
