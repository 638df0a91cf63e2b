// SPDX-License-Identifier: MIT
// A checkpoint recognises that the program that reads it has other laws, walls or settings.
// Only with --all: many kinds of walls and laws; checkpoint_file_test.cpp has other refusals.
#include <silt/dem.hpp>
#include <silt/dem/wall/walls.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/image_walls.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include "support/triangles.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::checkpoint_of_other_setup_test {
namespace {

class CheckpointOfOtherSetup : public FileTest {};

template <class... Setup>
auto grains_on(const Setup&... setup) {
  auto grains = dem::make_grains(lattice<3>({{0, 0, 0}, {0.1, 0.1, 0.1}}, 0.02), pebble);
  return Simulation{grains, UniformGrid<3>{},
                    Forces{Gravity<3>{{0, 0, -9.81}}, dem::Contacts{setup...}}, Leapfrog{}};
}

const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 5e4,
                             .restitution = 0.5,
                             .friction_angle = 0.4};

TEST_F(CheckpointOfOtherSetup, NamesTheLawOfEachParameterThatDiffers) {
  using Changes = std::vector<std::pair<std::string, std::function<void(dem::CundallStrack&)>>>;
  const Changes changes{
      {"stiffness", [](auto& each) { each.normal_stiffness *= 1.0001; }},
      {"tangential stiffness", [](auto& each) { each.tangential_stiffness *= 1.0001; }},
      {"restitution", [](auto& each) { each.restitution = 0.5001; }},
      {"friction", [](auto& each) { each.friction_angle = 0.4001; }}};
  auto simulation = grains_on(law, dem::Plane<3>{});
  simulation.run({.until = 0.001});
  write_checkpoint(path, simulation);
  EXPECT_NO_THROW(read_checkpoint(path, simulation));
  for (const auto& [name, change] : changes) {
    auto other_law = law;
    change(other_law);
    auto other = grains_on(other_law, dem::Plane<3>{});
    EXPECT_TRUE(refuses(
        [&] { read_checkpoint(path, other); },
        {"was written with another law between materials 0 and 0", ".accepts_other_setup = true"}))
        << name;
    EXPECT_EQ(other.steps(), 0u);
    read_checkpoint({.file = path, .accepts_other_setup = true}, other);
    EXPECT_EQ(other.steps(), simulation.steps());
    EXPECT_NO_THROW(other.step()) << name;
  }
}

TEST_F(CheckpointOfOtherSetup, NamesTheMaterialsOfALawWithComponents) {
  const auto materials = [](double rolling, double adhesion, double young_modulus) {
    const auto of = [&](double each) {
      const dem::Elastic elastic{.young_modulus = each, .poisson_ratio = 0.3};
      return dem::Law{dem::Hertz{.elastic = elastic, .restitution = 0.5},
                      dem::Mindlin{.elastic = elastic, .friction_angle = 0.4},
                      dem::RollingResistance{.rolling_friction = rolling},
                      dem::ConstantCohesion{.pull = adhesion}};
    };
    return dem::Materials{of(1e7), of(young_modulus)};
  };
  auto simulation = grains_on(materials(0.1, 100, 1e8), dem::Plane<3>{.material = 1});
  write_checkpoint(path, simulation);
  EXPECT_NO_THROW(read_checkpoint(path, simulation));
  auto rolling = grains_on(materials(0.101, 100, 1e8), dem::Plane<3>{.material = 1});
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, rolling); }, {"materials 0 and 0"}));
  auto cohesion = grains_on(materials(0.1, 101, 1e8), dem::Plane<3>{.material = 1});
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, cohesion); }, {"materials 0 and 0"}));
  auto second = grains_on(materials(0.1, 100, 1.01e8), dem::Plane<3>{.material = 1});
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, second); }, {"materials 0 and 1"}));
  auto wall = grains_on(materials(0.1, 100, 1e8), dem::Plane<3>{.material = 0});
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, wall); }, {"another material of wall 0"}));
}

TEST_F(CheckpointOfOtherSetup, NamesTheWallThatDiffers) {
  const auto refuses_other = [&](const auto& wall, const auto& other_wall, double until) {
    auto simulation = grains_on(law, dem::Plane<3>{.point = {0, 0, -1}}, wall);
    simulation.run({.until = until});
    write_checkpoint(path, simulation);
    EXPECT_NO_THROW(read_checkpoint(path, simulation));
    auto other = grains_on(law, dem::Plane<3>{.point = {0, 0, -1}}, other_wall);
    return refuses([&] { read_checkpoint(path, other); }, {"was written with another wall 1;"});
  };
  EXPECT_TRUE(refuses_other(dem::Plane<3>{}, dem::Plane<3>{.point = {0, 0, 0.0001}}, 0));
  EXPECT_TRUE(refuses_other(dem::Plane<3>{}, dem::Plane<3>{.normal = {0, 0.001, 1}}, 0));
  EXPECT_TRUE(refuses_other(dem::Cylinder<>{.from = {0, 0, 0}, .to = {0, 0, 1}, .radius = 0.3},
                            dem::Cylinder<>{.from = {0, 0, 0}, .to = {0, 0, 1}, .radius = 0.31},
                            0));
  const auto mesh = [](double height) {
    return dem::MeshWall<>{box_of_triangles({{-1, -1, -height}, {1, 1, 1}}, 4)};
  };
  EXPECT_TRUE(refuses_other(mesh(0.1), mesh(0.11), 0));
  const auto shaker = [](double frequency) {
    return dem::Moving{dem::Plane<3>{.point = {0, 0, -0.1}},
                       dem::Vibration<3>{.amplitude = {0, 0, 1e-3}, .frequency = frequency}};
  };
  EXPECT_TRUE(refuses_other(shaker(50), shaker(51), 0.003));
}

TEST_F(CheckpointOfOtherSetup, NamesAWallOfWhichAFarPartDiffers) {
  const auto floor_and_step = [](double place) {
    auto triangles = box_of_triangles({{-1, -1, -0.1}, {1, 1, 0}}, 4);
    triangles.push_back({{Vec<3>(place, 0.5, 0), Vec<3>(place, 0.6, 0), Vec<3>(place, 0.5, 0.1)}});
    return dem::MeshWall<>{triangles};
  };
  auto simulation = grains_on(law, floor_and_step(0.7));
  write_checkpoint(path, simulation);
  EXPECT_NO_THROW(read_checkpoint(path, simulation));
  auto other = grains_on(law, floor_and_step(0.71));
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, other); }, {"another wall 0;"}));
}

TEST_F(CheckpointOfOtherSetup, NamesAWallThatDiffersBeforeThereAreGrains) {
  const auto empty_above = [](double height) {
    return Simulation{dem::Grains<3>{}, UniformGrid<3>{},
                      dem::Contacts{law, dem::Plane<3>{.point = {0, 0, height}}}, Leapfrog{}};
  };
  write_checkpoint(path, empty_above(0));
  auto other = empty_above(0.01);
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, other); }, {"another wall 0;"}));
}

template <class... Setup>
auto grain_at(double height, const Setup&... setup) {
  return Simulation{one_grain<3>({0, 0, height}, {0.1, 0, 0}), NeighbourList<3>{},
                    dem::Contacts{setup...}, Leapfrog{}};
}

TEST_F(CheckpointOfOtherSetup, IsReadWithAWallThatThenActsAtOnce) {
  constexpr double R = pebble.radius;
  auto simulation = grain_at(2 * R, law, dem::Plane<3>{});
  simulation.step(1e-5);
  write_checkpoint(path, simulation);
  auto other = grain_at(2 * R, law, dem::Plane<3>{.point = {0, 0, 1.05 * R}});
  read_checkpoint({.file = path, .accepts_other_setup = true}, other);
  other.step(1e-5);
  EXPECT_EQ(other.interaction().size(), 1u);
}

TEST_F(CheckpointOfOtherSetup, IsReadWithALawOfAnotherStableTimeStep) {
  auto simulation = grain_at(0.999 * pebble.radius, law, dem::Plane<3>{});
  simulation.step(1e-5);
  write_checkpoint(path, simulation);
  auto stiff = law;
  stiff.normal_stiffness = 1e9;
  auto other = grain_at(0.999 * pebble.radius, stiff, dem::Plane<3>{});
  read_checkpoint({.file = path, .accepts_other_setup = true}, other);
  EXPECT_TRUE(refuses([&] { other.step(1e-4); }, {"stable time step"}));
}

// The history of wall 1 is not that of the wall which is now number 0.
TEST_F(CheckpointOfOtherSetup, IsReadWithFewerWallsAndBeginsTheirContactsAnew) {
  const dem::Plane<3> lid{.point = {0, 0, 1}, .normal = {0, 0, -1}};
  auto simulation = grain_at(0.999 * pebble.radius, law, lid, dem::Plane<3>{});
  for (int step = 0; step < 10; ++step) simulation.step(1e-5);
  EXPECT_EQ(simulation.interaction().history(simulation.particles()).size(), 1u);
  write_checkpoint(path, simulation);
  auto other = grain_at(0.999 * pebble.radius, law, dem::Plane<3>{});
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, other); }, {"another number of walls;"}));
  read_checkpoint({.file = path, .accepts_other_setup = true}, other);
  EXPECT_EQ(other.interaction().history(other.particles()).size(), 0u);
  EXPECT_NO_THROW(other.step(1e-5));
}

TEST_F(CheckpointOfOtherSetup, NamesAnotherNumberOfMaterials) {
  auto simulation = grains_on(dem::Materials{law, law}, dem::Plane<3>{});
  write_checkpoint(path, simulation);
  auto other = grains_on(dem::Materials{law, law, law}, dem::Plane<3>{});
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, other); }, {"another number of materials;"}));
}

TEST_F(CheckpointOfOtherSetup, NamesWhatIsDifferentInAFlow) {
  using Settings = mps::FlowSettings<2, mps::Recommended>;
  const auto flow = [](const Settings& settings) {
    mps::Fluid<2> fluid;
    mps::add_particle(fluid, {0, 0}, mps::Kind::fluid);
    return Simulation{fluid, UniformGrid<2>{}, mps::Flow<mps::Recommended>(settings), SemiImplicit{}};
  };
  Settings own{.spacing = 0.01};
  own.walls.segments = {{{Vec<2>(-1, -1), Vec<2>(1, -1)}}};
  write_checkpoint(path, flow(own));
  const auto expect_refused = [&](auto&& change, const std::string& name) {
    Settings settings = own;
    change(settings);
    auto other = flow(settings);
    EXPECT_TRUE(refuses([&] { read_checkpoint(path, other); }, {"another FlowSettings::" + name}));
  };
  expect_refused([](Settings& s) { s.spacing = 0.011; }, "spacing");
  expect_refused([](Settings& s) { s.density = 800; }, "density");
  expect_refused([](Settings& s) { s.viscosity = 1e-5; }, "viscosity");
  expect_refused([](Settings& s) { s.gravity[0] = 1; }, "gravity");
  expect_refused([](Settings& s) { s.laplacian_radius = 2.1; }, "radius");
  expect_refused([](Settings& s) { s.walls.segments[0].corners[1] = {1, -1.001}; }, "walls");
  auto same = flow(own);
  read_checkpoint(path, same);
}

}  // namespace
}  // namespace silt::test::checkpoint_of_other_setup_test
