// SPDX-License-Identifier: MIT
// One lane of a loop that the compiler turns into vector instructions.
//
// A law is written for one contact. Run over eight contacts that lie beside one another, a compiler
// makes of it the code for eight at once, `if`s included, unless it meets vector instructions that
// were written by hand. Eigen writes such for a vector of three doubles, but for no scalar type
// that it does not know: a Lane<double> is a double by another name.
#pragma once

#include <silt/core/eigen.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>

// Stands before such a loop: g++ must be told that no lane reads what another
// writes; clang sees it.
#ifdef __clang__
#define SILT_EACH_LANE_ALONE
#else
#define SILT_EACH_LANE_ALONE _Pragma("GCC ivdep")
#endif

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

/// The same numbers in memory, to be read and written in such a loop.
template <std::floating_point Real>
auto* lanes_of(Real* values) {
  return reinterpret_cast<Lane<Real>*>(values);
}
template <std::floating_point Real>
auto* lanes_of(const Real* values) {
  return reinterpret_cast<const Lane<Real>*>(values);
}
template <std::floating_point Real, int Dim>
auto* lanes_of(Eigen::Matrix<Real, Dim, 1>* values) {
  return reinterpret_cast<Vec<Dim, Lane<Real>>*>(values);
}
template <std::floating_point Real, int Dim>
auto* lanes_of(const Eigen::Matrix<Real, Dim, 1>* values) {
  return reinterpret_cast<const Vec<Dim, Lane<Real>>*>(values);
}

}  // namespace silt

template <class Number>
struct Eigen::NumTraits<silt::Lane<Number>> : Eigen::NumTraits<Number> {
  using Real = silt::Lane<Number>;
  using NonInteger = Real;
  using Literal = Real;
  using Nested = Real;
};
