// SPDX-License-Identifier: MIT
// The default time step follows from the pairs of materials that can meet, and from no others.
// Only with --all: many pairs of materials; stability_test.cpp has the limit of every law.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace silt::test::default_time_step_test {
namespace {

using Glass = dem::Law<dem::Hertz, dem::Mindlin>;

Glass elastic(double young_modulus) {
  const dem::Elastic material{.young_modulus = young_modulus, .poisson_ratio = 0.25};
  return {dem::Hertz{.elastic = material}, dem::Mindlin{.elastic = material}};
}

template <class Contacts>
double default_of(const Contacts& contacts, Index material = 0, double radius = 0.01) {
  auto grains =
      one_grain<3>({0, 0, 1}, {0, 0, 0}, {.radius = radius, .density = 2500, .material = material});
  return Simulation{grains, UniformGrid<3>{}, contacts, Leapfrog{}}.time_step();
}

TEST(DefaultTimeStep, IsHardlyShorterWithARigidWall) {
  const dem::Plane<3> rigid{.material = 1};
  const double alone = default_of(dem::Contacts{elastic(7e10)});
  const dem::Materials materials{elastic(7e10), elastic(1e30)};
  const double at_wall = default_of(dem::Contacts{materials, rigid});
  // Twice the modulus, twice the mass and twice the radius of two grains: 2^(−1/4).
  EXPECT_NEAR(at_wall / alone, std::pow(2, -0.25), 1e-6);
  EXPECT_EQ(default_of(dem::Contacts{materials, dem::Moving{rigid, dem::Translation<3>{}}}),
            at_wall);
}

TEST(DefaultTimeStep, IgnoresMaterialsThatNothingHas) {
  const dem::Materials materials{elastic(7e10), elastic(1e30), elastic(1e9)};
  EXPECT_EQ(default_of(dem::Contacts{materials}), default_of(dem::Contacts{elastic(7e10)}));
  EXPECT_EQ(default_of(dem::Contacts{materials, dem::Plane<3>{.material = 2}}, 2),
            default_of(dem::Contacts{elastic(1e9), dem::Plane<3>{}}));
}

TEST(DefaultTimeStep, FollowsMaterialsThatAreChangedLater) {
  const dem::Materials materials{elastic(7e10), elastic(1e9)};
  Simulation sim{two_grains<3>(0.1, Vec<3>(0, 0, 0)), UniformGrid<3>{}, dem::Contacts{materials},
                 Leapfrog{}};
  const double before = sim.time_step();
  for (Index i = 0; i < 2; ++i) sim.particles()[dem::material][i] = 1;
  EXPECT_EQ(sim.time_step(), default_of(dem::Contacts{elastic(1e9)}));
  EXPECT_GT(sim.time_step(), 5 * before);
}

// A law whose mix() takes the stiffer of both springs, not both in series.
struct StifferOfBoth {
  double k_n = 0;  // [N/m]
  template <class C>
  typename C::Vec force(const C& contact) const {
    return typename C::Real(k_n) * contact.overlap * contact.normal;
  }
  template <class C>
  dem::Stiffness stiffness(const C&) const {
    return {.normal = k_n};
  }
  static StifferOfBoth mix(const StifferOfBoth& a, const StifferOfBoth& b) {
    return {std::max(a.k_n, b.k_n)};
  }
};

TEST(DefaultTimeStep, ThrowsIfAWallMakesItAThousandTimesShorter) {
  const auto with_wall = [](double stiffness) {
    return default_of(dem::Contacts{dem::Materials{StifferOfBoth{1e6}, StifferOfBoth{stiffness}},
                                    dem::Plane<3>{}, dem::Plane<3>{.material = 1}});
  };
  EXPECT_GT(with_wall(1e11), 0);
  EXPECT_TRUE(
      refuses([&] { with_wall(1e30); }, {"time step", "wall 1 of material 1",
                                         "less than a thousandth", "pass a time step", "softer"}));
}

TEST(DefaultTimeStep, NamesTheContactThatWouldMakeARunEndless) {
  const dem::Materials materials{elastic(7e10), elastic(1e36)};
  auto grains = two_grains<3>(0.1, Vec<3>(0, 0, 0));
  grains[dem::material][0] = 1;
  grains[dem::material][1] = 1;
  Simulation sim{grains, UniformGrid<3>{},
                 Forces{Gravity<3>{{0, 0, -9.81}}, dem::Contacts{materials}}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.run({.until = 1}); },
                      {"time_step = ", "steps are ahead, more than 1e+12", "dem::Contacts",
                       "two grains of material 1", "softer"}));
}

// A law with any stiffness.
struct WithStiffness {
  dem::Stiffness springs;
  template <class C>
  typename C::Vec force(const C&) const {
    return C::Vec::Zero();
  }
  template <class C>
  dem::Stiffness stiffness(const C&) const {
    return springs;
  }
  static WithStiffness mix(const WithStiffness& a, const WithStiffness& b) {
    return a.springs.normal > 0 ? b : a;
  }
};

TEST(DefaultTimeStep, RefusesAStiffnessOfALawByTheNameOfItsMember) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const struct {
    const char* name;
    double dem::Stiffness::* member;
  } members[] = {{"normal", &dem::Stiffness::normal},
                 {"tangential", &dem::Stiffness::tangential},
                 {"beta", &dem::Stiffness::beta},
                 {"rolling", &dem::Stiffness::rolling},
                 {"rolling_dashpot", &dem::Stiffness::rolling_dashpot}};
  for (const auto& [name, member] : members) {
    for (const double wrong : {-1.0, infinity, -infinity, std::nan("")}) {
      dem::Stiffness springs{.normal = 1e5};
      springs.*member = wrong;
      const std::string text =
          std::string("dem::Contacts: stiffness(contact).") + name + " = " + to_text(wrong);
      EXPECT_TRUE(refuses([&] { default_of(dem::Contacts{WithStiffness{springs}}); },
                          {text, "two grains of material 0", "the law returned"}));

      // With a given time step, in a step with contacts.
      Simulation sim{two_grains<3>(-1e-4, Vec<3>(0, 0, 0)), UniformGrid<3>{},
                     dem::Contacts{WithStiffness{springs}}, Leapfrog{}};
      EXPECT_TRUE(refuses([&] { sim.step(1e-6); }, {text, "the law returned", "id 0"}));
      EXPECT_EQ(sim.steps(), 0u);
    }
  }
  const dem::Materials materials{WithStiffness{{.normal = 1e5}}, WithStiffness{{.normal = -2}}};
  EXPECT_TRUE(refuses(
      [&] { default_of(dem::Contacts{materials, dem::Plane<3>{.material = 1}}); },
      {"stiffness(contact).normal = -2 N/m", "a grain of material 0 with wall 0 of material 1"}));
}

}  // namespace
}  // namespace silt::test::default_time_step_test
