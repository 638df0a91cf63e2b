// SPDX-License-Identifier: MIT
// The step times are those of a simulated machine; no clock is read.
#include <silt/core/thread_choice.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace silt::test::thread_choice_test {
namespace {

using detail::ThreadChoice;

/// A simulated machine on which a step takes `one` seconds with one thread and `all` with all.
struct Machine {
  double one = 1e-3;
  double all = 1e-3;

  ThreadChoice choice = {};
  double time = 0;
  int steps = 0;
  int steps_with_all = 0;
  int trials = 0;
  bool was_trial = false;

  void step() {
    ++steps;
    if (choice.all()) ++steps_with_all;
    if (choice.is_trial() && !was_trial) ++trials;
    was_trial = choice.is_trial();
    double taken = choice.all() ? all : one;
    // As in the loops: beyond the limit, the rest of the step runs with one thread.
    if (taken > choice.limit()) taken = choice.limit() + one;
    time += taken;
    choice.add(taken);
  }
  void run_for(double seconds) {
    const double end = time + seconds;
    while (time < end) step();
  }

  /// Apart from trials.
  bool uses_all() const { return choice.all() != choice.is_trial(); }
};

TEST(ThreadChoice, BeginsWithOneThread) {
  const ThreadChoice choice;
  EXPECT_FALSE(choice.all());
  EXPECT_FALSE(choice.is_trial());
  EXPECT_EQ(choice.limit(), std::numeric_limits<double>::infinity());
}

TEST(ThreadChoice, UsesAllThreadsIfTheyAreFaster) {
  for (const double one : {2e-4, 1e-3, 1e-2, 1.0}) {
    Machine machine{.one = one, .all = one / 1.7};
    while (machine.trials == 0) machine.step();
    EXPECT_LE(machine.time, 0.03 + 2 * one) << one;
    machine.run_for(200 * one + 1);
    EXPECT_TRUE(machine.uses_all()) << one;
    EXPECT_GT(machine.steps_with_all, 0.8 * machine.steps) << one;
  }
}

TEST(ThreadChoice, NeverTriesAllThreadsInVeryShortSteps) {
  Machine machine{.one = 5e-5, .all = 1e-5};
  machine.run_for(10);
  EXPECT_EQ(machine.steps_with_all, 0);
}

TEST(ThreadChoice, LosesLittleIfAllThreadsAreSlower) {
  for (const double slower : {1.05, 1.5, 10.0, 1000.0}) {
    for (const double one : {2e-4, 1e-3, 1e-2, 1.0}) {
      Machine machine{.one = one, .all = slower * one};
      machine.run_for(1 + 100 * one);
      EXPECT_GT(machine.trials, 0);
      EXPECT_LT(machine.time, 1.06 * machine.steps * one + 2 * one) << slower << ' ' << one;
    }
  }
}

TEST(ThreadChoice, RepeatsFailedTrialsLessAndLessOften) {
  Machine machine{.one = 1e-3, .all = 1e-2};
  machine.run_for(4);
  const int first = machine.trials;
  machine.run_for(4);
  const int second = machine.trials - first;
  EXPECT_GE(first, 4);
  EXPECT_LT(second, first / 2.0);
}

TEST(ThreadChoice, EndsATrialAtTheFirstMuchSlowerStep) {
  Machine machine{.one = 1e-3, .all = 1.0};
  while (machine.trials == 0) machine.step();
  EXPECT_EQ(machine.steps_with_all, 1);
  EXPECT_FALSE(machine.choice.all());
  EXPECT_LT(machine.time, 0.03) << "the rest of the step ran with one thread";
}

TEST(ThreadChoice, ReturnsToOneThreadWhenTheMachineBecomesBusy) {
  Machine machine{.one = 1e-3, .all = 6e-4};
  machine.run_for(5);
  machine.all = 5e-2;
  const double busy_from = machine.time;
  const int steps = machine.steps;
  machine.run_for(4);
  EXPECT_FALSE(machine.uses_all());
  EXPECT_LT(machine.time - busy_from, 1.1 * (machine.steps - steps) * machine.one);
}

TEST(ThreadChoice, UsesAllThreadsAgainWhenTheMachineIsIdleAgain) {
  Machine machine{.one = 1e-3, .all = 5e-2};
  machine.run_for(5);
  EXPECT_FALSE(machine.choice.all());
  machine.all = 6e-4;
  const int before = machine.steps_with_all;
  const int steps = machine.steps;
  machine.run_for(20);
  EXPECT_GT(machine.steps_with_all - before, 0.5 * (machine.steps - steps));
}

TEST(ThreadChoice, AdaptsToTheWorkOfAStep) {
  // The work grows by a factor of 100, and several threads become faster.
  Machine machine;
  for (int k = 0; k <= 200; ++k) {
    machine.one = 3e-4 * std::pow(100, k / 200.0);
    machine.all = machine.one / 1.9 + 3e-4;  // synchronisation
    machine.run_for(0.1);
  }
  EXPECT_TRUE(machine.uses_all());
  const double last = machine.one;
  for (int k = 0; k <= 200; ++k) {
    machine.one = last * std::pow(100, -k / 200.0);
    machine.all = machine.one / 1.9 + 3e-4;
    machine.run_for(0.1);
  }
  machine.run_for(5);
  EXPECT_FALSE(machine.uses_all());
}

TEST(ThreadChoice, ChoosesTheFasterNumberIfSomeStepsTakeLonger) {
  // Every twentieth step takes four times as long.
  for (const double slower : {1.3, 1 / 1.5}) {
    ThreadChoice choice;
    double best = 0;
    double taken = 0;
    for (int step = 0; step < 20000; ++step) {
      const double one = step % 20 == 0 ? 4e-3 : 1e-3;
      const double seconds = choice.all() ? slower * one : one;
      best += std::min(one, slower * one);
      taken += seconds;
      choice.add(seconds);
    }
    EXPECT_LT(taken, 1.06 * best) << slower;
  }
}

}  // namespace
}  // namespace silt::test::thread_choice_test
