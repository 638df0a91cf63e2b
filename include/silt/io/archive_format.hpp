// SPDX-License-Identifier: MIT
// The format of checkpoints: types of values, and the checksum.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace silt::checkpoint {

/// First bytes of a checkpoint. The number is that of the format.
inline constexpr std::string_view magic = "silt checkpoint 1\n";
/// Is read as another number where the order of bytes differs.
inline constexpr std::uint32_t byte_order = 0x01020304;

/// Type of one value.
struct Item {
  char kind;              ///< f, i, u: floating-point, signed, unsigned numbers; x: opaque bytes
  std::uint32_t width;    ///< bytes per number
  std::uint32_t numbers;  ///< numbers per value

  bool operator==(const Item&) const = default;

  /// For messages: "3 floating-point numbers of 8 bytes".
  std::string text() const {
    const std::string names = kind == 'f'   ? "floating-point numbers"
                              : kind == 'x' ? "blocks"
                                            : "integers";
    return std::to_string(numbers) + " " + names + " of " + std::to_string(width) + " bytes";
  }
};

/// The type of the numbers of a value: of a vector, array or number.
template <class T>
struct NumberOf {
  using type = T;
};
template <class T>
  requires requires { typename T::Scalar; }
struct NumberOf<T> {
  using type = typename T::Scalar;
};
template <class T, std::size_t n>
struct NumberOf<std::array<T, n>> : NumberOf<T> {};

/// Why a number of this type cannot be these bytes; empty if it can. An enum is
/// checked if there is is_enumerator(value).
template <class T>
std::string fault_of(const char* bytes, bool must_be_finite) {
  if constexpr (std::same_as<T, bool>) {
    // A bool with other bits would be undefined behaviour.
    const auto value = static_cast<unsigned char>(*bytes);
    if (value > 1) return std::to_string(value) + ", which is neither 0 nor 1";
  } else if constexpr (std::floating_point<T>) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    if (must_be_finite && !is_finite(value)) {
      return to_text(double(value)) + ", which is not finite";
    }
  } else if constexpr (requires(T each) { is_enumerator(each); }) {
    std::underlying_type_t<T> value;
    std::memcpy(&value, bytes, sizeof value);
    if (!is_enumerator(static_cast<T>(value))) {
      return std::to_string(value) + ", which is none of its values";
    }
  }
  return {};
}

/// How a value of type T is stored: a number, an enum, or a vector or array of numbers.
template <class T>
constexpr Item item_of() {
  if constexpr (std::is_enum_v<T>) {
    return item_of<std::underlying_type_t<T>>();
  } else if constexpr (std::floating_point<T>) {
    return {'f', sizeof(T), 1};
  } else if constexpr (std::integral<T>) {
    return {std::is_signed_v<T> ? 'i' : 'u', sizeof(T), 1};
  } else if constexpr (requires {
                         typename T::Scalar;
                         T::SizeAtCompileTime;
                       }) {
    const Item item = item_of<typename T::Scalar>();
    return {item.kind, item.width, static_cast<std::uint32_t>(T::SizeAtCompileTime)};
  } else if constexpr (requires { std::tuple_size<T>::value; }) {
    const Item item = item_of<typename T::value_type>();
    return {item.kind, item.width, item.numbers * static_cast<std::uint32_t>(std::tuple_size_v<T>)};
  } else {
    return {'x', sizeof(T), 1};
  }
}

/// FNV-1a hash (Fowler, Noll, Vo) of words of eight bytes, then of the remaining bytes.
inline std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&hash](std::uint64_t word) { hash = (hash ^ word) * 0x100000001b3u; };
  for (; bytes.size() >= sizeof(std::uint64_t); bytes.remove_prefix(sizeof(std::uint64_t))) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data(), sizeof word);
    mix(word);
    hash ^= hash >> 32;
  }
  for (const char byte : bytes) mix(static_cast<unsigned char>(byte));
  return hash;
}

}  // namespace silt::checkpoint
