// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>
#include <silt/dem/setup/packing.hpp>
#include <silt/dem/setup/settling.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace silt::test::packing_test {
namespace {

const dem::Blend<dem::UniformSizes> blend{.sizes = {.min_radius = 0.02, .max_radius = 0.1},
                                          .density = 2500};

// Smallest gap between two grains, including periodic images, over all pairs.
template <class P>
double smallest_gap(const P& grains) {
  double gap = 1e9;
  for (const auto& [i, j, r] : brute_force_pairs(grains, typename P::Real(0.25))) {
    double square = 0;
    for (const auto part : r) square += double(part) * double(part);
    gap = std::min(gap, std::sqrt(square) - double(grains[radius][i] + grains[radius][j]));
  }
  return gap;
}

template <class P>
double solid_volume(const P& grains) {
  double sum = 0;
  for (const double R : grains[radius]) sum += dem::volume_of<P::dimension>(R);
  return sum;
}

template <int Dim>
void expect_packing(bool periodic) {
  auto box = cube<Dim, double>(0, Dim == 2 ? 3 : 1.5);
  box.periodic[0] = periodic;
  dem::Grains<Dim> grains(box);
  const double share = Dim == 2 ? 0.55 : 0.3;
  dem::scatter(grains, blend, box, {.solid_fraction = share, .seed = 3});
  EXPECT_GT(grains.size(), 100u);
  EXPECT_GE(smallest_gap(grains), 0);
  EXPECT_LT(smallest_gap(grains), 0.01) << "the packing is dense";
  const double filled = solid_volume(grains) / box.volume();
  EXPECT_GE(filled, share);
  EXPECT_LT(filled, share + 0.01);
  int astride = 0;
  for (Index i = 0; i < grains.size(); ++i) {
    const auto& x = grains[position][i];
    EXPECT_GE(box.clearance(x), grains[radius][i]);
    astride += x[0] < grains[radius][i];
  }
  EXPECT_EQ(astride > 0, periodic);

  auto again = dem::Grains<Dim>(box);
  dem::scatter(again, blend, box, {.solid_fraction = share, .seed = 3});
  EXPECT_EQ(state_of(again), state_of(grains));
}

TEST(Packing, FillsAFractionOfTheRegionWithoutOverlap) {
  expect_packing<2>(false);
  expect_packing<2>(true);
  expect_packing<3>(false);
  expect_packing<3>(true);
}

TEST(Packing, AvoidsExistingGrains) {
  dem::Grains<3> grains;
  dem::add_grain(grains, {0, 0, 0.3}, {.radius = 0.2, .density = 1});
  const dem::VerticalCylinder<> pillar{.radius = 0.5, .height = 1};
  dem::scatter(grains, blend, pillar, {.number = 100});
  EXPECT_EQ(grains.size(), 101u);
  EXPECT_GE(smallest_gap(grains), 0);
  for (Index i = 1; i < grains.size(); ++i) {
    EXPECT_GE(pillar.clearance(grains[position][i]), grains[radius][i]);
  }
}

TEST(Packing, KeepsClearOfWalls) {
  const dem::Blend<dem::UniformSizes> pebbles{.sizes = {.min_radius = 0.01, .max_radius = 0.02},
                                              .density = 2500};
  const Box<3> box{.lower = {0, 0, 0}, .upper = {0.5, 0.5, 0.5}};
  const dem::Plane<3> slope{.point = {0.25, 0, 0.25}, .normal = Vec<3>(-1, 0, 1).normalized()};
  dem::Grains<3> grains;
  dem::scatter(grains, pebbles, box, {.number = 200},
               dem::WallSet{slope, dem::Plane<3>{.point = {0, 0, 0.1}}});
  ASSERT_EQ(grains.size(), 200u);
  for (Index i = 0; i < grains.size(); ++i) {
    const Vec<3> x = grains[position][i];
    const double R = grains[radius][i];
    EXPECT_GE(slope.normal.dot(x - slope.point), R);
    EXPECT_GE(x[2] - 0.1, R);
  }
}

TEST(Packing, ThrowsIfThereIsNoSpaceAndReportsTheNumberPlaced) {
  dem::Grains<2> grains;
  const auto box = cube<2, double>(0, 1);
  const dem::Blend<dem::EqualSizes> discs{.sizes = {.value = 0.05}, .density = 1};
  EXPECT_TRUE(refuses([&] { dem::scatter(grains, discs, box, {.number = 100}); },
                      {"dem::scatter: placed ", " of 100 grains", "radius 0.05"}));
  EXPECT_TRUE(grains.empty());
  EXPECT_TRUE(refuses([&] { dem::scatter(grains, discs, box, {}); }, {"either number or"}));
  EXPECT_TRUE(refuses([&] { dem::scatter(grains, discs, box, {.solid_fraction = 1.2}); },
                      {"solid_fraction = 1.2"}));
  EXPECT_TRUE(refuses([&] { dem::scatter(grains, discs, Box<2>{}, {.number = 1}); },
                      {"lower corner of the region = -inf"}));
  EXPECT_TRUE(refuses([&] { dem::scatter(grains, discs, Box<2>{}, {.solid_fraction = 0.1}); },
                      {"volume of the region = inf"}));
}

// Random sequential addition of discs saturates at 0.547; below, some try succeeds.
TEST(Packing, ComesCloseToTheSaturationOfRandomAddition) {
  dem::Grains<2> grains;
  const dem::Blend<dem::EqualSizes> discs{.sizes = {.value = 0.01}, .density = 1};
  auto box = cube<2, double>(0, 1);
  box.periodic = {true, true};
  grains.set_box(box);
  dem::scatter(grains, discs, box, {.solid_fraction = 0.52, .tries = 20000});
  EXPECT_NEAR(solid_volume(grains), 0.52, 1e-3);
}

TEST(Packing, SettlesToABedInEquilibrium) {
  const dem::Blend<dem::UniformSizes> pebbles{.sizes = {.min_radius = 0.008, .max_radius = 0.012},
                                              .density = 2500};
  dem::Grains<2> grains;
  const Box<2> box{.lower = {0, 0}, .upper = {0.2, 0.3}};
  dem::scatter(grains, pebbles, box, {.number = 80});
  double weight = 0;
  for (const double m : grains[mass]) weight += 9.81 * m;
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.3,
                               .friction_angle = 0.4};
  Simulation bed{grains, NeighbourList<2>{},
                 Forces{Gravity<2>{{0, -9.81}},
                        dem::Contacts{law, dem::Plane<2>{}, dem::Plane<2>{.normal = {1, 0}},
                                      dem::Plane<2>{.point = {0.2, 0}, .normal = {-1, 0}}}},
                 Leapfrog{GlobalDamping{.alpha = 2}}};
  const dem::Settling rest{.speed = 1e-4, .check_every = 0.1, .max_time = 5};
  const double took = dem::settle(bed, rest);
  EXPECT_LT(took, 5);
  EXPECT_LT(dem::rms_speed(bed.particles()), 1e-4);
  double floor = 0;
  const auto state = bed.state();
  state.interaction.part<1>().for_each_contact(state.particles,
                                               [&](Index, Index j, const auto&, const Vec<2>& f) {
                                                 if (j == no_index) floor += f[1];
                                               });
  EXPECT_NEAR(floor / weight, 1, 0.01);

  EXPECT_TRUE(
      refuses([&] { dem::settle(bed, {.speed = 1e-30, .check_every = 0.01, .max_time = 0.02}); },
              {"dem::settle: after 0.02 s", "speed = 1e-30"}));
}

TEST(Settling, ThrowsIfNoStepIsMadeBetweenTwoChecks) {
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, {.radius = 0.1, .density = 1});
  grains[velocity][0] = {0.5, 0};
  Simulation sim{grains, NeighbourList<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
  sim.step(1);
  const dem::Settling rest{.speed = 0.1, .check_every = 1e-20, .max_time = 1, .time_step = 1e-3};
  EXPECT_TRUE(refuses([&] { dem::settle(sim, rest); },
                      {"Settling: check_every = 1e-20", "t = 1 s", "increase it"}));
}

TEST(Settling, ThatWouldNeverEndIsRefusedBeforeTheFirstStep) {
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, {.radius = 0.1, .density = 1});
  grains[velocity][0] = {0.5, 0};
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.3,
                               .friction_angle = 0.4};
  Simulation sim{grains, NeighbourList<2>{}, dem::Contacts{law}, Leapfrog{}};
  const Bytes before = state_of(sim.particles());
  struct Stop {  // so that the test would end
    bool stop_requested() const { return true; }
  } stop;
  dem::Settling endless{.speed = 1e-300, .check_every = 1e-3, .max_time = 1e300};
  for (const auto& time_step : {std::optional<double>{}, std::optional(1e-4)}) {
    endless.time_step = time_step;
    EXPECT_TRUE(refuses([&] { dem::settle(sim, endless, stop); },
                        {"Settling: time_step", "steps are ahead", "lower max_time"}));
    EXPECT_EQ(state_of(sim.particles()), before);
    EXPECT_EQ(sim.steps(), 0u);
  }
}

// Also if it is no multiple of check_every.
TEST(Settling, EndsAtItsLongestTime) {
  Simulation sim{one_grain<2>({0, 0}, {0.5, 0}), UniformGrid<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
  const dem::Settling rest{.speed = 0.1, .check_every = 0.4, .max_time = 1, .time_step = 1e-3};
  EXPECT_TRUE(refuses([&] { dem::settle(sim, rest); }, {"after 1 s the rms speed is still 0.5"}));
  EXPECT_NEAR(sim.time(), 1, 1e-9);
}

TEST(Settling, NeedsASpeedBelowTheLimit) {
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, {.radius = 0.1, .density = 1});
  grains[velocity][0] = {0.5, 0};
  Simulation sim{grains, NeighbourList<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
  const dem::Settling rest{.speed = 0.5, .check_every = 0.01, .max_time = 0.02, .time_step = 1e-3};
  ASSERT_EQ(dem::rms_speed(sim.particles()), 0.5);
  EXPECT_TRUE(refuses([&] { dem::settle(sim, rest); }, {"the rms speed is still 0.5 m/s"}));
  dem::Settling higher = rest;
  higher.speed = std::nextafter(0.5, 1);
  EXPECT_NEAR(dem::settle(sim, higher), 0.01, 1e-12) << "at the first check";
}

// Radii of a distribution that returns wrong ones from the second on.
struct WrongSizes {
  double wrong = 0;
  void check() const {}
  double radius(Random& random) const { return random.id == 0 ? 0.05 : wrong; }
  double largest() const { return 0.1; }
};

TEST(Packing, NamesTheDistributionThatReturnsAWrongRadius) {
  const auto unit = cube<2, double>(0, 1);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {-1.0, 0.0, infinity, std::numeric_limits<double>::quiet_NaN()}) {
    const dem::Blend<WrongSizes> odd{.sizes = {.wrong = wrong}, .density = 2500};
    const std::vector<std::string> texts{"Blend: ", "radius(random) of the distribution",
                                         to_text(wrong)};
    dem::Grains<2> grains;
    for (const dem::Scatter& how :
         {dem::Scatter{.number = 10}, dem::Scatter{.solid_fraction = 0.1}}) {
      EXPECT_TRUE(refuses([&] { dem::scatter(grains, odd, unit, how); }, texts));
    }
    EXPECT_TRUE(grains.empty());
  }
}

// In single precision the masses of the smaller ones underflow.
TEST(Packing, AddsNoGrainIfOneOfThemIsRefused) {
  const dem::Blend<WrongSizes> odd{.sizes = {.wrong = 1e-15}, .density = 2500};
  dem::Grains<3, float> grains;
  EXPECT_TRUE(refuses([&] { dem::scatter(grains, odd, cube<3, float>(0, 1), {.number = 3}); },
                      {"Grain: radius = 1e-15 m"}));
  EXPECT_TRUE(grains.empty());
}

// A region with a clearance as given.
struct OddRegion : Box<2> {
  double known = 0;
  double clearance(const Vec<2>&) const { return known; }
};

TEST(Packing, NamesTheRegionWhoseClearanceIsNotANumber) {
  dem::Grains<2> grains;
  const dem::Blend<dem::EqualSizes> discs{.sizes = {.value = 0.05}, .density = 1};
  const auto scatter_in = [&](double clearance) {
    dem::scatter(grains, discs, OddRegion{cube<2, double>(0, 1), clearance}, {.number = 1});
  };
  EXPECT_TRUE(refuses([&] { scatter_in(std::numeric_limits<double>::quiet_NaN()); },
                      {"clearance(x) of the region", "nan", "x = (", "; correct it"}));
  EXPECT_TRUE(grains.empty());
  EXPECT_TRUE(refuses([&] { scatter_in(-std::numeric_limits<double>::infinity()); },
                      {"found no free position"}));
  scatter_in(std::numeric_limits<double>::infinity());
  EXPECT_EQ(grains.size(), 1u);
}

TEST(Packing, PlacesNoGrainBeyondASideOfTheBox) {
  const dem::Blend<dem::EqualSizes> discs{.sizes = {.value = 0.05}, .density = 1};
  for (const OnEscape on_escape : {OnEscape::refuse, OnEscape::remove}) {
    auto box = cube<2, double>(0, 1);
    box.periodic = {true, false};
    box.on_escape = on_escape;
    dem::Grains<2> grains(box);
    const Box<2> above{.lower = {0, 1.5}, .upper = {1, 2}};
    EXPECT_TRUE(refuses([&] { dem::scatter(grains, discs, above, {.number = 5}); },
                        {"x = (", "beyond the side of the box at 1 m along axis 1"}));
    const Box<2> below{.lower = {0, -0.5}, .upper = {1, 0.2}};
    EXPECT_TRUE(refuses([&] { dem::scatter(grains, discs, below, {.number = 20}); },
                        {"x = (", "beyond the side of the box at 0 m along axis 1"}));
    EXPECT_TRUE(grains.empty());
    const Box<2> across{.lower = {0.5, 0}, .upper = {1.5, 1}};
    dem::scatter(grains, discs, across, {.number = 20});
    EXPECT_EQ(grains.size(), 20u) << "positions beyond a periodic side are wrapped";
  }
}

TEST(Packing, ThrowsForExistingGrainsThatAreInvalid) {
  const auto place_beside = [](auto field, auto value) {
    auto grains = one_grain<2>({0.5, 0.5}, {0, 0});
    grains[field][0] = value;
    const Box<2> region{.lower = {0, 0}, .upper = {1, 1}};
    const dem::Blend<dem::EqualSizes> equal{.sizes = {0.01}, .density = 2500};
    dem::scatter(grains, equal, region, {.number = 1});
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([&] { place_beside(position, Vec<2>(nan, 0)); },
                      {"dem: position of an existing grain"}));
  EXPECT_TRUE(refuses([&] { place_beside(radius, 0.0); },
                      {"dem: radius of an existing grain = 0"}));
}

}  // namespace
}  // namespace silt::test::packing_test
