// SPDX-License-Identifier: MIT
#include <silt/dem/setup/grain_table.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/particle_csv.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <numbers>
#include <string>

inline constexpr struct temperature_t : silt::scalar_field {
} temperature{};

namespace silt::test::grain_table_test {
namespace {

class GrainTable : public FileTest {
 protected:
  template <int Dim, Field... Further>
  auto read(const std::string& text, const dem::Grain& otherwise = {}) {
    write(text);
    return dem::grains_from<Dim, double, Further...>(read_csv(path), otherwise);
  }
};

TEST_F(GrainTable, MakesGrainsFromRadiusAndDensity) {
  const auto grains = read<3>(
      "x, y, z, radius, density, velocity_z, material\n"
      "# one falls\n"
      "1, 2, 3, 0.5, 1000, -4, 0\n"
      "4, 5, 6, 0.25, 2000, 0, 1\n");
  ASSERT_EQ(grains.size(), 2u);
  EXPECT_EQ(grains[position][1], Vec<3>(4, 5, 6));
  EXPECT_EQ(grains[velocity][0], Vec<3>(0, 0, -4));
  EXPECT_EQ(grains[dem::material][1], 1u);
  const double m = 1000 * std::numbers::pi / 6;
  EXPECT_NEAR(grains[mass][0], m, 1e-12 * m);
  EXPECT_NEAR(grains[inertia][0], 0.4 * m * 0.25, 1e-12 * m);
}

TEST_F(GrainTable, AcceptsAMassAndDefaultsForAllGrains) {
  const auto grains =
      read<2, temperature_t>("x,y,mass,temperature\n0,0,3,290\n1,0,4,300\n", {.radius = 0.1});
  EXPECT_EQ(grains[radius][1], 0.1);
  EXPECT_EQ(grains[mass][1], 4);
  EXPECT_NEAR(grains[inertia][1], 4 * 0.01 / 2, 1e-15) << "of a disc";
  EXPECT_EQ(grains[temperature][0], 290);
}

TEST_F(GrainTable, ReadsBackWhatWasWritten) {
  const auto grains = crowd<3, double>(3, 1);
  write_csv(path, grains);
  EXPECT_EQ(state_of(dem::grains_from<3>(read_csv(path))), state_of(grains));
  auto shuffled = grains;
  std::vector<Index> order(grains.size());
  for (Index i = 0; i < order.size(); ++i) order[i] = order.size() - 1 - i;
  shuffled.reorder(order);
  write_csv(path, shuffled);
  EXPECT_EQ(state_of(dem::grains_from<3>(read_csv(path))), state_of(grains));
}

TEST_F(GrainTable, MessageHasTheLocationOfAnInvalidNumber) {
  const std::string head = "x,y,radius,density\n0,0,1,1\n\n";
  EXPECT_TRUE(refuses([&] { read<2>(head + "0,5,-2,1\n"); },
                      {path.string(), "line 4", "column radius: -2 must be above 0"}));
  EXPECT_TRUE(refuses([&] { read<2>(head + "0,5,inf,1\n"); },
                      {"line 4", "column radius: inf must be above 0 and finite"}));
  const std::string more = "x,y,mass,radius,inertia,velocity_y\n";
  EXPECT_TRUE(refuses([&] { read<2>(more + "0,0,inf,1,1,0\n"); },
                      {"line 2", "column mass: inf must be above 0 and finite"}));
  EXPECT_TRUE(refuses([&] { read<2>(more + "0,0,1,1,-1,0\n"); },
                      {"line 2", "column inertia: -1 must be above 0 and finite"}));
  EXPECT_TRUE(refuses([&] { read<2>(more + "0,0,1,1,1,nan\n"); },
                      {"line 2", "column velocity_y: nan must be finite"}));
  EXPECT_TRUE(refuses([&] { read<2>(head + "0,5,2,none\n"); }, {"line 4", "column density"}));
  EXPECT_TRUE(refuses([&] { read<2>("x,y,radius,density,material\n0,0,1,1,0.5\n"); },
                      {"line 2", "column material: 0.5 must be an integer"}));
  EXPECT_TRUE(refuses([&] { read<2>("x,y,raduis,density\n0,0,1,1\n"); },
                      {"unknown column raduis; known are x, y, ", "radius"}));
  EXPECT_TRUE(
      refuses([&] { read<2>("x,y,radius,density,mass\n0,0,1,1,1\n"); }, {"both density and mass"}));
  write(more + "0,0,1,1,1e-60,0\n");
  EXPECT_TRUE(refuses([&] { dem::grains_from<2, float>(read_csv(path)); },
                      {"line 2", "column inertia: 1e-60 must be above 0"}));
  EXPECT_TRUE(refuses([&] { read<3>(head); }, {"has no column z"}));
  EXPECT_TRUE(refuses([&] { read<2>("x,y,radius\n0,0,1\n"); }, {"Grain: density = 0"}));
}

}  // namespace
}  // namespace silt::test::grain_table_test
