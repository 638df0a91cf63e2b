// SPDX-License-Identifier: MIT
#if __has_include(<silt/silt.hpp>)
#include <silt/silt.hpp>
#else
#include <silt/core/types.hpp>
#endif

int main() {
  const silt::Vec<2, double> x{3, 4};
  return x.norm() == 5 ? 0 : 1;
}
