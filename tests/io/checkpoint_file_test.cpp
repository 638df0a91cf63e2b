// SPDX-License-Identifier: MIT
// State of searches in a checkpoint, and rejected checkpoint files.
#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"

#include <silt/dem/setup/inflow.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/checkpoints.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace silt::test::checkpoint_file_test {
namespace {

using CheckpointFile = FileTest;

// The search is updated in every step, although gravity does not use it.
struct GravityWithSearch : Gravity<2> {
  using Gravity<2>::Gravity;
  template <class P>
  bool needs_search(const P&) const {
    return true;
  }
};

// Enough particles that they are sorted in memory now and then: the order of rows affects the bits.
template <class S>
void expect_same_order(const std::filesystem::path& path) {
  auto gas = crowd<2, double>(33, 3);
  auto box = cube<2, double>(-0.1, 1);
  box.periodic = {true, true};
  gas.set_box(box);
  const auto make = [&gas] {
    return Simulation{gas, S({.radius = 0.02}), GravityWithSearch{{3, -9.81}}, Leapfrog{}};
  };
  auto whole = make();
  for (int k = 0; k < 25; ++k) whole.step(4e-3);
  write_checkpoint(path, whole);
  auto part = make();
  read_checkpoint(path, part);
  EXPECT_EQ(state_of(part.particles()), state_of(whole.particles()));
  EXPECT_NE(std::vector<Id>(part.particles().ids().begin(), part.particles().ids().end()),
            std::vector<Id>(gas.ids().begin(), gas.ids().end()));
  for (int k = 0; k < 25; ++k) {
    whole.step(4e-3);
    part.step(4e-3);
    ASSERT_EQ(state_of(part.particles()), state_of(whole.particles())) << "step " << k;
  }
}

TEST_F(CheckpointFile, KeepsTheOrderInMemoryWithAGrid) {
  expect_same_order<UniformGrid<2>>(path);
}
TEST_F(CheckpointFile, KeepsTheOrderInMemoryWithAList) {
  expect_same_order<NeighbourList<2>>(path);
}

TEST_F(CheckpointFile, KeepsTheNumberOfLostParticles) {
  auto grains = one_grain<2>({0.5, 0.5}, {1, 0});
  auto box = cube<2, double>(0, 1);
  box.on_escape = OnEscape::remove;
  grains.set_box(box);
  const auto make = [&grains] {
    return Simulation{grains, UniformGrid<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
  };
  auto whole = make();
  whole.run({.until = 0.6, .time_step = 0.1});
  ASSERT_EQ(whole.particles_lost(), 1u);
  write_checkpoint(path, whole);
  auto part = make();
  read_checkpoint(path, part);
  EXPECT_EQ(part.particles_lost(), 1u);
}

// Just so many small grains in a cell of the large one that the list finds contacts with levels of
// sizes, if the cell is enlarged by the skin that was wanted, not by that of the small grains.
auto large_among_small() {
  const double small_radius = 1e-3;
  const auto points = lattice(cube<2, double>(0, 0.106), 2.1 * small_radius);
  auto grains = dem::make_grains(points, {.radius = small_radius, .density = 2500});
  const auto v = random_points(points.size(), cube<2, double>(-1, 1), 5);
  for (Index i = 0; i < grains.size(); ++i) grains[velocity][i] = v[i];
  dem::add_grain(grains, {0.07, -0.025}, {.radius = 25 * small_radius, .density = 2500});
  return Simulation{grains, NeighbourList<2>({.radius = 0.05}), GravityWithSearch{{3, -9.81}},
                    Leapfrog{}};
}

TEST_F(CheckpointFile, KeepsTheOrderInMemoryOfGrainsOfVeryDifferentSizes) {
  for (const bool adds_grain : {false, true}) {
    SCOPED_TRACE(adds_grain ? "with a new grain" : "with the same grains");
    auto whole = large_among_small();
    for (int k = 0; k < 20; ++k) whole.step(1e-4);
    EXPECT_LT(whole.search().skin(), 1e-3) << "no levels";
    if (adds_grain) dem::add_grain(whole.particles(), {0, 0.2}, pebble);
    write_checkpoint(path, whole);
    auto part = Simulation{dem::Grains<2>{}, NeighbourList<2>({.radius = 0.05}),
                           GravityWithSearch{{3, -9.81}}, Leapfrog{}};
    read_checkpoint(path, part);
    for (int k = 0; k < 20; ++k) {
      whole.step(1e-4);
      part.step(1e-4);
      ASSERT_EQ(state_of(part.particles()), state_of(whole.particles())) << "step " << k;
      ASSERT_EQ(part.search().skin(), whole.search().skin()) << "step " << k;
      ASSERT_EQ(part.search().rebuilds(), whole.search().rebuilds()) << "step " << k;
    }
  }
}

const dem::CundallStrack law{.normal_stiffness = 1e5, .tangential_stiffness = 5e4};

auto two() {
  return Simulation{two_grains<2>(-1e-4, Vec<2>(-0.1, 0.2)), UniformGrid<2>{}, dem::Contacts{law},
                    Leapfrog{}};
}

// Two grains without contacts, for errors unrelated to contacts.
template <int Dim, class Real>
auto flight() {
  const Vec<Dim, Real> g = -Vec<Dim, Real>::Unit(0);
  return Simulation{crowd<Dim, Real>(1, 1), UniformGrid<Dim, Real>{}, Gravity<Dim, Real>{g},
                    Leapfrog{}};
}

struct Spring {
  template <class C>
  typename C::Vec force(const C& contact) const {
    return typename C::Real(1e5) * contact.overlap * contact.normal;
  }
};

TEST_F(CheckpointFile, IsRejectedIfItIsDamaged) {
  auto sim = two();
  sim.run({.until = 1e-3});
  write_checkpoint(path, sim);
  const std::string good = bytes();
  const Bytes before = state_of(sim.particles());
  const auto rejected = [&](const std::string& text, const std::vector<std::string>& fragments) {
    write(text);
    return refuses([&] { read_checkpoint(path, sim); }, fragments);
  };
  for (const Index length : {Index{30}, good.size() / 2, good.size() - 1}) {
    EXPECT_TRUE(rejected(good.substr(0, length), {path.string(), "truncated or damaged"}));
  }
  for (const Index byte : {Index{40}, good.size() / 2, good.size() - 3}) {
    std::string bad = good;
    bad[byte] = static_cast<char>(bad[byte] ^ 4);
    EXPECT_TRUE(rejected(bad, {"truncated or damaged"}));
  }
  EXPECT_TRUE(rejected("", {"is not a checkpoint"}));
  EXPECT_TRUE(rejected("x,y\n1,2\n", {"is not a checkpoint"}));
  std::filesystem::remove(path);
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, sim); }, {"cannot open", path.string()}));
  EXPECT_TRUE(refuses([&] { read_checkpoint(testing::TempDir(), sim); },
                      {"read_checkpoint", "directory"}));
  EXPECT_EQ(state_of(sim.particles()), before);
}

inline constexpr struct heat_t : field_of<double> {
} heat{};

// It could not be read.
TEST_F(CheckpointFile, IsNotReplacedByOneWithNumbersThatAreNotFinite) {
  dem::Grains<2, double, heat_t> grains;
  for (int k = 0; k < 3; ++k) dem::add_grain(grains, {0.1 * k, 0}, pebble);
  Simulation sim{grains, BruteForce<2>{}, Gravity<2>{{0, -9.81}}, Leapfrog{}};
  write_checkpoint(path, sim);
  sim.step(1e-3);
  sim.particles()[heat][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([&] { write_checkpoint(path, sim); },
                      {"write_checkpoint: ", "particles/heat = nan, value 2,"}));
  read_checkpoint(path, sim);
  EXPECT_EQ(sim.steps(), 0u);
}

TEST_F(CheckpointFile, ReportsAFileThatCannotBeAccessed) {
  EXPECT_FALSE(Checkpoints(path, {}).exist());
  const Checkpoints unusable(std::string(5000, 'a'), {});
  EXPECT_TRUE(refuses([&] { unusable.exist(); }, {"Checkpoints: cannot access"}));
}

TEST_F(CheckpointFile, IsRejectedByAnotherDimensionPrecisionSearchOrLaw) {
  auto plane = flight<2, double>();
  write_checkpoint(path, plane);
  auto space = flight<3, double>();
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, space); },
                      {"simulation/particles/dimension = 2, but here it is 3"}));
  auto single = flight<2, float>();
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, single); },
                      {"precision = double, but here it is float"}));
  Simulation listed{crowd<2, double>(1, 1), NeighbourList<2>{}, Gravity<2>{{0, -1}}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, listed); },
                      {"has simulation/search/", " where simulation/search/", "is expected"}));
  dem::Outflow drain{cube<2, double>(0, 1)};
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, plane, drain); }, {"has no part 0/number"}));
  write_checkpoint(path, plane, drain);
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, plane); },
                      {"further entries, beginning with part 0/number", "pass the same parts"}));
  write_checkpoint(path, two());
  Simulation weightless{two().particles(), UniformGrid<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, weightless); },
                      {"has further entries, beginning with simulation/interaction/",
                       "set up the same simulation"}));

  auto with_friction = two();
  with_friction.run({.until = 1e-3});
  write_checkpoint(path, with_friction);
  Simulation without{two().particles(), UniformGrid<2>{}, dem::Contacts{Spring{}}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, without); },
                      {"has simulation/interaction/history/values/approach_speed where "
                       "simulation/interaction/history/values is expected"}));
}

}  // namespace
}  // namespace silt::test::checkpoint_file_test
