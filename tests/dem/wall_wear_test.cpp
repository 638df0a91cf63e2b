// SPDX-License-Identifier: MIT
// Work and wear of a clump that slides on a wall without rolling, against the exact way and force,
// and the lines between its contacts. No other test has the work of sliding on a wall over time.
#include <silt/dem/clump/clump_leapfrog.hpp>
#include <silt/dem/measure/wall_wear.hpp>
#include <silt/io/csv_series.hpp>
#include <silt/io/vtk_contacts.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

namespace silt::test::wall_wear_test {
namespace {

TEST(WallWear, IsThatOfASledge) {
  constexpr double R = 0.01, mu = 0.3, g = 9.81, k = 1e-13;
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.2,
                               .friction_angle = std::atan(mu)};
  dem::ClumpGrains<3> grains;
  dem::Clumps<3> clumps;
  const dem::ClumpShape<3> sledge(
      {{{0, 0, R}, R}, {{3 * R, 0, R}, R}, {{0, 3 * R, R}, R}, {{3 * R, 3 * R, R}, R}}, 2500);
  const double M = sledge.mass_properties().mass;
  clumps.add(grains, sledge, {.position = {0, 0, R - M * g / 4 / 1e5}, .velocity = {1, 0, 0}});
  Simulation sim{grains, UniformGrid<3>{},
                 Forces{dem::Contacts{law, dem::Plane<3>{}}, Gravity<3>{{0, 0, -g}}},
                 dem::ClumpLeapfrog{clumps}};
  const Folder folder;
  const auto path = folder.path / "wall.csv";
  {
    CsvSeries series(path, dem::WallWear<3>({.wall = 0, .coefficient = k}));
    sim.run({.until = 0.2, .time_step = 2e-5}, series);
    const auto& wear = std::get<0>(series.measures());
    EXPECT_NEAR(wear.force()[0] / (mu * M * g), 1, 0.02);
    EXPECT_NEAR(wear.force()[2] / (-M * g), 1, 0.02);
    // Deceleration µ g: it has lost ½ M (1 − v²), on the way ½ (1 − v²)/(µ g).
    const double v = 1 - mu * g * sim.time();
    const double lost = M * (1 - v * v) / 2;
    EXPECT_NEAR(wear.sliding_work() / lost, 1, 0.01);
    EXPECT_NEAR(wear.worn_volume() / (k * lost / mu), 1, 0.01);
    EXPECT_EQ(wear.columns().size(), 8u);
  }
  std::ifstream stream(path);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (const char* part : {"force_x [N]", "torque_z [N m]", "worn_volume [m3]", "load of wall 0"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  const std::string frame = vtk_frame_of_contacts(sim.particles(), sim.interaction());
  EXPECT_NE(frame.find("NumberOfPoints=\"8\" NumberOfCells=\"4\""), std::string::npos);
  EXPECT_NE(frame.find("normal_force"), std::string::npos);
  dem::WallWear<3> of_none({.wall = 1});
  EXPECT_TRUE(refuses([&] { of_none.after_step(sim); }, {"1"}));
  EXPECT_TRUE(
      refuses([] { dem::WallWear<2>({.coefficient = -1}); }, {"dem::WallWear: coefficient"}));
  EXPECT_TRUE(refuses([] { dem::WallWear<2>({.about = {NAN, 0}}); }, {"dem::WallWear: about"}));
}

}  // namespace
}  // namespace silt::test::wall_wear_test
