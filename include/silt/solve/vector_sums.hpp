// SPDX-License-Identifier: MIT
// Sums and updates of vectors in the conjugate gradient method.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_SOLVE_VECTOR_SUMS
#define SILT_SOLVE_VECTOR_SUMS

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#define SILT_KERNELS <silt/solve/vector_sums.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::detail {

/// Σ a b over n elements.
inline auto* dot_product() { return SILT_FOR_PROCESSOR(dot_product); }
/// a += scale b; returns Σ a².
inline auto* add_and_square() { return SILT_FOR_PROCESSOR(add_and_square); }
/// x += α p, then p = z + β p.
inline auto* step_and_turn() { return SILT_FOR_PROCESSOR(step_and_turn); }

}  // namespace silt::detail

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

// Eight independent partial sums, for any width of registers, so that additions can overlap in time.
// Written in packs, because g++ would keep an array in memory.
class EightSums {
 public:
  static constexpr Index size = 8;

  // Adds the products of eight numbers.
  void add(const double* a, const double* b) {
    for (Index k = 0; k < size; k += lanes) {
      packs_[k / lanes] += simd::load<double>(a + k) * simd::load<double>(b + k);
    }
  }
  // With those of fewer, which have been summed.
  double total(double rest) const {
    double sum[size];
    for (Index k = 0; k < size; k += lanes) simd::store<double>(sum + k, packs_[k / lanes]);
    sum[0] += rest;
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
  }

 private:
  static constexpr Index lanes = simd::lanes<double>;
  simd::Pack<double> packs_[size / lanes]{};
};

inline double dot_product(const double* a, const double* b, Index n) {
  EightSums sums;
  Index i = 0;
  for (; i + EightSums::size <= n; i += EightSums::size) sums.add(a + i, b + i);
  double rest = 0;
  for (; i < n; ++i) rest += a[i] * b[i];
  return sums.total(rest);
}

inline double add_and_square(double* a, double scale, const double* b, Index n) {
  constexpr Index lanes = simd::lanes<double>;
  EightSums sums;
  Index i = 0;
  for (; i + EightSums::size <= n; i += EightSums::size) {
    for (Index k = i; k < i + EightSums::size; k += lanes) {
      simd::store<double>(a + k, simd::load<double>(a + k) + scale * simd::load<double>(b + k));
    }
    sums.add(a + i, a + i);
  }
  double rest = 0;
  for (; i < n; ++i) {
    a[i] += scale * b[i];
    rest += a[i] * a[i];
  }
  return sums.total(rest);
}

inline void step_and_turn(double* x, double alpha, double* p, const double* z, double beta,
                          Index n) {
  constexpr Index lanes = simd::lanes<double>;
  Index i = 0;
  for (; i + lanes <= n; i += lanes) {
    const simd::Pack<double> before = simd::load<double>(p + i);
    simd::store<double>(x + i, simd::load<double>(x + i) + alpha * before);
    simd::store<double>(p + i, simd::load<double>(z + i) + beta * before);
  }
  for (; i < n; ++i) {
    x[i] += alpha * p[i];
    p[i] = z[i] + beta * p[i];
  }
}

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
