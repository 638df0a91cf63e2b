// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/grains.hpp"

#include <silt/io/stop_on_signal.hpp>

#include <gtest/gtest.h>

#include <csignal>

namespace silt::test::stop_on_signal_test {
namespace {

int received = 0;
void receive(int number) { received = number; }

struct Raise {
  int number;
  template <class Sim>
  void after_step(const Sim& simulation, const Run&) const {
    if (simulation.steps() == 3) std::raise(number);
  }
};

auto flying() {
  return Simulation{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, -1}},
                    Leapfrog{}};
}

TEST(StopOnSignal, EndsTheRunAfterTheStep) {
  for (const int number : {SIGINT, SIGTERM}) {
    auto simulation = flying();
    StopOnSignal stop;
    int outputs = 0;
    EXPECT_FALSE(simulation.run({.until = 1, .time_step = 0.125}, Raise{number}, stop,
                                [&](const auto&) { ++outputs; }));
    EXPECT_EQ(simulation.steps(), 3u);
    EXPECT_EQ(outputs, 1) << "no output where it was stopped";
    EXPECT_EQ(stop.signal_number(), number);
  }
}

TEST(StopOnSignal, RestoresThePreviousHandlers) {
  std::signal(SIGINT, &receive);
  std::signal(SIGTERM, SIG_IGN);
  {
    StopOnSignal stop;
    EXPECT_FALSE(stop.stop_requested());
    std::raise(SIGTERM);
    EXPECT_FALSE(stop.stop_requested()) << "ignored signals remain ignored";
    std::raise(SIGINT);
    EXPECT_TRUE(stop.stop_requested());
    EXPECT_EQ(received, 0);
    std::raise(SIGTERM);  // ignored also after the first signal
    EXPECT_EQ(stop.signal_number(), SIGINT);
  }
  std::raise(SIGINT);
  EXPECT_EQ(received, SIGINT);
  EXPECT_EQ(std::signal(SIGTERM, SIG_DFL), SIG_IGN);
  std::signal(SIGINT, SIG_DFL);
  StopOnSignal next;
  EXPECT_FALSE(next.stop_requested()) << "an earlier signal has no effect";
}

TEST(StopOnSignal, RejectsASecondObject) {
  StopOnSignal stop;
  EXPECT_TRUE(refuses([] { StopOnSignal(); }, {"StopOnSignal", "another StopOnSignal"}));
}

TEST(StopOnSignalDeathTest, ASecondSignalKillsTheProcess) {
  const auto twice = [] {
    StopOnSignal stop;
    std::raise(SIGINT);
    std::raise(SIGINT);
  };
  EXPECT_EXIT(twice(), testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace silt::test::stop_on_signal_test
