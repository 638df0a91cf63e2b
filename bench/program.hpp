// SPDX-License-Identifier: MIT
// The main function of a benchmark. It also records the compiler and its flags.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

namespace bench {

inline int run(int argc, char** argv) {
#ifdef __clang__
  benchmark::AddCustomContext("compiler", __VERSION__);
#else
  benchmark::AddCustomContext("compiler", std::string("GCC ") + __VERSION__);
#endif
#ifdef SILT_BENCH_FLAGS
  benchmark::AddCustomContext("flags", SILT_BENCH_FLAGS);
#endif
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace bench
