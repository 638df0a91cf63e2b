// SPDX-License-Identifier: MIT
// The processes of a test that mpirun starts, with any number of them.
#pragma once

#include <silt/mpi/world.hpp>

#include <gtest/gtest.h>

#include <cstdio>

namespace silt::test {

inline const mpi::World* world = nullptr;

/// Shows the failures of a process that is not the first, and nothing else.
class FailuresOfOthers : public testing::EmptyTestEventListener {
 private:
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    std::fprintf(stderr, "process %d: %s:%d: %s\n", world->rank(),
                 result.file_name() == nullptr ? "" : result.file_name(), result.line_number(),
                 result.message());
  }
};

/// For main(): fails in all processes if a test fails in one.
inline int run_tests(int argc, char** argv) {
  const mpi::World all;
  world = &all;
  testing::InitGoogleTest(&argc, argv);
  if (!all.is_first()) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailuresOfOthers);
  }
  const int failed = RUN_ALL_TESTS();
  return int(all.max(double(failed)));
}

}  // namespace silt::test

int main(int argc, char** argv) { return silt::test::run_tests(argc, argv); }
