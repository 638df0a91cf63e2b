// SPDX-License-Identifier: MIT
// Walls that are taken away and put back during a run.
#include <silt/dem.hpp>
#include <silt/dem/wall/walls.hpp>
#include <silt/io/checkpoint.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>

namespace silt::test::walls_that_come_and_go_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 5e4,
                             .restitution = 0.5,
                             .friction_angle = 0.4};

// Grains in a silo between two side walls, on a gate, wall 1, above a floor.
template <class S = NeighbourList<2>>
auto silo() {
  const dem::Polyline<> sides{
      .points = {{0, 0.6}, {0, 0.2}, {0, 0}, {0.1, 0}, {0.1, 0.2}, {0.1, 0.6}}};
  const dem::Segment<> gate{.from = {0, 0.2}, .to = {0.1, 0.2}};
  auto grains = dem::make_grains(lattice<2>({{0, 0.2}, {0.1, 0.4}}, 0.02), pebble);
  return Simulation{grains, S{}, Forces{Gravity<2>{{0.3, -9.81}}, dem::Contacts{law, sides, gate}},
                    Leapfrog{}};
}
constexpr Index gate = 1;

template <class Sim>
double lowest(const Sim& simulation) {
  double z = 1;
  for (const auto& x : simulation.particles()[position]) z = std::min(z, Vec<2>(x)[1]);
  return z;
}

TEST(WallsThatComeAndGo, LetGrainsThroughAndStopThem) {
  auto simulation = silo();
  simulation.run({.until = 0.05});
  auto& contacts = simulation.interaction().part<1>();
  EXPECT_GT(lowest(simulation), 0.2);
  EXPECT_GT(-contacts.load_on(simulation.particles(), gate).force[1], 0);
  contacts.set_wall_present(gate, false);
  EXPECT_FALSE(contacts.is_wall_present(gate));
  simulation.step();
  EXPECT_EQ(contacts.load_on(simulation.particles(), gate).force, Vec<2>(0, 0));
  simulation.run({.until = 0.3});
  EXPECT_LT(lowest(simulation), 0.1) << "on the floor";
  Index before = 0;
  for (const auto& x : simulation.particles()[position]) before += Vec<2>(x)[1] < 0.2;
  contacts.set_wall_present(gate, true);
  // Those in its way overlap it by up to a radius.
  EXPECT_NO_THROW(simulation.step());
  EXPECT_GT(before, 10u);
}

TEST(WallsThatComeAndGo, ActAtOnceOnGrainsThatAreInTheWay) {
  auto grains = one_grain<2>({0.5, 0.006}, {0, 0});
  const dem::Segment<> wall{.from = {0, 0}, .to = {1, 0}};
  Simulation simulation{grains, NeighbourList<2>{}, dem::Contacts{law, wall}, Leapfrog{}};
  simulation.interaction().set_wall_present(0, false);
  simulation.step(1e-5);
  EXPECT_EQ(simulation.interaction().size(), 0u);
  simulation.interaction().set_wall_present(0, true);
  simulation.step(1e-5);
  EXPECT_EQ(simulation.interaction().size(), 1u);
}

// An absent wall moves too fast, vibrates too fast, or breaks off at a periodic side.
TEST(WallsThatComeAndGo, LimitNoStepWhileTheyAreAbsent) {
  const auto expect_limits = [](const auto& wall, const Box<3>& box, const char* limit) {
    auto grains = one_grain<3>({0, 0, 0}, {0, 0, 0});
    grains.set_box(box);
    Simulation simulation{grains, NeighbourList<3>{}, dem::Contacts{law, wall}, Leapfrog{}};
    EXPECT_TRUE(refuses([&] { simulation.step(1e-4); }, {limit}));
    simulation.interaction().set_wall_present(0, false);
    EXPECT_NO_THROW(simulation.step(1e-4));
  };
  const dem::Plane<3> far{.point = {0, 0, -1}};
  expect_limits(dem::Moving{far, dem::Translation<3>{.velocity = {0, 0, -1000}}}, {},
                "a wall moved");
  const dem::Vibration<3> fast{.amplitude = {0, 0, 1e-4}, .frequency = 5000};
  expect_limits(dem::Moving{far, fast}, {}, "period");
  Box<3> box;
  box.lower = {-0.1, -1, -2};
  box.upper = {0.1, 1, 1};
  box.periodic[0] = true;
  expect_limits(dem::Plane<3>{.point = {0, 0, -1}, .normal = {0.1, 0, 1}}, box, "periodic");
}

class CheckpointOfWalls : public FileTest {};

TEST_F(CheckpointOfWalls, HasThosePresent) {
  auto simulation = silo();
  simulation.run({.until = 0.05});
  simulation.interaction().part<1>().set_wall_present(gate, false);
  for (int step = 0; step < 20; ++step) {
    auto restarted = silo();
    write_checkpoint(path, simulation);
    read_checkpoint(path, restarted);
    EXPECT_FALSE(restarted.interaction().part<1>().is_wall_present(gate));
    simulation.step();
    restarted.step();
    const auto forces = simulation.particles()[force];
    EXPECT_TRUE(std::ranges::equal(restarted.particles()[force], forces)) << step;
  }
}

TEST(WallsThatComeAndGo, AreThoseThatExist) {
  auto simulation = silo();
  EXPECT_TRUE(refuses([&] { simulation.interaction().part<1>().set_wall_present(2, false); },
                      {"dem::Contacts: there is no wall 2; give a number below 2"}));
}

}  // namespace
}  // namespace silt::test::walls_that_come_and_go_test
