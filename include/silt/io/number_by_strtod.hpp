// SPDX-License-Identifier: MIT
// std::from_chars of double for standard libraries without it, such as libc++ before version 20.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

// POSIX, not standard C: strtod_l and newlocale.
#include <locale.h>
#include <stdlib.h>
#if __has_include(<xlocale.h>)
#include <xlocale.h>
#endif

namespace silt::file::detail {

// Whether a text is a decimal number that std::from_chars accepts; strtod accepts more, such as
// spaces and 0x10.
struct Decimal {
  bool is_valid = false;
  bool is_zero = true;  // all digits are 0
};
inline Decimal parse_decimal(std::string_view text) {
  const auto skip_digits = [&](bool& is_zero) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
    is_zero &= std::all_of(text.begin(), end, [](char c) { return c == '0'; });
    const auto count = static_cast<std::size_t>(end - text.begin());
    text.remove_prefix(count);
    return count;
  };
  Decimal decimal;
  if (text.starts_with('-')) text.remove_prefix(1);
  auto digits = skip_digits(decimal.is_zero);
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    digits += skip_digits(decimal.is_zero);
  }
  if (digits == 0) return decimal;
  if (text.starts_with('e') || text.starts_with('E')) {
    text.remove_prefix(1);
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    bool ignored = true;
    if (skip_digits(ignored) == 0) return decimal;
  }
  decimal.is_valid = text.empty();
  return decimal;
}

/// Converts a text to a number, as std::from_chars of double does. None if the whole text is not a
/// number, or the number is out of range.
inline std::optional<double> number_by_strtod(std::string_view text) {
  std::string_view word = text;
  const double sign = word.starts_with('-') ? -1 : 1;
  if (sign < 0) word.remove_prefix(1);
  std::string lower(word);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (lower == "inf" || lower == "infinity") return sign * std::numeric_limits<double>::infinity();
  if (lower == "nan") return std::copysign(std::numeric_limits<double>::quiet_NaN(), sign);

  const Decimal decimal = parse_decimal(text);
  if (!decimal.is_valid) return std::nullopt;
  static const locale_t without_locale = newlocale(LC_ALL_MASK, "C", locale_t{});
  const double value = strtod_l(std::string(text).c_str(), nullptr, without_locale);
  const bool is_out_of_range = std::isinf(value) || (value == 0 && !decimal.is_zero);
  if (is_out_of_range) return std::nullopt;
  return value;
}

}  // namespace silt::file::detail
