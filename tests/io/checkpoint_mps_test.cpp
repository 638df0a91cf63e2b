// SPDX-License-Identifier: MIT
// A flow goes on from a checkpoint as grains do: what it goes on from is in its columns.
#include "support/check.hpp"
#include "support/file_test.hpp"

#include <silt/io/checkpoint.hpp>
#include <silt/mps.hpp>

#include <gtest/gtest.h>

namespace silt::test {
namespace {

using CheckpointOfAFlow = FileTest;

TEST_F(CheckpointOfAFlow, GoesOnBitByBit) {
  const auto tank = mps::make_tank<2>(
      {.column = {0.1, 0.2}, .size = {.length = 0.2, .height = 0.25}, .spacing = 0.01});
  const mps::Flow<mps::Case10> water{{.spacing = 0.01, .speed_scale = 1}};
  const auto make = [&] { return Simulation{tank, UniformGrid<2>{}, water, SemiImplicit<>{}}; };
  auto whole = make();
  for (int k = 0; k < 30; ++k) whole.step();
  write_checkpoint(path, whole);
  auto part = make();
  read_checkpoint(path, part);
  EXPECT_EQ(part.time(), whole.time());
  EXPECT_EQ(state_of(part.particles()), state_of(whole.particles()));
  for (int k = 0; k < 30; ++k) {
    whole.step();
    part.step();
    ASSERT_EQ(state_of(part.particles()), state_of(whole.particles())) << "step " << k;
  }
}

}  // namespace
}  // namespace silt::test
