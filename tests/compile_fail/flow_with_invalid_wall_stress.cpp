// expect: mps: the scheme has no member `wall_stress` that is a viscous stress of walls
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

struct Sticky {
  void check() const {}
#ifdef SILT_VALID
  template <class View>
  auto velocity_change(const View& at, double nu) const {
    return mps::NoSlip{}.velocity_change(at, nu);
  }
#endif
};
struct Scheme : mps::Recommended {
  Sticky wall_stress{};
};

int main() {
  const mps::Flow<Scheme> flow({.spacing = 0.01});
}
