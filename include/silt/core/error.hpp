// SPDX-License-Identifier: MIT
// How Silt refuses: one exception type that names the thing, the value and what to do, and the one
// function that throws it. Nothing in the library prints or ends the process.
#pragma once

#include <silt/core/types.hpp>

#include <Eigen/Core>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace silt {

/// Where an error happened, as far as it is known.
struct Where {
  std::optional<Index> particle{};      ///< place in memory
  std::optional<Id> id{};               ///< its name for life
  std::optional<std::uint64_t> step{};  ///< steps done before the one that failed
  std::optional<double> time{};         ///< [s] at the beginning of the step that failed
};

/// What Silt throws. `what()` is one sentence: the thing, its value, what to do, and where.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string sentence, Where where = {})
      : std::runtime_error(compose(sentence, where)), sentence_(std::move(sentence)),
        where_(where) {}

  const Where& where() const noexcept { return where_; }

  /// The same error with step and time filled in; the simulation adds them on the way out.
  Error with_step(std::uint64_t step, double time) const {
    Where where = where_;
    where.step = step;
    where.time = time;
    return Error(sentence_, where);
  }

 private:
  static std::string compose(const std::string& sentence, const Where& where);

  std::string sentence_;
  Where where_;
};

/// A number as a reader writes it: short, and enough digits to recognise it.
inline std::string to_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// A vector: "(1, 2)".
template <class Real, int Dim>
std::string to_text(const Eigen::Matrix<Real, Dim, 1>& value) {
  std::string text = "(" + to_text(double(value[0]));
  for (int k = 1; k < Dim; ++k) text += ", " + to_text(double(value[k]));
  return text + ")";
}

inline std::string Error::compose(const std::string& sentence, const Where& where) {
  std::string text = sentence;
  auto add = [&, first = true](const std::string& part) mutable {
    text += first ? " (" : ", ";
    text += part;
    first = false;
  };
  const bool any = where.particle || where.id || where.step || where.time;
  if (where.particle) add("particle " + std::to_string(*where.particle));
  if (where.id) add("id " + std::to_string(*where.id));
  if (where.step) add("step " + std::to_string(*where.step));
  if (where.time) add("t = " + to_text(*where.time) + " s");
  if (any) text += ")";
  return text;
}

/// The one place that throws.
[[noreturn]] inline void fail(std::string sentence, Where where = {}) {
  throw Error(std::move(sentence), where);
}

/// Finite by its bits, so that -ffast-math cannot argue it away.
inline bool is_finite(double value) {
  constexpr std::uint64_t exponent = 0x7ff0000000000000u;
  return (std::bit_cast<std::uint64_t>(value) & exponent) != exponent;
}
inline bool is_finite(float value) {
  constexpr std::uint32_t exponent = 0x7f800000u;
  return (std::bit_cast<std::uint32_t>(value) & exponent) != exponent;
}
template <class Real, int Dim>
bool is_finite(const Eigen::Matrix<Real, Dim, 1>& v) {
  bool finite = true;
  for (int k = 0; k < Dim; ++k) finite &= is_finite(v[k]);
  return finite;
}

/// Checks of parameters. `name` is what the user wrote: "Leapfrog: time_step".
inline void require_finite(std::string_view name, double value) {
  if (!is_finite(value)) {
    fail(std::string(name) + " = " + to_text(value) + " is not a finite number; give one");
  }
}
template <class Real, int Dim>
void require_finite(std::string_view name, const Eigen::Matrix<Real, Dim, 1>& value) {
  for (int k = 0; k < Dim; ++k) require_finite(name, double(value[k]));
}
inline void require_positive(std::string_view name, double value) {
  require_finite(name, value);
  if (!(value > 0)) {
    fail(std::string(name) + " = " + to_text(value) + " must be positive; give a value above 0");
  }
}
inline void require_not_negative(std::string_view name, double value) {
  require_finite(name, value);
  if (value < 0) {
    fail(std::string(name) + " = " + to_text(value) +
         " is negative; give a value of at least 0");
  }
}
struct Range {
  double lower;
  double upper;
};
/// lower ≤ value ≤ upper.
inline void require_between(std::string_view name, double value, Range range) {
  require_finite(name, value);
  if (value < range.lower || value > range.upper) {
    fail(std::string(name) + " = " + to_text(value) + " is outside " + to_text(range.lower) +
         " to " + to_text(range.upper) + "; give a value in that range");
  }
}

/// What an iterative solve did; readable after every step that solves.
struct SolveReport {
  enum class Reason { nothing_to_solve, converged, not_converged, broke_down };

  Reason reason = Reason::nothing_to_solve;
  int iterations = 0;
  double residual = 0;  ///< |b − A x| / |b|, recomputed from x [-]
  Index unknowns = 0;
};

}  // namespace silt
