// SPDX-License-Identifier: MIT
// sin and cos of the page and of the programs that its test compares with it. C libraries differ in
// their last bits, glibc even between processors, and the vibrating floor moves by them; what chaos
// makes of such a bit would hide any other difference. Errors are below 1e-15.

namespace {

struct Reduced {
  double r;      // x minus a multiple of π/2, within π/4
  int quarters;  // that multiple, modulo 4
};

// π/2 is the sum of three numbers; products of the first two with quarters below 2²⁰ are exact.
Reduced reduce(double x) {
  const double quarters = __builtin_nearbyint(x * 0.63661977236758134308);
  constexpr double half_pi[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
  const double r = ((x - quarters * half_pi[0]) - quarters * half_pi[1]) - quarters * half_pi[2];
  return {r, int(static_cast<long long>(quarters) & 3)};
}

// The Taylor series of the sine from r and of the cosine from 1, in the form of Horner.
double series(double r, int first, int last) {
  const double square = r * r;
  double sum = 1;
  for (int n = last; n > first; n -= 2) sum = 1 - sum * square / (double(n) * (n - 1));
  return first == 1 ? r * sum : sum;
}

double sine(double x, int ahead) {
  const auto [r, quarters] = reduce(x);
  const int turned = (quarters + ahead) & 3;
  const double value = turned % 2 == 0 ? series(r, 1, 19) : series(r, 0, 18);
  return turned < 2 ? value : -value;
}

}  // namespace

extern "C" {
double sin(double x) noexcept { return sine(x, 0); }
double cos(double x) noexcept { return sine(x, 1); }
// What g++ makes of both.
void sincos(double x, double* s, double* c) noexcept {
  *s = sine(x, 0);
  *c = sine(x, 1);
}
}
