// SPDX-License-Identifier: MIT
#include <silt/core/lattice.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/csv_series.hpp>
#include <silt/measure/flux.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/measure/tracks.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace silt::test::csv_series_test {
namespace {

constexpr double l0 = 0.02;  // [m]

auto collapse() {
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.2, 0.3}, .size = {.length = 0.6, .height = 0.4}, .spacing = l0});
  return Simulation{
      tank.particles, UniformGrid<2>{},
      mps::Flow<mps::Recommended>{{.spacing = l0, .speed_scale = 2, .walls = tank.walls}},
      SemiImplicit<>{}};
}
auto all_measures(const std::filesystem::path& path) {
  return CsvSeries{path,
                   SurfaceHeight<2>{.point = {0.1, 0}, .spacing = l0},
                   SurfaceHeight<2>{.point = {0.3, 0}, .spacing = l0},
                   WallGauge<2>{.point = {0, 0.05}, .spacing = l0}.of(mps::pressure),
                   WallLoad<2>::of_all_walls().about({0.3, 0}),
                   Flux<2>{{.faces = polyline({{0.25, 1}, {0.25, -1}}), .spacing = l0}},
                   track<2>({3, 17}, velocity, mps::pressure)};
}
std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// All measures in one file, which says how each was found and which other programs read.
TEST(CsvSeries, WritesReadingsAndTheirFilters) {
  const Folder folder;
  auto sim = collapse();
  auto series = all_measures(folder.path / "a.csv");
  sim.run({.until = 0.1}, series);
  const auto table = read_csv(folder.path / "a.csv");
  EXPECT_EQ(table.names(),
            (std::vector<std::string>{
                "t",       "height_1", "height_2",      "pressure",      "pressure_by_load",
                "force_x", "force_y",  "torque",        "flux",          "volume",
                "x_3",     "y_3",      "velocity_x_3",  "velocity_y_3",  "pressure_3",
                "x_17",    "y_17",     "velocity_x_17", "velocity_y_17", "pressure_17"}));
  EXPECT_EQ(table.rows(), sim.steps() + 1);
  EXPECT_NEAR(table["height_1"][0], 0.3, 0.05 * l0);
  EXPECT_TRUE(std::isnan(table["height_2"][0]));
  EXPECT_GT(table["pressure"].back(), 1000);
  EXPECT_NEAR(table["pressure_by_load"].back() / table["pressure"].back(), 1, 0.1);
  EXPECT_EQ(table["force_y"].back(), WallLoad<2>::of_all_walls().read(sim)[1]);
  EXPECT_GT(table["volume"].back(), 0);
  EXPECT_EQ(table["x_17"].back(), sim.particles()[position][sim.particles().index_of(17)][0]);
  EXPECT_EQ(std::get<4>(series.measures()).volume(), table["volume"].back());
  const std::string text = text_of(folder.path / "a.csv");
  for (const char* words : {"# t: time [s]", "# height_1: height of the surface [m] at (0.1, 0) m",
                            "# pressure to pressure_by_load: gauge on a wall",
                            "# force_x to torque: ", "# flux to volume: flow rate and volume",
                            "# x_3 to pressure_17: tracks of 2"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words;
  }
}
TEST(CsvSeries, WritesAtOutputsOnce) {
  const Folder folder;
  auto sim = collapse();
  auto series = CsvSeries{folder.path / "a.csv", SurfaceHeight<2>{.point = {0.1, 0}, .spacing = l0},
                          Flux<2>{{.faces = polyline({{0.25, 1}, {0.25, -1}}), .spacing = l0}}}
                    .at_outputs();
  sim.run({.until = 0.04, .output_every = 0.02}, series);
  sim.run({.until = 0.08, .output_every = 0.02}, series);
  const auto table = read_csv(folder.path / "a.csv");
  EXPECT_EQ(table.rows(), 5u);
  double volume = 0;
  for (Index k = 1; k < table.rows(); ++k) {
    volume += table["flux"][k] * (table["t"][k] - table["t"][k - 1]);
    EXPECT_NEAR(volume, table["volume"][k], 1e-12);
  }
  EXPECT_GT(volume, 0);
}
TEST(CsvSeries, GoesOnAfterARestart) {
  const Folder folder;
  auto sim = collapse();
  auto series = all_measures(folder.path / "a.csv");
  sim.run({.until = 0.08}, series);

  auto first = collapse();
  auto stopped = all_measures(folder.path / "b.csv");
  first.run({.until = 0.04}, stopped);
  write_checkpoint(folder.path / "c.silt", first, stopped);
  first.run({.until = 0.05}, stopped);  // its rows are removed
  auto second = collapse();
  auto resumed = all_measures(folder.path / "b.csv");
  read_checkpoint(folder.path / "c.silt", second, resumed);
  second.run({.until = 0.08}, resumed);
  EXPECT_EQ(text_of(folder.path / "b.csv"), text_of(folder.path / "a.csv"));
}
TEST(CsvSeries, TracksEndWithTheirParticles) {
  const Folder folder;
  auto sim = collapse();
  auto series = CsvSeries{folder.path / "a.csv", track<2>({5})};
  sim.run({.until = 0.01}, series);
  sim.particles().remove_if([&](Index i) { return sim.particles().id(i) == 5; });
  sim.run({.until = 0.02}, series);
  const auto table = read_csv(folder.path / "a.csv");
  EXPECT_FALSE(std::isnan(table["x_5"][1]));
  EXPECT_TRUE(std::isnan(table["x_5"].back()));
}
TEST(CsvSeries, RefusesTracksOfNothing) {
  EXPECT_TRUE(refuses([] { track<2>({}); }, {"Tracks: no ids"}));
  EXPECT_TRUE(refuses([] { track<2>({3, 4, 3}); }, {"Tracks: the id 3", "twice"}));
}

}  // namespace
}  // namespace silt::test::csv_series_test
