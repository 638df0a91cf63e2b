// SPDX-License-Identifier: MIT
// The dam break at twice the spacing of the slow test.
// Only with --all: a comparison of whole flows.
#include "support/dam_break.hpp"

#include <gtest/gtest.h>

namespace silt::test::dam_break_test {
namespace {

TEST(DamBreak, HasTheFrontOfMartinAndMoyce) {
  const double l0 = 0.02;
  const DamBreak improved = run_dam_break<mps::Case10>(l0, 0.55);
  EXPECT_FALSE(improved.broke);
  EXPECT_EQ(improved.lost, 0u);
  EXPECT_LT(front_deviation(improved), 0.06);
  EXPECT_LT(energy_growth(improved), 0.01);

  const DamBreak original = run_dam_break<mps::Case00>(l0, 0.55);
  EXPECT_LT(front_deviation(original), 0.06);
  for (const double T : {1.5, 2.0, 2.5, 3.0}) {
    const double t = T / scaled_time(1);
    EXPECT_GT(at_time(original.time, original.front, t), at_time(improved.time, improved.front, t))
        << "front of the original at T = " << T;
  }
  // Upper bound: Ritter's front on a dry bed, dZ/dT < 2.
  for (const DamBreak* record : {&improved, &original}) {
    for (double T = 1.0; T < 3.0; T += 0.5) {
      const double z0 = at_time(record->time, record->front, T / scaled_time(1));
      const double z1 = at_time(record->time, record->front, (T + 0.5) / scaled_time(1));
      EXPECT_LT((z1 - z0) / 0.5, 2);
    }
  }
}

}  // namespace
}  // namespace silt::test::dam_break_test
