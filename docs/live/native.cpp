// SPDX-License-Identifier: MIT
// The scenes of the live page, natively. Prints of each its name, the hash of its state at the end
// of its program, and the mean processor time of a step [ms].
#include "scenes.hpp"

#include <cstdio>
#include <ctime>

int main() try {
  for (silt::Index k = 0; k < live::names.size(); ++k) {
    const auto scene = live::make_scene(k, live::defaults[k]);
    const std::clock_t begin = std::clock();
    const int steps = scene->step_until(live::ends[k], 1 << 30);
    const double seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
    std::printf("%s %016llx %.5f\n", live::names[k],
                static_cast<unsigned long long>(scene->hash()), 1000 * seconds / steps);
  }
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
