// SPDX-License-Identifier: MIT
// The black box of a failed step: a small checkpoint that repeats the error.
#include <silt/dem.hpp>
#include <silt/io/black_box.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>

namespace silt::test::black_box_test {
namespace {

using BlackBoxFile = FileTest;

// A bed of pebbles on a floor; one more, `speed` fast, will hit it.
auto bed(double speed) {
  auto grains = dem::make_grains(lattice<3>({{0, 0, 0}, {0.2, 0.2, 0.1}}, 0.02), pebble);
  const Index i = dem::add_grain(grains, {0.1, 0.1, 0.13}, pebble);
  grains[velocity][i] = {0, 0, -speed};
  return grains;
}
template <class P>
auto simulation_of(P grains) {
  return Simulation{
      std::move(grains), NeighbourList<3>{},
      Forces{Gravity<3>{{0, 0, -9.81}},
             dem::Contacts{dem::CundallStrack{.normal_stiffness = 100, .restitution = 0.5},
                           dem::Plane<3>{}}},
      Leapfrog{}};
}

template <class Sim>
std::optional<Error> error_of_run(Sim& sim) {
  try {
    sim.run({.until = 0.1, .time_step = 1e-5});
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

TEST_F(BlackBoxFile, RepeatsTheErrorWithFewGrains) {
  auto whole = simulation_of(bed(20));
  const auto error = error_of_run(whole);
  ASSERT_TRUE(error);
  ASSERT_NE(std::string(error->what()).find("overlap by"), std::string::npos) << error->what();
  write_black_box({.file = path, .max_distance = 0.05}, whole, *error);

  auto part = simulation_of(dem::Grains<3>{});
  read_checkpoint(path, part);
  EXPECT_GT(part.particles().size(), 5u);
  EXPECT_LT(part.particles().size(), whole.particles().size() / 4);
  EXPECT_EQ(part.steps(), whole.steps());
  const auto again = error_of_run(part);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->where().id, error->where().id);
  EXPECT_EQ(again->where().step, error->where().step);
  const std::string text = error->what();
  // Up to the index in memory.
  EXPECT_EQ(std::string(again->what()).substr(0, text.find("(particle")),
            text.substr(0, text.find("(particle")));
}

TEST_F(BlackBoxFile, GivesTheSameForceOnTheGrainOfTheError) {
  auto whole = simulation_of(bed(1));
  whole.run({.until = 0.02, .time_step = 1e-5});
  const Index guilty = whole.particles().size() / 2;
  const Id id = whole.particles().id(guilty);
  write_black_box({.file = path}, whole, Error("", {.particle = guilty, .id = id}));
  auto part = simulation_of(dem::Grains<3>{});
  read_checkpoint(path, part);
  EXPECT_LT(part.particles().size(), whole.particles().size());
  whole.step(1e-5);
  part.step(1e-5);
  const auto of = [&](auto& sim) { return sim.particles().index_of(id); };
  EXPECT_EQ(part.particles()[force][of(part)], whole.particles()[force][of(whole)]);
  EXPECT_EQ(part.particles()[position][of(part)], whole.particles()[position][of(whole)]);
  EXPECT_GT(whole.particles()[force][of(whole)].norm(), 0);
}

TEST_F(BlackBoxFile, NeedsAParticleOfTheSimulation) {
  const auto sim = simulation_of(bed(1));
  EXPECT_TRUE(refuses([&] { write_black_box({.file = path}, sim, Error("too dark")); },
                      {"write_black_box: the error names no particle", "too dark"}));
  EXPECT_TRUE(refuses([&] { write_black_box({.file = path}, sim, Error("", {.id = 12345})); },
                      {"no longer has particle"}));
  EXPECT_TRUE(refuses(
      [&] { write_black_box({.file = path, .max_distance = 0}, sim, Error("", {.id = 1})); },
      {"BlackBox: max_distance = 0 must be positive"}));
}

}  // namespace
}  // namespace silt::test::black_box_test
