// SPDX-License-Identifier: MIT
// Flows: the cases of fluid_cases, and runs like those of the other examples, stopped at random
// steps, with every search, in 2D and 3D, in double and single precision.
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>
#include <silt/mps/policy/higher_order_source.hpp>

#include "support/fluid_cases/all.hpp"
#include "support/random_restarts.hpp"
#include "support/warm_particles.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::random_restarts_of_flows_slow_test {
namespace {

struct Case {
  std::string name;
  std::function<void(const RandomRestarts&)> check;
};
void PrintTo(const Case& one, std::ostream* to) { *to << one.name; }

// A case of the example with its observer.
template <class Scheme>
std::function<void(const RandomRestarts&)> fluid_case(const std::string& name) {
  return [name](const RandomRestarts& restarts) {
    const auto flow = fluid_cases::make({.name = name, .spacing = 0.1});
    const auto make = [&] {
      return RunWith{fluid_cases::simulation_of<Scheme>(flow, {}), fluid_cases::Notes{flow}};
    };
    expect_the_same_end_after_restarts(restarts, make, ChosenStep{});
  };
}

// A column of water that collapses in a tank of this width, as in dam_break and quickstart_dam.
template <class Scheme, int Dim = 2, class Real = double, class S>
void dam_in(double width, const S& search, const RandomRestarts& restarts) {
  constexpr double l0 = 0.02;
  const auto tank = mps::make_tank<Scheme, Dim, Real>(
      {.column = {width / 2, width / 2},
       .size = {.length = width, .height = width, .depth = 3 * l0},
       .spacing = l0,
       .on_escape = OnEscape::remove});
  const mps::Flow<Scheme, Dim, Real> water{
      {.spacing = l0, .speed_scale = 1, .walls = tank.walls}};
  const auto make = [&] {
    return RunWith{Simulation{tank.particles, search, water, SemiImplicit<>{}}};
  };
  expect_the_same_end_after_restarts(restarts, make, ChosenStep{});
}
template <class Scheme, class S>
void dam(const RandomRestarts& restarts) {
  dam_in<Scheme>(0.32, S{}, restarts);
}
void dam_in_single_precision(const RandomRestarts& restarts) {
  dam_in<mps::Recommended, 2, float>(0.32, UniformGrid<2, float>{}, restarts);
}
void dam_in_space(RandomRestarts restarts) {
  restarts.to_the_end = std::min<Index>(restarts.to_the_end, 2);
  restarts.further = 2;
  dam_in<mps::Recommended, 3>(0.12, NeighbourList<3>{{.skin_fraction = 0.02}}, restarts);
}

// Water that sloshes in a tank of which a body force shakes the water: as in hydrostatic, with a
// step of another length each time.
void sloshing(const RandomRestarts& restarts) {
  constexpr double l0 = 0.02;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.24, 0.12}, .size = {.length = 0.24, .height = 0.2}, .spacing = l0});
  const mps::Flow<mps::Recommended> water{
      {.spacing = l0,
       .viscosity = 1e-4,
       .speed_scale = 1,
       .walls = tank.walls,
       .body_force = [](const Vec<2>&, double t) { return Vec<2>(4 * std::sin(20 * t), 0); }}};
  for (const std::optional<double> skin : {std::optional<double>(), std::optional(0.03)}) {
    const auto make = [&] {
      return RunWith{Simulation{tank.particles, NeighbourList<2>{{.skin_fraction = skin}}, water,
                                SemiImplicit<>{}}};
    };
    expect_the_same_end_after_restarts(restarts, make, UnevenStep{});
  }
}

// A temperature that is conducted between two steps, as in own_field; with more particles than one
// thread processes at once.
void own_field(RandomRestarts restarts) {
  restarts.to_the_end = std::min<Index>(restarts.to_the_end, 3);
  constexpr double l0 = 0.02;
  auto tank = mps::make_tank<2, double, temperature_t>(
      {.column = {0.3, 0.6}, .size = {.length = 0.9, .height = 0.7}, .spacing = l0});
  for (Index i = 0; i < tank.size(); ++i) tank[temperature][i] = double(i % 5);
  const mps::Flow<mps::Case10> water{{.spacing = l0, .speed_scale = 2}};
  const auto make = [&] {
    return RunWith{Simulation{tank, UniformGrid<2>{}, water, SemiImplicit<>{}}};
  };
  const std::string end = expect_the_same_end_after_restarts(restarts, make, [](auto& simulation) {
    simulation.step();
    conduct_heat(simulation, 0.01);
  });
  EXPECT_GT(values_of<Id>(end, "particles/id").size(), 1024u);
}

// A channel with walls above and below and periodic ends, in which the water is pushed along. At
// one end, some of it freezes to the wall and melts again.
void channel(const RandomRestarts& restarts) {
  constexpr double l0 = 0.05;
  const Box<2> box{.lower = {0, -1}, .upper = {0.8, 2}, .periodic = {true, false}};
  mps::Fluid<2> fluid(box);
  std::vector<Id> ice;
  for (const auto& x : lattice<2>({{0, -0.2}, {0.8, 0.8}}, l0)) {
    const double depth = std::max(-x[1], x[1] - 0.6);
    const auto kind = depth < 0    ? mps::Kind::fluid
                      : depth < l0 ? mps::Kind::wall
                                   : mps::Kind::dummy;
    const Index i = mps::add_particle(fluid, x, kind);
    if (kind == mps::Kind::fluid) fluid[velocity][i] = {1 + 0.2 * std::sin(10 * x[1]), 0};
    if (0 < x[1] && x[1] < 2 * l0 && x[0] < 2 * l0) ice.push_back(fluid.id(i));
  }
  using Scheme = mps::RecommendedForWallParticles;
  const mps::Flow<Scheme> water{
      mps::without_free_surface(mps::FlowSettings<2, Scheme>{
          .spacing = l0, .viscosity = 1e-2, .gravity = {2, 0}, .speed_scale = 1})};
  const auto make = [&] {
    return RunWith{
        Simulation{fluid, NeighbourList<2>{{.skin_fraction = 0.25}}, water, SemiImplicit<>{}}};
  };
  expect_the_same_end_after_restarts(restarts, make, [&](auto& simulation) {
    simulation.step();
    if (simulation.steps() % 3 != 0) return;
    auto& particles = simulation.particles();
    for (const Id id : ice) {
      const Index i = particles.index_of(id);
      const bool freezes = simulation.steps() % 2 != 0;
      particles[mps::kind][i] = freezes ? mps::Kind::wall : mps::Kind::fluid;
      particles[velocity][i] = {0, 0};
    }
  });
}

struct ErrorCompensating : mps::Case10 {  // one of flow_policies
  mps::ErrorCompensatingSource source{};
};

const std::vector<Case> cases{
    {"taylor_green", fluid_case<mps::Recommended>("taylor_green")},
    {"standing_wave", fluid_case<mps::Recommended>("standing_wave")},
    {"oscillating_drop", fluid_case<mps::Recommended>("oscillating_drop")},
    {"rotating_square", fluid_case<mps::Recommended>("rotating_square")},
    {"falling_block", fluid_case<mps::Recommended>("falling_block")},
    {"rotating_square_case_10", fluid_case<mps::Case10>("rotating_square")},
    {"dam_break_list", dam<mps::Recommended, NeighbourList<2>>},
    {"dam_break_wall_particles", dam<mps::RecommendedForWallParticles, UniformGrid<2>>},
    {"dam_break_case_00", dam<mps::Case00, BruteForce<2>>},
    {"dam_break_in_single_precision", dam_in_single_precision},
    {"dam_break_in_space", dam_in_space},
    {"hydrostatic", sloshing},
    {"own_field", own_field},
    {"channel", channel},
    {"flow_policies", dam<ErrorCompensating, UniformGrid<2>>},
};

class RandomRestartsOfFlows : public testing::TestWithParam<Case> {};

TEST_P(RandomRestartsOfFlows, EndLikeAnUninterruptedRun) {
  GetParam().check({.steps = 220, .number = 200, .to_the_end = 40, .further = 3});
}
INSTANTIATE_TEST_SUITE_P(Cases, RandomRestartsOfFlows, testing::ValuesIn(cases),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace silt::test::random_restarts_of_flows_slow_test
