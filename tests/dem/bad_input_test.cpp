// SPDX-License-Identifier: MIT
// Invalid parameters of DEM throw, and the message contains their name and value.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <string>

namespace silt::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

struct Wrong {
  std::string name;
  std::function<void(double)> use;
  std::vector<double> values;
};

const dem::CundallStrack good{.normal_stiffness = 1e6};

void use(const dem::CundallStrack& law) { dem::Contacts{law}; }
void use(const dem::Grain& grain) {
  dem::Grains<2> grains;
  const Bytes before = state_of(grains);
  try {
    dem::add_grain(grains, {0, 0}, grain);
  } catch (...) {
    EXPECT_EQ(state_of(grains), before) << "nothing was added";
    throw;
  }
}

TEST(BadInput, MessageHasNameAndValue) {
  const std::vector<double> not_positive{0, -1, nan, inf};
  const std::vector<double> negative{-1, nan, inf, -inf};
  const std::vector<Wrong> all{
      {"CundallStrack: normal_stiffness", [](double x) { use({.normal_stiffness = x}); },
       not_positive},
      {"CundallStrack: tangential_stiffness",
       [](double x) { use({.normal_stiffness = 1, .tangential_stiffness = x}); }, negative},
      {"CundallStrack: restitution",
       [](double x) { use({.normal_stiffness = 1, .restitution = x}); },
       {0, -0.5, 1.01, nan, inf}},
      {"CundallStrack: beta", [](double x) { use({.normal_stiffness = 1, .beta = x}); }, negative},
      {"CundallStrack: friction_angle",
       [](double x) {
         use({.normal_stiffness = 1, .tangential_stiffness = 1, .friction_angle = x});
       },
       {-0.1, std::numbers::pi / 2, 2, nan, inf}},
      {"CundallStrack: cohesion", [](double x) { use({.normal_stiffness = 1, .cohesion = x}); },
       negative},
      {"Grain: radius", [](double x) { use(dem::Grain{.radius = x, .density = 1}); }, not_positive},
      {"Grain: density", [](double x) { use(dem::Grain{.radius = 1, .density = x}); },
       not_positive},
      {"ContactSettings: steps_per_contact",
       [](double x) { dem::Contacts{good}.with({.steps_per_contact = x}); }, not_positive},
      {"Spring: mass",
       [](double x) { dem::sah_choi_critical_time_step({.mass = x, .stiffness = 1}); },
       not_positive},
      {"Spring: stiffness", [](double x) { dem::contact_duration({.mass = 1, .stiffness = x}); },
       not_positive},
      {"Plane: point",
       [](double x) { dem::Contacts(good, dem::Plane<2>{.point = {0, x}}); },
       {nan, inf}},
      {"Plane: normal",
       [](double x) { dem::Contacts(good, dem::Plane<2>{.normal = {0, x}}); },
       {nan, inf}},
      {"Segment: from",
       [](double x) { dem::Contacts(good, dem::Segment<>{.from = {x, 0}, .to = {1, 1}}); },
       {nan, inf}},
      {"Segment: to",
       [](double x) { dem::Contacts(good, dem::Segment<>{.from = {0, 0}, .to = {1, x}}); },
       {nan, inf}},
  };
  for (const auto& [name, use_it, values] : all) {
    for (const double value : values) {
      EXPECT_TRUE(refuses([&use = use_it, value] { use(value); }, {name + " = " + to_text(value)}))
          << name;
    }
  }
}

TEST(BadInput, WallsWithoutExtentThrow) {
  EXPECT_TRUE(refuses([] { dem::Contacts(good, dem::Plane<3>{.normal = {0, 0, 0}}); },
                      {"Plane: length of the normal = 0"}));
  EXPECT_TRUE(refuses([] { dem::Contacts(good, dem::Segment<>{.from = {1, 2}, .to = {1, 2}}); },
                      {"Segment: length = 0"}));
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

}  // namespace
}  // namespace silt::test
