// SPDX-License-Identifier: MIT
// The processes of a test that mpirun starts, with any number of them.
#pragma once

#include <silt/mpi/world.hpp>

#include <gtest/gtest.h>

namespace silt::test {

inline const mpi::World* world = nullptr;

/// For main(): fails in all processes if a test fails in one.
inline int run_tests(int argc, char** argv) {
  const mpi::World all;
  world = &all;
  testing::InitGoogleTest(&argc, argv);
  if (!all.is_first()) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
  }
  const int failed = RUN_ALL_TESTS();
  return int(all.max(double(failed)));
}

}  // namespace silt::test

int main(int argc, char** argv) { return silt::test::run_tests(argc, argv); }
