// SPDX-License-Identifier: MIT
// Scalar type for loops that the compiler vectorises.
//
// A law is written for one contact. A compiler vectorises a loop over eight contacts in contiguous
// memory, including branches, unless it contains explicit vector instructions. Eigen uses these for
// a vector of three doubles, but not for scalar types that it does not know, such as Lane<double>,
// which otherwise behaves as double.
#pragma once

#include <silt/core/eigen.hpp>
#include <silt/core/field_view.hpp>
#include <silt/core/types.hpp>

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <span>
#include <type_traits>

// Placed before such a loop. Tells g++ that no iteration reads what another writes; clang detects
// it.
#ifdef __clang__
#define SILT_INDEPENDENT_ITERATIONS
#else
#define SILT_INDEPENDENT_ITERATIONS _Pragma("GCC ivdep")
#endif

// Before an inner loop of a few iterations, which would keep g++ from vectorising the outer one.
#define SILT_UNROLLED _Pragma("GCC unroll 16")

// Before a function with such a loop, into which all is inlined: g++ 12 vectorises with -O3 only.
#if defined(__clang__) || !defined(__OPTIMIZE__)
#define SILT_VECTORISES
#else
#define SILT_VECTORISES [[gnu::optimize("O3")]]
#endif

// A square root has no effect but its result: without this, it sets errno for numbers below zero,
// and the compiler calls it for one contact after another unless -fno-math-errno is given.
#ifdef __GLIBC__
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wredundant-decls"
extern "C" [[gnu::const]] double sqrt(double) noexcept;
extern "C" [[gnu::const]] float sqrtf(float) noexcept;
#pragma GCC diagnostic pop
#endif

namespace silt {

namespace detail {
template <class T>
concept Arithmetic = std::is_arithmetic_v<T>;
}  // namespace detail

/// A number of type Real, which behaves as Real itself.
template <std::floating_point Real>
class Lane {
 public:
  Lane() = default;
  constexpr Lane(const Lane& b) : value_(b.value_) {}
  constexpr Lane& operator=(const Lane& b) {
    value_ = b.value_;
    return *this;
  }
  /// From a number of any arithmetic type, rounded to Real.
  constexpr Lane(detail::Arithmetic auto value) : value_(static_cast<Real>(value)) {}
  constexpr operator Real() const { return value_; }

  constexpr Lane& operator+=(Lane b) { return *this = *this + b; }
  constexpr Lane& operator-=(Lane b) { return *this = *this - b; }
  constexpr Lane& operator*=(Lane b) { return *this = *this * b; }
  constexpr Lane& operator/=(Lane b) { return *this = *this / b; }

  /// As silt::choose().
  // By bits: g++ moves arithmetic into the branches of a choice, and then cannot vectorise it,
  // because the arithmetic may trap.
  static constexpr Lane choose(bool condition, Lane a, Lane b) {
    using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
    const Bits chosen = Bits{0} - Bits{condition};
    return std::bit_cast<Real>((chosen & std::bit_cast<Bits>(a.value_)) |
                               (~chosen & std::bit_cast<Bits>(b.value_)));
  }

  friend constexpr Lane operator-(Lane a) { return -a.value_; }
  friend Lane sqrt(Lane a) {
    if constexpr (sizeof(Real) == sizeof(float)) {
      return ::sqrtf(a.value_);
    } else {
      return ::sqrt(a.value_);
    }
  }
  friend constexpr Lane operator+(Lane a, Lane b) { return a.value_ + b.value_; }
  friend constexpr Lane operator-(Lane a, Lane b) { return a.value_ - b.value_; }
  friend constexpr Lane operator*(Lane a, Lane b) { return a.value_ * b.value_; }
  friend constexpr Lane operator/(Lane a, Lane b) { return a.value_ / b.value_; }
  friend constexpr Lane operator+(Lane a, detail::Arithmetic auto b) { return a + Lane(b); }
  friend constexpr Lane operator-(Lane a, detail::Arithmetic auto b) { return a - Lane(b); }
  friend constexpr Lane operator*(Lane a, detail::Arithmetic auto b) { return a * Lane(b); }
  friend constexpr Lane operator/(Lane a, detail::Arithmetic auto b) { return a / Lane(b); }
  friend constexpr Lane operator+(detail::Arithmetic auto a, Lane b) { return Lane(a) + b; }
  friend constexpr Lane operator-(detail::Arithmetic auto a, Lane b) { return Lane(a) - b; }
  friend constexpr Lane operator*(detail::Arithmetic auto a, Lane b) { return Lane(a) * b; }
  friend constexpr Lane operator/(detail::Arithmetic auto a, Lane b) { return Lane(a) / b; }

 private:
  Real value_;
};

/// The same numbers in memory as Lanes, for use in such a loop.
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

template <class Value>
auto lanes_of(std::span<Value> values) {
  return lanes_of(values.data());
}
template <class Value, class Real, Index width>
auto lanes_of(const FieldView<Value, Real, width>& values) {
  using Lanes = std::remove_pointer_t<decltype(lanes_of(static_cast<Value*>(nullptr)))>;
  return FieldView<Lanes, Real, width>(values.bytes(), values.size());
}

}  // namespace silt

template <class Number>
struct Eigen::NumTraits<silt::Lane<Number>> : Eigen::NumTraits<Number> {
  using Real = silt::Lane<Number>;
  using NonInteger = Real;  // type of quotients; Eigen has Number otherwise
  using Literal = Real;     // type of constants in formulas, likewise
  using Nested = Real;
};
