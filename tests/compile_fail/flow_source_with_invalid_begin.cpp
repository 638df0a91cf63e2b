// expect: mps: begin\(\) of the source cannot be called with a const StepView
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

struct Source : mps::DivergenceSource {
#ifdef SILT_VALID
  void begin(const auto&) {}
#else
  void begin(auto&, double) {}
#endif
};
struct Scheme : mps::Case10 {
  Source source{};
};

int main() {
  Simulation sim{mps::Fluid<2>{}, UniformGrid<2>{}, mps::Flow<Scheme>({.spacing = 0.01}),
                 SemiImplicit<>{}};
  sim.step();
}
