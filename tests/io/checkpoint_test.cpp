// SPDX-License-Identifier: MIT
// A run resumed from a checkpoint is bitwise identical to an uninterrupted run.
#include <silt/dem/setup/inflow.hpp>
#include <silt/io/checkpoint.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace silt::test::checkpoint_test {
namespace {

using Checkpoint = FileTest;

const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 5e4,
                             .restitution = 0.6,
                             .friction_angle = 0.5};
const dem::Blend<dem::UniformSizes> pebbles{.sizes = {.min_radius = 0.006, .max_radius = 0.012},
                                            .density = 2500};

// Grains slide down a vibrating slope with periodic sides; an inflow adds grains, and an outflow
// removes some.
template <int Dim>
struct Slope {
  static constexpr double wide = Dim == 2 ? 0.6 : 0.12;

  static Box<Dim> box() {
    auto box = cube<Dim, double>(0, wide);
    box.periodic.fill(true);
    box.periodic[Dim - 1] = false;
    box.lower[Dim - 1] = -1;
    box.upper[Dim - 1] = 1;
    return box;
  }
  static Box<Dim> part(double lower, double upper) {
    auto part = box();
    part.lower[Dim - 1] = lower;
    part.upper[Dim - 1] = upper;
    return part;
  }
  static Box<Dim> hole() {
    auto hole = part(0, 0.05);
    hole.periodic.fill(false);
    hole.upper[0] = 0.05;
    return hole;
  }
  static Vec<Dim> pull() {
    Vec<Dim> g = -9.81 * Vec<Dim>::Unit(Dim - 1);
    g[0] = 5;
    return g;
  }

  template <class S>
  static auto make(S search) {
    dem::Grains<Dim> grains(box());
    const dem::Moving floor{
        dem::Plane<Dim>{},
        dem::Vibration<Dim>{.amplitude = 1e-3 * Vec<Dim>::Unit(Dim - 1), .frequency = 30}};
    return Simulation{
        grains, std::move(search),
        Forces{Gravity<Dim>{pull()},
               dem::Contacts{law, floor}.with({.steps_per_contact = 20, .max_overlap = 1})},
        Leapfrog{GlobalDamping{.alpha = 0.5}}};
  }

  dem::Inflow<Box<Dim>, dem::UniformSizes> rain{
      part(0.1, 0.25),
      pebbles,
      {.number = 460, .rate = 2000, .velocity = -2 * Vec<Dim>::Unit(Dim - 1), .every = 0.01}};
  dem::Outflow<Box<Dim>> drain{hole()};
};

template <int Dim, class S>
void expect_same_bits(const std::filesystem::path& path) {
  const auto run = [](auto& sim, auto& slope, double until) {
    sim.run({.until = until}, slope.drain, slope.rain);
  };
  const auto bits = [](const auto& sim, const auto& slope) {
    Bytes bytes = state_of(sim.particles());
    const Bytes now = state_of(sim.snapshot());
    bytes.insert(bytes.end(), now.begin(), now.end());
    const double numbers[] = {sim.time(), double(sim.steps()), slope.drain.mass(),
                              double(slope.rain.number()), double(slope.drain.number())};
    append(bytes, std::span<const double>(numbers));
    return bytes;
  };
  auto whole = Slope<Dim>::make(S{});
  Slope<Dim> flow_of_whole;
  run(whole, flow_of_whole, 0.1637);
  EXPECT_FALSE(flow_of_whole.rain.is_done());
  EXPECT_GT(flow_of_whole.drain.number(), 0u);
  EXPECT_GT(whole.interaction().template part<1>().size(), Dim == 2 ? 50u : 8u);
  write_checkpoint(path, whole, flow_of_whole.rain, flow_of_whole.drain);
  const auto here = bits(whole, flow_of_whole);
  run(whole, flow_of_whole, 0.23);

  for (const int number : Dim == 2 ? std::vector{1, 4} : std::vector{3}) {
    with_threads(number, [&] {
      auto part = Slope<Dim>::make(S{});
      Slope<Dim> flow_of_part;
      read_checkpoint(path, part, flow_of_part.rain, flow_of_part.drain);
      EXPECT_EQ(bits(part, flow_of_part), here);
      run(part, flow_of_part, 0.23);
      EXPECT_EQ(part.steps(), whole.steps());
      EXPECT_EQ(bits(part, flow_of_part), bits(whole, flow_of_whole)) << number << " threads";
      return 0;
    });
  }
}

TEST_F(Checkpoint, ResumesBitwiseIdenticalIn2D) { expect_same_bits<2, NeighbourList<2>>(path); }
TEST_F(Checkpoint, ResumesBitwiseIdenticalIn3D) { expect_same_bits<3, NeighbourList<3>>(path); }
}  // namespace
}  // namespace silt::test::checkpoint_test
