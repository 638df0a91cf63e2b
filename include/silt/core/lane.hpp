// SPDX-License-Identifier: MIT
// One lane of a loop that the compiler turns into vector instructions.
//
// A law is written for one contact. Run over eight contacts that lie beside one another, a compiler makes
// of it the code for eight at once, `if`s included, unless it meets vector instructions that were
// written by hand. Eigen writes such for a vector of three doubles, but for no scalar type that it does
// not know: a Lane<double> is a double by another name.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <Eigen/Core>

#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>

namespace silt {

template <std::floating_point Real>
class Lane {
 public:
  Lane() = default;
  constexpr Lane(const Lane& b) : value_(b.value_) {}
  constexpr Lane& operator=(const Lane& b) { value_ = b.value_; return *this; }
  template <class T>
    requires std::is_arithmetic_v<T>
  constexpr Lane(T value) : value_(static_cast<Real>(value)) {}
  constexpr operator Real() const { return value_; }

  constexpr Lane& operator+=(Lane b) { return *this = *this + b; }
  constexpr Lane& operator-=(Lane b) { return *this = *this - b; }
  constexpr Lane& operator*=(Lane b) { return *this = *this * b; }
  constexpr Lane& operator/=(Lane b) { return *this = *this / b; }

  friend constexpr Lane operator-(Lane a) { return -a.value_; }
  friend constexpr Lane operator+(Lane a, Lane b) { return a.value_ + b.value_; }
  friend constexpr Lane operator-(Lane a, Lane b) { return a.value_ - b.value_; }
  friend constexpr Lane operator*(Lane a, Lane b) { return a.value_ * b.value_; }
  friend constexpr Lane operator/(Lane a, Lane b) { return a.value_ / b.value_; }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator+(Lane a, T b) { return a + Lane(b); }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator-(Lane a, T b) { return a - Lane(b); }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator*(Lane a, T b) { return a * Lane(b); }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator/(Lane a, T b) { return a / Lane(b); }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator+(T a, Lane b) { return Lane(a) + b; }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator-(T a, Lane b) { return Lane(a) - b; }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator*(T a, Lane b) { return Lane(a) * b; }
  template <class T>
    requires std::is_arithmetic_v<T>
  friend constexpr Lane operator/(T a, Lane b) { return Lane(a) / b; }

 private:
  Real value_;
};

}  // namespace silt

template <class Number>
struct Eigen::NumTraits<silt::Lane<Number>> : Eigen::NumTraits<Number> {
  using Real = silt::Lane<Number>;
  using NonInteger = Real;
  using Literal = Real;
  using Nested = Real;
};
