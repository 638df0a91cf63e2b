// SPDX-License-Identifier: MIT
// Prints whether the library was compiled with OpenMP.
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <cstdio>

int main() {
  std::puts(
#ifdef _OPENMP
      "OpenMP"
#else
      "one thread"
#endif
  );
  const silt::Vec<2, double> x{3, 4};
  return x.norm() == 5 && silt::threads() >= 1 ? 0 : 1;
}
