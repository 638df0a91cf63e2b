// SPDX-License-Identifier: MIT
// Fields as named numbers, the columns of a table: x, y, z; velocity_x, velocity_y; radius.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace silt::detail {

/// Whether a value of the field is a number, an enumerator or a vector of at most three numbers.
template <Field F, int Dim, class Real>
inline constexpr bool has_numbers = [] {
  using Value = value_of<F, Dim, Real>;
  if constexpr (requires {
                  typename Value::Scalar;
                  Value::SizeAtCompileTime;
                }) {
    return Value::SizeAtCompileTime > 0 && Value::SizeAtCompileTime <= 3;
  } else {
    return std::is_arithmetic_v<Value> || std::is_enum_v<Value>;
  }
}();

/// Names of the numbers of a value.
template <Field F, int Dim, class Real>
  requires has_numbers<F, Dim, Real>
std::vector<std::string> number_names() {
  using Value = value_of<F, Dim, Real>;
  const std::string name(name_of<F>());
  if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
    return {name};
  } else {
    static constexpr const char* axes[] = {"x", "y", "z"};
    std::vector<std::string> names;
    for (int k = 0; k < Value::SizeAtCompileTime; ++k) {
      names.push_back(std::same_as<F, position_t> ? axes[k] : name + "_" + axes[k]);
    }
    return names;
  }
}

/// f(name, k, field) for each number k of all fields but those that every step computes.
template <class P, class F>
void for_each_number(const P& particles, F&& f) {
  particles.for_each_field([&]<class Tag>(auto, Tag field) {
    if constexpr (role_of<Tag>() != Role::derived &&
                  has_numbers<Tag, P::dimension, typename P::Real>) {
      const auto names = number_names<Tag, P::dimension, typename P::Real>();
      for (Index k = 0; k < names.size(); ++k) f(names[k], k, field);
    }
  });
}

/// Number k of a value.
template <class Value>
auto number_of(const Value& value, Index k) {
  if constexpr (std::is_enum_v<Value>) {
    return static_cast<std::underlying_type_t<Value>>(value);
  } else if constexpr (std::is_arithmetic_v<Value>) {
    return value;
  } else {
    return value[static_cast<Eigen::Index>(k)];
  }
}

template <class Value>
void set_number(Value& value, Index k, double number) {
  if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
    value = static_cast<Value>(number);
  } else {
    value[static_cast<Eigen::Index>(k)] = static_cast<typename Value::Scalar>(number);
  }
}

/// Whether the type can represent the number.
template <class Value>
bool holds_number(double number) {
  if constexpr (std::integral<Value>) {
    const double lowest = double(std::numeric_limits<Value>::lowest());
    const double highest = double(std::numeric_limits<Value>::max());
    return lowest <= number && number <= highest && double(static_cast<Value>(number)) == number;
  } else if constexpr (std::is_enum_v<Value>) {
    return holds_number<std::underlying_type_t<Value>>(number);
  } else {
    return true;
  }
}

}  // namespace silt::detail
