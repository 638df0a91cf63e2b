// SPDX-License-Identifier: MIT
// Constants of grains that are changed through views from before the last step. After an even
// number of steps one of the next 16, or that which rebuilds the list, refuses them, and the next
// one is for the grains as they are. After an odd number, nothing is changed, except materials.
// Only with --all: a rare mistake in use, with every constant in 2D and 3D.
#include <silt/dem.hpp>
#include <silt/io/checkpoint.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace silt::test::old_views_test {
namespace {

constexpr double dt = 1e-5;

template <int Dim>
auto bed() {
  const dem::CundallStrack law{.normal_stiffness = 1e5, .restitution = 0.5};
  const dem::Materials<dem::CundallStrack> materials{law, law};
  return Simulation{crowd<Dim, double>(Dim == 2 ? 20 : 8, 1), NeighbourList<Dim>{},
                    dem::Contacts{materials}.with(without_limits), Leapfrog{}};
}

template <class Sim>
bool have_same_bits(const Sim& a, const Sim& b) {
  const auto xa = a.particles()[position], xb = b.particles()[position];
  const auto va = a.particles()[velocity], vb = b.particles()[velocity];
  return std::equal(xa.begin(), xa.end(), xb.begin(), xb.end()) &&
         std::equal(va.begin(), va.end(), vb.begin(), vb.end());
}

// change(value) of grain k after some steps, through a view from before them; before_step(sim) is
// called before the next step. One of `at_most` steps must fail.
template <int Dim, class F, class Change, class Before>
void expect_refused_once(F field, const std::string& name, int at_most, Change&& change,
                         Before&& before_step, int steps = 2) {
  constexpr Index k = 300;
  auto sim = bed<Dim>();
  sim.step(dt);
  const auto old = sim.particles()[field];
  // With two buffers, `old` is of the present after two steps.
  for (int step = 0; step < steps; ++step) sim.step(dt);
  change(old[k]);
  ASSERT_EQ(std::as_const(sim).particles()[field][k], old[k]);
  before_step(sim);
  auto was = sim;
  std::optional<Error> error;
  for (int step = 0; step < at_most && !error; ++step) {
    was = sim;
    try {
      sim.step(dt);
    } catch (const Error& refused) {
      error = refused;
    }
  }
  ASSERT_TRUE(error) << name << " was changed, and no error";
  const std::string text = error->what();
  EXPECT_NE(text.find("dem::Contacts: " + name + " changed from "), std::string::npos) << text;
  EXPECT_NE(text.find("simulation.particles()[" + name + "]"), std::string::npos) << text;
  EXPECT_EQ(error->where().id, std::optional<Id>(sim.particles().id(k))) << text;
  EXPECT_TRUE(have_same_bits(sim, was)) << "a failed step changed the state";

  was.particles()[field];  // notes the change
  for (int step = 0; step < 30; ++step) {
    sim.step(dt);
    was.step(dt);
  }
  EXPECT_TRUE(have_same_bits(sim, was)) << "after a change of " << name;
}

template <int Dim>
void expect_all_refused() {
  const auto larger = [](auto& value) { value = std::decay_t<decltype(value)>(1.01 * value); };
  const auto nothing = [](auto&) {};
  const auto rebuild = [](auto& sim) { sim.particles()[position][0][0] += 0.001; };
  expect_refused_once<Dim>(radius, "radius", 16, larger, nothing);
  expect_refused_once<Dim>(mass, "mass", 16, larger, nothing);
  expect_refused_once<Dim>(inertia, "inertia", 16, larger, nothing);
  for (const int steps : {1, 2}) {  // materials have one buffer, as steps do not write them
    expect_refused_once<Dim>(dem::material, "material", 16, [](auto& n) { n = 1; }, nothing, steps);
  }
  expect_refused_once<Dim>(radius, "radius", 1, larger, rebuild);
}

// change(value) of a grain through a view from before an odd number of steps, which is of the other
// of the two buffers: the run has the same bits as without.
template <int Dim, class F, class Change>
void expect_no_effect(F field, int steps, Change&& change) {
  constexpr Index k = 300;
  auto sim = bed<Dim>();
  auto unchanged = bed<Dim>();
  sim.step(dt);
  unchanged.step(dt);
  const auto old = sim.particles()[field];
  unchanged.particles()[field];
  for (int step = 0; step < steps; ++step) {
    sim.step(dt);
    unchanged.step(dt);
  }
  const auto was = std::as_const(sim).particles()[field][k];
  change(old[k]);
  ASSERT_EQ(std::as_const(sim).particles()[field][k], was) << "the view is of the present";
  ASSERT_NE(old[k], was);
  for (int step = 0; step < 40; ++step) {
    sim.step(dt);
    unchanged.step(dt);
    ASSERT_TRUE(have_same_bits(sim, unchanged)) << "step " << step;
  }
  EXPECT_EQ(state_of(sim.particles()), state_of(unchanged.particles()));
  EXPECT_EQ(sim.time_step(), unchanged.time_step());
}

template <int Dim>
void expect_writes_are_lost() {
  const auto larger = [](auto& value) { value = std::decay_t<decltype(value)>(1.01 * value); };
  for (const int steps : {1, 3}) {
    expect_no_effect<Dim>(radius, steps, larger);
    expect_no_effect<Dim>(mass, steps, larger);
    expect_no_effect<Dim>(inertia, steps, larger);
  }
}

TEST(OldViewsOfConstants, FromBeforeAnOddNumberOfStepsHaveNoEffect2D) {
  expect_writes_are_lost<2>();
}
TEST(OldViewsOfConstants, FromBeforeAnOddNumberOfStepsHaveNoEffect3D) {
  expect_writes_are_lost<3>();
}

TEST(OldViewsOfConstants, AreRefusedWithin16Steps2D) { expect_all_refused<2>(); }
TEST(OldViewsOfConstants, AreRefusedWithin16Steps3D) { expect_all_refused<3>(); }

// The default time step, the reach and a checkpoint are for the values at that time, although the
// view was obtained, and all of them were asked for, before a value was written through it.
TEST(ViewsOfConstants, MayBeUsedUntilTheNextStep) {
  constexpr Index k = 300;
  auto sim = bed<3>();
  for (int step = 0; step < 3; ++step) sim.step(dt);
  const double was = sim.time_step();
  const auto m = sim.particles()[mass];
  EXPECT_EQ(sim.time_step(), was);
  m[k] *= 1e-4;
  EXPECT_LT(sim.time_step(), 0.1 * was);

  auto expected = sim;
  const auto R = sim.particles()[radius];
  EXPECT_LT(sim.interaction().reach(sim.particles()), 0.025);
  R[k] = 0.03;
  EXPECT_EQ(sim.interaction().reach(sim.particles()), 0.06);
  expected.particles()[radius][k] = 0.03;
  for (int step = 0; step < 20; ++step) {
    sim.step(1e-7);
    expected.step(1e-7);
  }
  EXPECT_EQ(sim.interaction().size(), expected.interaction().size());
  EXPECT_TRUE(have_same_bits(sim, expected));
}

// A checkpoint does not have a list that does not belong to the grains in it.
TEST(OldViewsOfConstants, DoNotReachACheckpoint) {
  auto sim = bed<2>();
  sim.step(dt);
  const auto old = sim.particles()[radius];
  for (int step = 0; step < 2; ++step) sim.step(dt);
  old[200] *= 1.5;
  const std::string path = path_of_test();
  write_checkpoint(path, sim);
  auto resumed = bed<2>();
  read_checkpoint(path, resumed);
  std::filesystem::remove(path);
  auto expected = bed<2>();
  expected = sim;
  expected.particles()[radius];  // notes the change
  resumed.step(1e-7);
  expected.step(1e-7);
  EXPECT_EQ(resumed.interaction().size(), expected.interaction().size());
  EXPECT_TRUE(have_same_bits(resumed, expected));
}

// A view is of this step until the next one.
TEST(OldViewsOfConstants, AreNotThoseObtainedAfterTheStep) {
  auto sim = bed<3>();
  for (int step = 0; step < 10; ++step) {
    sim.particles()[radius][7] *= 1.001;
    sim.step(dt);
  }
}

}  // namespace
}  // namespace silt::test::old_views_test
