// SPDX-License-Identifier: MIT
// Combinations of parameters of DEM that are invalid throw, and the message says why. The ranges of
// single parameters are tested in tests/trust/bad_input_of_*_test.cpp.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace silt::test::bad_input_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

const dem::CundallStrack good{.normal_stiffness = 1e6};

void use(const dem::CundallStrack& law) { dem::Contacts{law}; }
void use(const dem::Grain& grain) {
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, grain);
}

TEST(BadInput, WallsWithoutExtentThrow) {
  EXPECT_TRUE(refuses([] { dem::Contacts(good, dem::Plane<3>{.normal = {0, 0, 0}}); },
                      {"Plane: length of the normal = 0"}));
  EXPECT_TRUE(refuses([] { dem::Contacts(good, dem::Segment<>{.from = {1, 2}, .to = {1, 2}}); },
                      {"Segment: from", "distance 0 m"}));
}

TEST(BadInput, RestitutionTogetherWithBetaThrows) {
  EXPECT_TRUE(refuses([] { use({.normal_stiffness = 1, .restitution = 0.5, .beta = 0.1}); },
                      {"restitution = 0.5", "beta = 0.1", "one of them"}));
}

TEST(BadInput, AFrictionAngleWithoutTangentialStiffnessThrows) {
  for (const double cohesion : {0.0, 1.0}) {
    EXPECT_TRUE(
        refuses([&] { use({.normal_stiffness = 1, .friction_angle = 0.4, .cohesion = cohesion}); },
                {"CundallStrack: friction_angle = 0.4", "tangential_stiffness = 0", "no effect"}));
  }
  EXPECT_TRUE(refuses([] { use({.normal_stiffness = 1, .cohesion = 3}); },
                      {"CundallStrack: cohesion = 3", "tangential_stiffness = 0", "no effect"}));
}

TEST(BadInput, AnAngleInDegreesIsRecognised) {
  const auto friction = [](double angle) {
    dem::LinearFriction{.tangential_stiffness = 1, .friction_angle = angle}.check();
  };
  EXPECT_TRUE(refuses([&] { friction(30); }, {"LinearFriction: friction_angle = 30", "radians",
                                              "30 degrees are 0.523599", "coefficient", "atan"}));
  EXPECT_TRUE(refuses([&] { friction(120); }, {"friction_angle = 120", "radians"}));
  EXPECT_TRUE(refuses([&] { friction(std::numbers::pi / 2); }, {"friction_angle = 1.5708 rad"}));
  const auto rolling = [](double coefficient) {
    dem::RollingResistance{.rolling_friction = coefficient}.check();
  };
  const auto twisting = [](double coefficient) {
    dem::RollingResistance{.twisting_friction = coefficient}.check();
  };
  EXPECT_TRUE(refuses([&] { rolling(30); }, {"RollingResistance: rolling_friction = 30",
                                             "coefficient", "30 degrees it is 0.57735"}));
  EXPECT_TRUE(refuses([&] { twisting(2.1); },
                      {"RollingResistance: twisting_friction = 2.1", "not an angle"}));
  EXPECT_NO_THROW(rolling(2));
}

// A step, the default time step and a run name the value that is wrong and its grain.
template <class Field>
void expect_named(const std::string& name, Field field, const std::vector<double>& values) {
  for (const double value : values) {
    auto grains = two_grains<2>(0.1, Vec<2>(0, 0));
    grains.remove(0);
    dem::add_grain(grains, {0, 1}, pebble);
    grains[field][1] = value;
    const auto simulation = [&] {
      return Simulation{grains, UniformGrid<2>{}, dem::Contacts{good}, Leapfrog{}};
    };
    const std::vector<std::string> words{"dem::Contacts: " + name + " = " + to_text(value),
                                         "positive", "particle 1", "id 2"};
    EXPECT_TRUE(refuses([&] { simulation().step(1e-6); }, words));
    EXPECT_TRUE(refuses([&] { simulation().time_step(); }, words));
    EXPECT_TRUE(refuses([&] { simulation().run({.until = 1}); }, words));
  }
}

TEST(BadInput, TheWrongOneOfRadiusMassAndInertiaIsNamed) {
  expect_named("radius", radius, {0, -1, nan, inf, -inf});
  expect_named("mass", mass, {0, -1, nan, inf, -inf});
  expect_named("inertia", inertia, {0, -1, nan, inf, -inf});
}

TEST(BadInput, UnknownMaterialsThrow) {
  using Materials = dem::Materials<dem::CundallStrack>;
  EXPECT_TRUE(refuses([] { Materials{}; }, {"Materials"}));
  EXPECT_TRUE(refuses([] { (Materials{good, dem::CundallStrack{}}); }, {"normal_stiffness = 0"}));
  EXPECT_TRUE(refuses([] { dem::Contacts(good, dem::Plane<2>{.material = 1}); },
                      {"material 1", "of wall 0"}));
  auto grains = two_grains<2>(0.1, Vec<2>(0, 0));
  grains.remove(0);
  grains[dem::material][0] = 7;
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{good}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(1e-6); }, {"material 7", "particle 0", "id 1", "step 0"}));
  EXPECT_TRUE(refuses([&] { sim.time_step(); }, {"material 7", "particle 0", "id 1"}));
}

struct Spring {
  double stiffness = 1;
  template <class C>
  typename C::Vec force(const C& contact) const {
    return typename C::Real(stiffness) * contact.overlap * contact.normal;
  }
};

// Without a warning for a narrowing conversion.
TEST(BadInput, AMaterialIsAnIndexOf32Bits) {
  for (Index k = 0; k < 3; ++k) {
    dem::Grains<2> grains;
    dem::add_grain(grains, {0, 0}, {.radius = 1, .density = 1, .material = k % 2});
    EXPECT_EQ(grains[dem::material][0], k % 2);
  }
  dem::Grain grain{.radius = 1, .density = 1, .material = (Index(1) << 32) - 1};
  use(grain);
  ++grain.material;
  EXPECT_TRUE(refuses([&] { use(grain); }, {"Grain: material = 4294967296", "dem::Materials"}));
}

TEST(BadInput, TwoMaterialsOfALawWithoutMixThrow) {
  EXPECT_TRUE(refuses([] { (dem::Materials<Spring>{Spring{}, Spring{}}); }, {"mix(a, b)"}));
  EXPECT_NO_THROW((dem::Materials<Spring>{Spring{}}));
}

TEST(UserDefinedLaw, RunsWithoutHistoryOrStiffness) {
  Simulation sim{two_grains<2>(1e-4, Vec<2>(-1, 0)), UniformGrid<2>{}, dem::Contacts{Spring{1e6}},
                 Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(); }, {"chooses no time step"}));
  through_contact(sim, 1e-5);
  EXPECT_NEAR(sim.particles()[velocity][0][0], -1, 1e-3);
}

TEST(UserDefinedLaw, WhoseForceIsNotFiniteIsReportedByTheForce) {
  Simulation sim{two_grains<3>(-1e-4, Vec<3>(-1, 0, 0)), UniformGrid<3>{},
                 dem::Contacts{Spring{nan}}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(1e-5); }, {"after the step, force = (nan, nan, nan)"}));
}

}  // namespace
}  // namespace silt::test::bad_input_test
