// expect: silt: compiled with -ffast-math
// flags: -O1 -ffast-math
// flags: -O2 -ffast-math
// flags: -O3 -ffast-math
// flags: -O2 -ffinite-math-only
// flags: -Ofast
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

int main() {}
