// SPDX-License-Identifier: MIT
// The dam break of [HwangLeePark2010] at a spacing of 0.01 m: case 10 compared with the original
// MPS and with the front and height of Martin and Moyce (1952). Parameters that the paper does not
// give (radii, tank length, Δt) are the defaults of FlowSettings and those in
// support/dam_break.hpp.
#include "support/dam_break.hpp"

#include <gtest/gtest.h>

namespace silt::test::dam_break_slow_test {
namespace {

class DamBreakOfThePaper : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    improved_ = run_dam_break<mps::Case10>(0.01, 1.0);
    original_ = run_dam_break<mps::Case00>(0.01, 1.0);
  }
  static void TearDownTestSuite() {
    improved_ = {};
    original_ = {};
  }
  static inline DamBreak improved_;
  static inline DamBreak original_;
};

TEST_F(DamBreakOfThePaper, HasTheFrontOfMartinAndMoyce) {
  EXPECT_LT(front_deviation(improved_), 0.06);
  EXPECT_LT(front_deviation(original_), 0.06);
}

TEST_F(DamBreakOfThePaper, HasAFasterFrontInTheOriginalMethod) {
  for (const double T : {1.5, 2.0, 2.5, 3.0}) {
    const double t = T / scaled_time(1);
    EXPECT_GT(at_time(original_.time, original_.front, t),
              at_time(improved_.time, improved_.front, t))
        << T;
  }
}

TEST_F(DamBreakOfThePaper, HasTheHeightOfMartinAndMoyce) {
  const CsvTable measured =
      read_csv(SILT_TESTS_DIR "/reference/martin_moyce_1952_n2eq2_height_table6.csv");
  // τ = t √(g/a), without the n of T. The instant of release is uncertain by up to 0.2 in τ.
  for (Index row = 0; row < measured.rows(); ++row) {
    const double tau = measured["tau"][row];
    if (tau < 0.9 || tau > 3.1) continue;
    const double t = tau / std::sqrt(g / column_width);
    EXPECT_NEAR(at_time(improved_.time, improved_.height, t), measured["H"][row], 0.1) << tau;
  }
}

TEST_F(DamBreakOfThePaper, LosesNoParticleInTheImprovedMethod) {
  EXPECT_FALSE(improved_.broke);
  EXPECT_EQ(improved_.lost, 0u);
}

TEST_F(DamBreakOfThePaper, HasAThirdOfTheRoughnessInTheImprovedMethod) {
  ASSERT_FALSE(original_.broke);
  EXPECT_LT(3 * roughness(improved_, 0.4, 1.0), roughness(original_, 0.4, 1.0));
}

TEST_F(DamBreakOfThePaper, DoesNotGainEnergyInTheImprovedMethod) {
  EXPECT_LT(energy_growth(improved_), 0.01);
}

}  // namespace
}  // namespace silt::test::dam_break_slow_test
