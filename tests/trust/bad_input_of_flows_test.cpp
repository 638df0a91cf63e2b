// SPDX-License-Identifier: MIT
// Flows with their policies, tanks, solvers and measurements accept or refuse wrong and extreme
// values as these tables say.
#include <silt/measure/front.hpp>
#include <silt/search/brute_force.hpp>

#include "support/bad_input_table.hpp"
#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/view.hpp"
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace silt::test::bad_input_of_flows_test {
namespace {

constexpr double l0 = 0.02;  // [m]
using Scheme = mps::Recommended;
using Flow = mps::Flow<Scheme, 2>;
using Settings = mps::FlowSettings<2, Scheme>;
constexpr std::int64_t largest_int = std::numeric_limits<int>::max();

void use(const Settings& settings) {
  const Flow flow(settings);
  EXPECT_TRUE(is_finite(flow.energy_of(blob<2, double>(3, l0)).total()));
}

TEST(BadInput, OfFlowsIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"FlowSettings: spacing", [](double x) { use({.spacing = x}); }, accepts::nothing},
      {"FlowSettings: density", [](double x) { use({.spacing = l0, .density = x}); },
       accepts::nothing},
      {"FlowSettings: viscosity", [](double x) { use({.spacing = l0, .viscosity = x}); },
       accepts::not_negative},
      {"FlowSettings: gravity", [](double x) { use({.spacing = l0, .gravity = {x, 0}}); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"FlowSettings: radius", [](double x) { use({.spacing = l0, .radius = x}); },
       accepts::nothing},
      {"FlowSettings: laplacian_radius",
       [](double x) { use({.spacing = l0, .laplacian_radius = x}); }, accepts::nothing},
      {"FlowSettings: courant", [](double x) { use({.spacing = l0, .courant = x}); },
       accepts::tiny},
      {"FlowSettings: speed_scale", [](double x) { use({.spacing = l0, .speed_scale = x}); },
       accepts::not_negative},
      {"FlowSettings: max_growth", [](double x) { use({.spacing = l0, .max_growth = x}); },
       accepts::huge | accepts::infinite},
      {"FlowSettings: max_time_step", [](double x) { use({.spacing = l0, .max_time_step = x}); },
       accepts::positive | accepts::infinite}});
}

TEST(BadInput, OfPoliciesOfFlowsIsRefused) {
  constexpr unsigned up_to_one = accepts::zero | accepts::tiny;
  check_parameters(std::vector<NumberParameter>{
      {"DivergenceSource: gamma", [](double x) { mps::DivergenceSource{.gamma = x}.check(); },
       up_to_one},
      {"BalancedSource: gamma", [](double x) { mps::BalancedSource{.gamma = x}.check(); },
       up_to_one},
      {"HigherOrderSource: gamma", [](double x) { mps::HigherOrderSource{.gamma = x}.check(); },
       up_to_one},
      {"CorrectedGradient: min_determinant",
       [](double x) { mps::CorrectedGradient{.min_determinant = x}.check(); }, up_to_one},
      {"DensitySurface: beta", [](double x) { mps::DensitySurface{.beta = x}.check(); }, up_to_one},
      {"CountSurface: beta", [](double x) { mps::CountSurface{.beta = x}.check(); }, up_to_one},
      {"ConeSurface: half_angle", [](double x) { mps::ConeSurface{.half_angle = x}.check(); },
       accepts::nothing},
      {"ConeSurface: length", [](double x) { mps::ConeSurface{.length = x}.check(); },
       accepts::nothing},
      {"ConeSurface: spray", [](double x) { mps::ConeSurface{.spray = x}.check(); }, up_to_one},
      {"ConeSurface: inside", [](double x) { mps::ConeSurface{.spray = 0, .inside = x}.check(); },
       up_to_one},
      {"Collision: distance",
       [](double x) {
         mps::FlowSettings<2, mps::Case10> settings{.spacing = l0};
         settings.collision.distance = x;
         settings.check();
       },
       up_to_one},
      {"Collision: restitution", [](double x) { mps::Collision{.restitution = x}.check(); },
       up_to_one},
      {"KeepApart: distance", [](double x) { mps::KeepApart{.distance = x}.check(); }, up_to_one},
      {"KeepApart: restitution", [](double x) { mps::KeepApart{.restitution = x}.check(); },
       up_to_one},
      {"DynamicStabilisation: distance",
       [](double x) { mps::DynamicStabilisation{.distance = x}.check(); }, up_to_one},
      {"ParticleShifting: strength",
       [](double x) {
         const mps::ParticleShifting shifting{.strength = x};
         shifting.check();
         const auto moved = shifting.displacement(test::ViewOf{
             {.time_step = 1, .concentration_gradient = {1, 0}, .max_relative_speed = 1}});
         EXPECT_EQ(moved[0] != 0, x > 0);
       },
       up_to_one},
      {"lattice_values: radius", [](double x) { mps::lattice_values<2, mps::WendlandKernel>(x); },
       accepts::nothing}});
}

void use_tank(const mps::Tank<3>& tank) {
  EXPECT_GT(mps::make_tank(tank).size(), 0u);
  EXPECT_GT(mps::make_tank<Scheme>(tank).particles.size(), 0u);
}

mps::Tank<3> small_tank() {
  return {.column = {2 * l0, l0},
          .size = {.length = 3 * l0, .height = 2 * l0, .depth = 2 * l0},
          .spacing = l0,
          .dummy_layers = 1};
}

TEST(BadInput, OfTanksIsRefused) {
  const auto with = [](auto change) {
    return [change](double x) {
      auto tank = small_tank();
      change(tank, x);
      use_tank(tank);
    };
  };
  check_parameters(std::vector<NumberParameter>{
      {"Tank: spacing", with([](auto& tank, double x) { tank.spacing = x; }), accepts::nothing},
      {"Tank: length", with([](auto& tank, double x) { tank.size.length = x; }), accepts::nothing},
      {"Tank: height", with([](auto& tank, double x) { tank.size.height = x; }), accepts::nothing},
      {"Tank: depth", with([](auto& tank, double x) { tank.size.depth = x; }), accepts::nothing},
      {"Tank: column width", with([](auto& tank, double x) { tank.column[0] = x; }),
       accepts::nothing},
      {"Tank: column height", with([](auto& tank, double x) { tank.column[1] = x; }),
       accepts::nothing}});
  check_parameters(std::vector<IntegerParameter>{{"Tank: dummy_layers",
                                                  [](std::int64_t n) {
                                                    auto tank = small_tank();
                                                    tank.dummy_layers = static_cast<int>(n);
                                                    use_tank(tank);
                                                  },
                                                  accepts::zero, largest_int}});
}

TEST(BadInput, OfSolversIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"SolveSettings: tolerance", [](double x) { ConjugateGradient<>({.tolerance = x}); },
       accepts::tiny},
      {"CellMultigrid: cell_size", [](double x) { CellMultigrid<2>({.cell_size = x}); },
       accepts::nothing},
      {"CellMultigrid: min_diagonal", [](double x) { CellMultigrid<2>({.min_diagonal = x}); },
       accepts::zero | accepts::tiny}});
  check_parameters(std::vector<IntegerParameter>{
      {"SolveSettings: max_iterations",
       [](std::int64_t n) { ConjugateGradient<>({.max_iterations = static_cast<int>(n)}); },
       accepts::huge, largest_int},
      {"CellMultigrid: sweeps",
       [](std::int64_t n) { CellMultigrid<2>({.sweeps = static_cast<int>(n)}); }, accepts::nothing,
       largest_int},
      {"CellMultigrid: max_coarsest_cells",
       [](std::int64_t n) { CellMultigrid<2>({.max_coarsest_cells = static_cast<Index>(n)}); },
       accepts::nothing}});
}

// A step of a column of water, of which one particle may be different. A step that is refused
// changes nothing.
template <class Change>
void step_of_water(double dt, Change&& change) {
  auto [water, walls] = mps::make_tank<Scheme, 2>(
      {.column = {4 * l0, 4 * l0}, .size = {.length = 6 * l0, .height = 6 * l0}, .spacing = l0});
  change(water);
  Simulation sim{water, BruteForce<2>{}, Flow({.spacing = l0, .walls = walls}), SemiImplicit{}};
  change_or_keep([&] { return state_of(sim.particles()); }, [&] { sim.step(dt); });
  EXPECT_EQ(sim.steps(), 1u);
  EXPECT_TRUE(is_finite(sim.interaction().energy().total()));
}

TEST(BadInput, OfStepsOfFlowsIsRefused) {
  constexpr double dt = 1e-4;
  check_parameters(std::vector<NumberParameter>{
      {"time_step", [](double x) { step_of_water(x, [](auto&) {}); }, accepts::nothing},
      {"velocity",
       [](double x) { step_of_water(dt, [x](auto& water) { water[velocity][5] = {x, 0}; }); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"particle",  // 0 is on a wall
       [](double x) { step_of_water(dt, [x](auto& water) { water[position][5][0] = x; }); },
       accepts::nothing},
      {"pressure",
       [](double x) { step_of_water(dt, [x](auto& water) { water[mps::pressure][5] = x; }); },
       accepts::zero | accepts::minus_one | accepts::tiny}});
}

TEST(BadInput, OfBodyForcesIsRefused) {
  const auto step = [](const Vec<2>& force) {
    Settings settings{.spacing = l0, .walls = {.let_fluid_fall = true}};
    settings.body_force = [=](const Vec<2>& x, double) {
      return x[0] > l0 ? force : Vec<2>(Vec<2>::Zero());
    };
    Simulation sim{blob<2, double>(3, l0), BruteForce<2>{}, Flow(settings), SemiImplicit{}};
    change_or_keep([&] { return state_of(sim.particles()); }, [&] { sim.step(); });
    EXPECT_EQ(sim.steps(), 1u);
  };
  check_parameters(std::vector<NumberParameter>{
      {"FlowSettings: body_force", [&](double x) { step({0, x}); },
       accepts::zero | accepts::minus_one | accepts::tiny}});
}

TEST(BadInput, OfTheRuleForFrontsIsRefused) {
  auto water = blob<2, double>(4, l0);
  UniformGrid<2> search({.radius = 3 * l0});
  search.update(water);
  const auto use_rule = [&](const FrontRule& rule) {
    const Front front = find_front(water, search, rule, [](Index) { return true; });
    EXPECT_TRUE(is_finite(front.x));
    EXPECT_TRUE(is_finite(front.height));
  };
  check_parameters(std::vector<NumberParameter>{
      {"FrontRule: spacing", [&](double x) { use_rule({.spacing = x}); }, accepts::tiny},
      {"FrontRule: band", [&](double x) { use_rule({.spacing = l0, .band = x}); },
       accepts::not_negative},
      {"FrontRule: neighbour_radius",
       [&](double x) { use_rule({.spacing = l0, .neighbour_radius = x}); },
       accepts::zero | accepts::tiny}});
}

}  // namespace
}  // namespace silt::test::bad_input_of_flows_test
