// expect: mps: the scheme has a member that is none of source, collision, kernel, surface, gradient
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

struct Scheme : mps::Recommended {
#ifdef SILT_VALID
  mps::Collision collision{.distance = 0.8};
#else
  mps::Collision colision{.distance = 0.8};
#endif
};

int main() { const mps::Flow<Scheme> flow({.spacing = 0.01}); }
