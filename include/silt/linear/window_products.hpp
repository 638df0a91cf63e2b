// SPDX-License-Identifier: MIT
// Products of the rows of a matrix in windows with a vector, see window_rows.hpp.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_LINEAR_WINDOW_PRODUCTS
#define SILT_LINEAR_WINDOW_PRODUCTS

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <cstdint>

namespace silt::detail {

/// Groups of four rows with the same number of windows.
struct EqualRows {
  std::uint32_t groups;
  std::uint32_t windows;  ///< of each row
};

/// Rows in groups of four, whose windows alternate: one of each row.
template <class Column>
struct GroupedWindows {
  const EqualRows* equal;  ///< groups one after the other
  Index equals;
  const std::uint8_t* row;  ///< number of each row
  const Column* column;     ///< of each window, minus `first_column`
  const float* value;
  Index first_column;
  // What is read after these rows.
  const Column* next_column;
  const float* next_value;
};

/// product[k] = Σ_j a_kj x_j for each row k.
template <class Column>
using MultiplyWindows = void(const GroupedWindows<Column>& windows, const double* x,
                             double* product);

}  // namespace silt::detail

#define SILT_KERNELS <silt/linear/window_products.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::detail {

template <class Column>
MultiplyWindows<Column>* multiply_windows() {
  return SILT_FOR_PROCESSOR(multiply_windows<Column>);
}

}  // namespace silt::detail

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// Four sums of products, each in two lanes.
class FourSums {
 public:
  /// Adds a[2 k] x[0] and a[2 k + 1] x[1], with x = x_k, to sum k.
  void add(const float* a, const double* x_0, const double* x_1, const double* x_2,
           const double* x_3) {
#if SILT_LEVEL == 3
    // These masked loads need no shuffle.
    __m512d x = _mm512_castpd128_pd512(_mm_loadu_pd(x_0));
    x = _mm512_mask_broadcast_f64x2(x, 0x0c, _mm_loadu_pd(x_1));
    x = _mm512_mask_broadcast_f64x2(x, 0x30, _mm_loadu_pd(x_2));
    x = _mm512_mask_broadcast_f64x2(x, 0xc0, _mm_loadu_pd(x_3));
    // With a mask that takes all: without, g++ 12 warns of what it leaves undefined.
    const __m512d factors = _mm512_maskz_cvtps_pd(0xff, _mm256_loadu_ps(a));
    sums_[0] += (simd::Pack<double, 8>)factors * (simd::Pack<double, 8>)x;
#elif SILT_LEVEL == 2
    add_two(a, x_0, x_1, sums_[0]);
    add_two(a + 4, x_2, x_3, sums_[1]);
#else
    add_one(a, x_0, sums_[0]);
    add_one(a + 2, x_1, sums_[1]);
    add_one(a + 4, x_2, sums_[2]);
    add_one(a + 6, x_3, sums_[3]);
#endif
  }
  /// The four sums.
  void store(double* to) const {
    double lanes_of[8];
    for (int k = 0; k < 8 / simd::lanes<double>; ++k) {
      simd::store<double>(lanes_of + k * simd::lanes<double>, sums_[k]);
    }
    for (int k = 0; k < 4; ++k) to[k] = lanes_of[2 * k] + lanes_of[2 * k + 1];
  }

 private:
#if SILT_LEVEL == 2
  static void add_two(const float* a, const double* x, const double* y,
                      simd::Pack<double, 4>& sum) {
    const __m256d both =
        _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(x)), _mm_loadu_pd(y), 1);
    sum += (simd::Pack<double, 4>)_mm256_cvtps_pd(_mm_loadu_ps(a)) * (simd::Pack<double, 4>)both;
  }
#else
  static void add_one(const float* a, const double* x, simd::Pack<double, 2>& sum) {
    sum += simd::Pack<double, 2>{double(a[0]), double(a[1])} * simd::load<double, 2>(x);
  }
#endif
  simd::Pack<double> sums_[8 / simd::lanes<double>]{};
};

template <class Column>
void multiply_windows(const GroupedWindows<Column>& windows, const double* x, double* product) {
  constexpr Index line = 64;  // of the cache [bytes]
  const double* const from = x + windows.first_column;
  const std::uint8_t* row = windows.row;
  const Column* column = windows.column;
  const float* value = windows.value;
  // As integers, because what is prefetched may be beyond the end of the array.
  auto next_column = reinterpret_cast<std::uintptr_t>(windows.next_column);
  auto next_value = reinterpret_cast<std::uintptr_t>(windows.next_value);
  const auto prefetch = [](std::uintptr_t& at, Index bytes) {
    for (Index k = 0; k < bytes; k += line) {
      __builtin_prefetch(reinterpret_cast<const void*>(at + k));
    }
    at += bytes;
  };
  for (Index equal = 0; equal < windows.equals; ++equal) {
    const Index count = windows.equal[equal].windows;
    for (Index group = 0; group < windows.equal[equal].groups; ++group) {
      // Rows are read once, in order; the hardware prefetcher detects this too late.
      prefetch(next_value, 8 * count * sizeof(float));
      prefetch(next_column, 4 * count * sizeof(Column));
      FourSums sums;
      for (Index window = 0; window < count; ++window) {
        sums.add(value, from + column[0], from + column[1], from + column[2], from + column[3]);
        value += 8;
        column += 4;
      }
      double of_row[4];
      sums.store(of_row);
      for (Index k = 0; k < 4; ++k) product[row[k]] = of_row[k];
      row += 4;
    }
  }
}

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
