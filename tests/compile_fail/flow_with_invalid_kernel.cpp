// expect: the third argument is not a kernel: it needs a static weight\(q\) for float and double
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

struct Triangle {
  template <class Real>
  static Real weight(Real q) {
    return 1 - q;
  }
};
struct OnlyForDoubles {
  static double weight(double q) { return 1 - q; }
};

int main() {
#ifdef SILT_VALID
  using Weight = Triangle;
#else
  using Weight = OnlyForDoubles;
#endif
  using Scheme = mps::Scheme<mps::DivergenceSource, mps::AdoptedCollision, Weight,
                             mps::DensitySurface, mps::ConservingGradient>;
  const mps::Flow<Scheme> flow({.spacing = 0.01});
}
