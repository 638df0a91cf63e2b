// SPDX-License-Identifier: MIT
// A DEM run stopped at random steps and resumed with another number of threads is bitwise identical
// to an uninterrupted run. restart_slow_test.cpp covers the other searches and laws.
// Only with --all: random steps; checkpoint_test.cpp and resume_test.cpp resume at one.
#include "support/file_test.hpp"
#include "support/restarted_grains.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace silt::test::restart_grains_test {
namespace {

using RestartOfGrains = FileTest;

TEST_F(RestartOfGrains, KeepsTheBitsOfEveryComponentWithState) {
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.6,
                               .friction_angle = 0.5};
  // Few grains are never sorted; the contacts of many are found by several threads.
  for (const auto& along : {std::vector<Index>{24, 20}, {40, 28}}) {
    const RestartedGrains<2> bed(along);
    expect_the_same_bits_after_restarts(
        path, {.steps = 100, .number = 15},
        [&] { return bed.make(law, NeighbourList<2>{}); },
        [&](const auto& run) { return bed.measured(run); });
  }
}

}  // namespace
}  // namespace silt::test::restart_grains_test
