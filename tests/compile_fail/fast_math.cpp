// expect: silt: compiled with -ffast-math
// flags: -O1 -ffast-math -Wfatal-errors
// flags: -O2 -ffast-math -Wfatal-errors
// flags: -O3 -ffast-math -Wfatal-errors
// flags: -O2 -ffinite-math-only -Wfatal-errors
// flags: -Ofast -Wfatal-errors
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

int main() {}
