// expect: the scheme has no member `kernel` that is a kernel: it needs a weight\(q\) for float and double
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

struct Tent {
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
  using Weight = Tent;
#else
  using Weight = OnlyForDoubles;
#endif
  struct Scheme : mps::Case10 {
    Weight kernel{};
  };
  const mps::Flow<Scheme> flow({.spacing = 0.01});
}
