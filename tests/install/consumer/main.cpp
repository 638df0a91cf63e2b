// SPDX-License-Identifier: MIT
// Prints whether the library was compiled with OpenMP.
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/version.hpp>

#include <cstdio>

#ifdef VERSION_FOUND
static_assert(SILT_VERSION == VERSION_FOUND, "the package has another version than its headers");
#endif

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
