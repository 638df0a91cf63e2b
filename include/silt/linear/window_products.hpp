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
      simd::FourSums sums;
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
