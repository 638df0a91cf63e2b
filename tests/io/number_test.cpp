// SPDX-License-Identifier: MIT
// Conversion of text to numbers by std::from_chars, and by its replacement where it is missing.
#include <silt/io/file.hpp>
#include <silt/io/number_by_strtod.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <optional>
#include <random>
#include <string>

namespace silt::test::number_test {
namespace {

std::optional<std::uint64_t> bits(std::optional<double> value) {
  if (!value) return std::nullopt;
  return std::bit_cast<std::uint64_t>(*value);
}

TEST(Number, IsReadBackExactly) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 10000; ++trial) {
    const auto value = std::bit_cast<double>(random());
    if (value != value) continue;
    const std::string text = file::digits(value);
    EXPECT_EQ(bits(file::number(text)), bits(value)) << text;
    EXPECT_EQ(bits(file::detail::number_by_strtod(text)), bits(value)) << text;
  }
}

TEST(Number, IsReadByStrtodAsByFromChars) {
  for (const char* const text :
       {"", "1", "-", "+", "-+1", "1.", ".5", ".", "-.5", "00012", "1e5", "1E5", "1e", "1e+", "1e-5",
        "e5", "0x10", "0x1p3", " 1", "1 ", "1,5", "1..2", "1f", "--1", "inf", "-inf", "INF",
        "infinity", "infinit", "nan", "-nan", "1e400", "-1e400", "1e-400", "0e999", "-0", "4.9e-324",
        "2e-324", "2.5e-324", "1e-310", "1.7976931348623157e308", "1.7976931348623159e308"}) {
    EXPECT_EQ(bits(file::detail::number_by_strtod(text)), bits(file::number(text))) << text;
  }
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 10000; ++trial) {
    std::string text;
    for (auto length = random() % 8; length > 0; --length) text += "0123456789.eE-"[random() % 14];
    EXPECT_EQ(bits(file::detail::number_by_strtod(text)), bits(file::number(text))) << text;
  }
}

}  // namespace
}  // namespace silt::test::number_test
