// SPDX-License-Identifier: MIT
// The windows of the entries of a row, see window_rows.hpp. Which entries share a window cannot be
// predicted: without branches. With AVX-512, sixteen entries at a time; find_windows_one_by_one()
// defines the result.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_LINEAR_ROW_WINDOWS
#define SILT_LINEAR_ROW_WINDOWS

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace silt::detail {

/// The entries of a row.
struct RowEntries {
  /// So many columns and values can be read before them and after them.
  static constexpr Index margin = 16;

  const std::uint32_t* column;
  const float* value;
  Index count;
  Index last_window;  ///< no window begins behind this column
  std::uint32_t first_column;
};

/// Where they are written: memory for as many windows as there are entries, and RowEntries::margin more.
struct RowWindows {
  std::uint32_t* column;  ///< minus first_column, modulo 2^32
  float* value;           ///< two of each window
};

/// Sets the windows, sets bits of `offsets` from the 16th on if a column is not that close to
/// first_column, and returns the number of windows.
using FindRowWindows = Index(const RowEntries& entries, const RowWindows& to,
                             std::uint32_t& offsets);

inline Index find_windows_one_by_one(const RowEntries& entries, const RowWindows& to,
                                     std::uint32_t& offsets) {
  Index windows = 0;
  Index previous = std::numeric_limits<Index>::max() / 2;  // column
  Index second = 0;                                        // it is that of its window
  for (Index k = 0; k < entries.count; ++k) {
    const Index column = entries.column[k];
    const Index ahead = column - previous;
    if (ahead + second <= second) [[unlikely]] {  // in columns that have been added
      to.value[2 * (windows - 1) + ahead + second] += entries.value[k];
      continue;
    }
    previous = column;
    const Index continues = Index(ahead == 1) & (second ^ 1);
    second = continues | Index(column > entries.last_window);
    const auto offset = static_cast<std::uint32_t>(column - second) - entries.first_column;
    offsets |= offset;
    std::fill_n(to.value + 2 * windows, 2, 0.0f);
    windows += continues ^ 1;
    to.column[windows - 1] = offset;
    to.value[2 * (windows - 1) + second] = entries.value[k];
  }
  return windows;
}

}  // namespace silt::detail

#define SILT_KERNELS <silt/linear/row_windows.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::detail {

inline FindRowWindows* find_row_windows() { return SILT_FOR_PROCESSOR(find_row_windows); }

}  // namespace silt::detail

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {

#if SILT_LEVEL == 3
inline Index find_row_windows(const RowEntries& entries, const RowWindows& to,
                              std::uint32_t& offsets) {
  constexpr Index lanes = RowEntries::margin;
  constexpr Index most = 64;
  if (entries.count > most) return find_windows_one_by_one(entries, to, offsets);
  const __m512i one = _mm512_set1_epi32(1);
  const __m512i last_window = _mm512_set1_epi32(static_cast<int>(entries.last_window));
  // One bit for each entry, compared with the one before it.
  std::uint64_t is_ahead = 0;
  std::uint64_t is_back = 0;
  std::uint32_t is_special = 0;
  for (Index k = 0; k < entries.count; k += lanes) {
    const auto valid = static_cast<__mmask16>((1u << std::min(lanes, entries.count - k)) - 1);
    const __m512i column = _mm512_loadu_si512(entries.column + k);
    const __m512i before = _mm512_loadu_si512(entries.column + k - 1);
    const auto after_first = static_cast<__mmask16>(k == 0 ? valid & 0xfffe : valid);
    is_ahead |= std::uint64_t{_mm512_mask_cmpeq_epi32_mask(after_first, column,
                                                           _mm512_add_epi32(before, one))}
                << k;
    is_back |= std::uint64_t{_mm512_mask_cmpeq_epi32_mask(after_first, before,
                                                          _mm512_add_epi32(column, one))}
               << k;
    is_special |= _mm512_mask_cmpeq_epi32_mask(after_first, column, before);
    is_special |= _mm512_mask_cmpgt_epu32_mask(valid, column, last_window);
  }
  // Every second bit of each run of bits, from its first one on. A sum clears the runs that begin
  // at an even bit.
  constexpr std::uint64_t even = 0x5555555555555555;
  const std::uint64_t run = is_ahead & ~(is_ahead << 1);
  const std::uint64_t of_even = is_ahead & ~(is_ahead + (run & even));
  const std::uint64_t is_second = (of_even & even) | (is_ahead & ~of_even & ~even);
  if ((is_special | (is_back & (is_second << 1))) != 0) [[unlikely]] {
    return find_windows_one_by_one(entries, to, offsets);
  }
  const __m512i first_half =
      _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i second_half = _mm512_add_epi32(first_half, _mm512_set1_epi32(8));
  const __m512i first_column = _mm512_set1_epi32(static_cast<int>(entries.first_column));
  const __m512i near = _mm512_set1_epi32(0xffff);
  Index windows = 0;
  for (Index k = 0; k < entries.count; k += lanes) {
    const auto valid = static_cast<__mmask16>((1u << std::min(lanes, entries.count - k)) - 1);
    const auto begins = static_cast<__mmask16>(valid & ~(is_second >> k));
    // The bit of the entry after the last lane is that of lane 0 of the next register.
    const auto has_second = static_cast<__mmask16>(is_second >> (k + 1));
    const __m512i offset = _mm512_sub_epi32(_mm512_loadu_si512(entries.column + k), first_column);
    offsets |= std::uint32_t{_mm512_mask_cmpgt_epu32_mask(begins, offset, near)} << 16;
    const __m512i value = _mm512_loadu_si512(entries.value + k);
    const __m512i second = _mm512_maskz_loadu_epi32(has_second, entries.value + k + 1);
    const __m512i low = _mm512_permutex2var_epi32(value, first_half, second);
    const __m512i high = _mm512_permutex2var_epi32(value, second_half, second);
    const auto low_begins = static_cast<__mmask8>(begins);
    const auto high_begins = static_cast<__mmask8>(begins >> 8);
    _mm512_storeu_si512(to.column + windows, _mm512_maskz_compress_epi32(begins, offset));
    _mm512_storeu_si512(to.value + 2 * windows, _mm512_maskz_compress_epi64(low_begins, low));
    windows += static_cast<Index>(__builtin_popcount(low_begins));
    _mm512_storeu_si512(to.value + 2 * windows, _mm512_maskz_compress_epi64(high_begins, high));
    windows += static_cast<Index>(__builtin_popcount(high_begins));
  }
  return windows;
}
#else
inline Index find_row_windows(const RowEntries& entries, const RowWindows& to,
                              std::uint32_t& offsets) {
  return find_windows_one_by_one(entries, to, offsets);
}
#endif

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
