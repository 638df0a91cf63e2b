// SPDX-License-Identifier: MIT
// Grains that are stopped at random steps, and go on with another number of threads, have the bits
// of those that were not stopped. restart_slow_test.cpp has the other searches and laws.
#include "support/file_test.hpp"
#include "support/restarted_grains.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace silt::test {
namespace {

using RestartOfGrains = FileTest;

TEST_F(RestartOfGrains, KeepsTheBitsOfAllThatHasState) {
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.6,
                               .friction_angle = 0.5};
  // Few grains are never sorted; of many, several threads make the contacts.
  for (const auto& along : {std::vector<Index>{24, 20}, {40, 28}}) {
    const RestartedGrains<2> bed(along);
    expect_the_same_bits_after_restarts(
        path, {.steps = 100, .number = 15},
        [&] { return bed.make(law, NeighbourList<2>{}); },
        [&](const auto& run) { return bed.measured(run); });
  }
}

}  // namespace
}  // namespace silt::test
