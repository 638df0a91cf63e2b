// SPDX-License-Identifier: MIT
// The recommended schemes at twice the spacing of docs/theory_mps.md, and, in slow tests, at that
// spacing.
// Only with --all: a comparison of whole flows.
#include "support/dam_break.hpp"
#include "support/still_tank.hpp"

#include <gtest/gtest.h>

#include <string>

namespace silt::test::recommended_test {
namespace {

TEST(RecommendedDamBreak, AgreesWithPotentialFlow) {
  const DamBreak record = run_dam_break<mps::Recommended>(0.02, 0.5);
  EXPECT_FALSE(record.broke);
  EXPECT_EQ(record.lost, 0u);
  const Deviations deviations = from_potential_flow(record);
  EXPECT_LT(deviations.edge, 0.03);
  EXPECT_LT(deviations.height, 0.03);
  EXPECT_LT(energy_growth(record), 0.025);
}

TEST(RecommendedDamBreak, AgreesWithPotentialFlowAndExperimentAtHighResolutionSlow) {
  const DamBreak record = run_dam_break<mps::Recommended>(0.01, 1.0);
  EXPECT_FALSE(record.broke);
  EXPECT_EQ(record.lost, 0u);
  const Deviations deviations = from_potential_flow(record);
  EXPECT_LT(deviations.edge, 0.01);
  EXPECT_LT(deviations.height, 0.015);
  EXPECT_LT(front_deviation(record), 0.03);  // that of the potential flow itself is 0.023
  EXPECT_LT(energy_growth(record), 0.005);
}

// Columns as high as wide, and half as high.
void expect_fronts_of_potential_flow(double l0, double allowed_edge, double allowed_height) {
  struct Case {
    Column column;
    std::string table;
    double until;
  };
  for (const Case& low : {Case{{0.4, 0.4, 2}, "_1", 0.51}, Case{{0.6, 0.3, 3}, "_0.5", 0.64}}) {
    const auto record = run_dam_break<mps::Recommended>(l0, low.until, low.column);
    const Deviations deviations = from_potential_flow(record, low.table, low.column);
    EXPECT_LT(deviations.edge, allowed_edge) << low.table;
    EXPECT_LT(deviations.height, allowed_height) << low.table;
  }
}
TEST(LowDamBreak, AgreesWithPotentialFlow) { expect_fronts_of_potential_flow(0.02, 0.07, 0.09); }
TEST(LowDamBreak, AgreesWithPotentialFlowAtHighResolutionSlow) {
  expect_fronts_of_potential_flow(0.01, 0.03, 0.05);
  expect_fronts_of_potential_flow(0.005, 0.015, 0.025);
}

TEST(StillTankOfWallParticles, HasTheHydrostaticPressure) {
  const mps::Tank<2> tank{
      .column = {0.4, 0.4}, .size = {.length = 0.4, .height = 0.6}, .spacing = 0.02};
  const auto floor = floor_pressure<mps::RecommendedForWallParticles>(tank, 0.3, 0.6);
  EXPECT_NEAR(floor.mean / 3924, 1, 0.001);
  EXPECT_LT(floor.scatter, 0.001);
}

TEST(StillTankOfWallParticles, HasTheHydrostaticPressureIn3D) {
  const double l0 = 0.05;
  const mps::Tank<3> tank{.column = {8 * l0, 8 * l0},
                          .size = {.length = 8 * l0, .height = 12 * l0, .depth = 8 * l0},
                          .spacing = l0};
  const auto floor = floor_pressure<mps::RecommendedForWallParticles>(tank, 0.15, 0.3);
  EXPECT_NEAR(floor.mean / (1000 * 9.81 * 8 * l0), 1, 0.005);
  EXPECT_LT(floor.scatter, 0.01);
}

}  // namespace
}  // namespace silt::test::recommended_test
