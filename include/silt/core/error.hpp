// SPDX-License-Identifier: MIT
// Error reporting: the exception type, whose message names the quantity, its value and a remedy,
// the function that throws it, and checks of parameters. The library never prints or ends the
// process.
#pragma once

#include <silt/core/eigen.hpp>
#include <silt/core/types.hpp>

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace silt {

/// Where an error occurred; members that are not known are empty.
struct Where {
  std::optional<Index> particle{};      ///< index in memory
  std::optional<Id> id{};               ///< its permanent id
  std::optional<std::uint64_t> step{};  ///< steps completed before the one that failed
  std::optional<double> time{};         ///< [s] at the beginning of the step that failed
};

/// The exception that Silt throws. what() is a message with the quantity, its value, a remedy and
/// the location.
class Error : public std::runtime_error {
 public:
  /// Composes what() from the message and the location. `stable_time_step` [s] is for steps that
  /// failed because theirs was too long.
  explicit Error(std::string message, Where where = {}, std::optional<double> stable_time_step = {})
      : Error(std::move(message), where, stable_time_step, false) {}

  const Where& where() const noexcept { return where_; }
  /// If a step failed because its time step was too long: one that is not [s].
  const std::optional<double>& stable_time_step() const noexcept { return stable_time_step_; }

  /// The same error with step and time added; called by Simulation.
  [[gnu::cold]] Error with_step(std::uint64_t step, double time) const {
    Where where = where_;
    where.step = step;
    where.time = time;
    return Error(message_, where, stable_time_step_, is_of_all_);
  }

  /// The same error, that all processes throw, with the stable time step of all; called by particles
  /// that processes share.
  Error of_all(std::optional<double> stable) const {
    return Error(message_, where_, stable, true);
  }
  /// Whether it was made by of_all().
  bool is_of_all() const noexcept { return is_of_all_; }

  /// The same error with a text before its message; called by read_checkpoint().
  Error with_prefix(const std::string& text) const {
    return Error(text + message_, where_, stable_time_step_, is_of_all_);
  }

 private:
  [[gnu::cold]] Error(std::string message, Where where, std::optional<double> stable_time_step,
                      bool is_of_all)
      : std::runtime_error(compose(message, where)),
        message_(std::move(message)),
        where_(where),
        stable_time_step_(stable_time_step),
        is_of_all_(is_of_all) {}
  static std::string compose(const std::string& message, const Where& where);

  std::string message_;
  Where where_;
  std::optional<double> stable_time_step_;
  bool is_of_all_;
};

/// A number for messages, with six significant digits.
[[gnu::cold]] inline std::string to_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// A part of a message: a text or vector, which must outlive it, or a number.
class MessagePart {
 public:
  /// The text itself.
  MessagePart(std::string_view text)
      : text_(text.data()), length_(static_cast<std::ptrdiff_t>(text.size())) {}
  /// The text itself.
  MessagePart(const char* text) : MessagePart(std::string_view(text)) {}
  /// The text itself.
  MessagePart(const std::string& text) : MessagePart(std::string_view(text)) {}
  /// As to_text() writes it.
  MessagePart(std::floating_point auto value) : value_(double(value)), length_(is_value) {}
  /// As std::to_string() writes it.
  MessagePart(std::signed_integral auto number) : number_(number), length_(is_number) {}
  /// As std::to_string() writes it.
  MessagePart(std::unsigned_integral auto count) : count_(count), length_(is_count) {}
  MessagePart(char) = delete;  // would be a number
  MessagePart(bool) = delete;
  /// As "(1, 2)".
  template <std::floating_point Real, int Dim>
  MessagePart(const Eigen::Matrix<Real, Dim, 1>& vector)
      : vector_(vector.data()),
        length_((std::same_as<Real, float> ? is_vector_of_float : is_vector) - Dim) {
    static_assert(Dim == 2 || Dim == 3);
  }

  /// Appends it to a message.
  [[gnu::cold]] void add_to(std::string& message) const {
    if (length_ >= 0) {
      message.append(text_, static_cast<std::size_t>(length_));
    } else if (length_ < is_vector) {
      const bool is_float = length_ < is_vector_of_float;
      const auto size = (is_float ? is_vector_of_float : is_vector) - length_;
      for (std::ptrdiff_t k = 0; k < size; ++k) {
        message += k == 0 ? "(" : ", ";
        message += to_text(is_float ? double(static_cast<const float*>(vector_)[k])
                                    : static_cast<const double*>(vector_)[k]);
      }
      message += ')';
    } else {
      message += length_ == is_value    ? to_text(value_)
                 : length_ == is_number ? std::to_string(number_)
                                        : std::to_string(count_);
    }
  }

 private:
  // From the last two, the number of components is subtracted.
  enum Kind {
    is_value = -1,
    is_number = -2,
    is_count = -3,
    is_vector = -4,
    is_vector_of_float = -8
  };

  // Two words, because a program has many parts.
  union {
    const char* text_;
    const void* vector_;
    double value_;
    long long number_;
    unsigned long long count_;
  };
  std::ptrdiff_t length_;  // of the text, or the kind
};

/// Parts of a message as one. A program has hundreds of messages: `text + to_text(number) + …`
/// would compile to ten times as much.
[[gnu::cold, gnu::noinline]] inline std::string message_of(
    std::initializer_list<MessagePart> parts) {
  std::string message;
  for (const MessagePart& part : parts) part.add_to(message);
  return message;
}

[[gnu::cold]] inline std::string Error::compose(const std::string& message, const Where& where) {
  std::string text = message;
  const auto add = [&](std::initializer_list<MessagePart> part) {
    text += text.size() == message.size() ? " (" : ", ";
    text += message_of(part);
  };
  if (where.particle) add({"particle ", *where.particle});
  if (where.id) add({"id ", *where.id});
  if (where.step) add({"step ", *where.step});
  if (where.time) add({"t = ", *where.time, " s"});
  if (text.size() > message.size()) text += ')';
  return text;
}

/// A vector as "(1, 2)".
template <class Real, int Dim>
std::string to_text(const Eigen::Matrix<Real, Dim, 1>& value) {
  return message_of({value});
}

/// Throws an Error.
[[noreturn, gnu::cold, gnu::noinline]] inline void fail(std::string message, Where where = {}) {
  throw Error(std::move(message), where);
}
/// Throws an Error with a message of several parts: fail({"Leapfrog: mass = ", m, " kg …"}).
[[noreturn, gnu::cold, gnu::noinline]] inline void fail(std::initializer_list<MessagePart> message,
                                                        const Where& where = {}) {
  throw Error(message_of(message), where);
}

/// Throws an Error about a time step [s] beyond the stability limit of `what`, such as "a grain
/// with its contacts".
[[noreturn, gnu::cold, gnu::noinline]] inline void fail_as_unstable(std::string_view name,
                                                                    double time_step, double stable,
                                                                    std::string_view what,
                                                                    const Where& where) {
  throw Error(message_of({name, ": time_step = ", time_step, " s exceeds the stable time step ",
                          stable, " s of ", what, "; lower it"}),
              where, stable);
}

/// Neither infinite nor NaN.
inline bool is_finite(double value) {
  constexpr std::uint64_t exponent = 0x7ff0000000000000u;
  return (std::bit_cast<std::uint64_t>(value) & exponent) != exponent;
}
inline bool is_finite(float value) {
  constexpr std::uint32_t exponent = 0x7f800000u;
  return (std::bit_cast<std::uint32_t>(value) & exponent) != exponent;
}
/// Not a number.
inline bool is_nan(double value) {
  return !is_finite(value) && (std::bit_cast<std::uint64_t>(value) << 12) != 0;
}
/// Finite, above 0, and with all digits: not below the normal numbers.
template <class Real>
bool is_positive_normal(Real value) {
  return is_finite(value) && value >= std::numeric_limits<Real>::min();
}
template <class Real, int Dim>
bool is_finite(const Eigen::Matrix<Real, Dim, 1>& v) {
  bool finite = true;
  for (int k = 0; k < Dim; ++k) finite &= is_finite(v[k]);
  return finite;
}

// Checks of parameters. `name` is that of the parameter, such as "Leapfrog: time_step". Not
// inlined, because a program has many of them.

/// Throws unless the value is finite.
[[gnu::noinline]] inline void require_finite(std::string_view name, double value) {
  if (!is_finite(value)) {
    fail({name, " = ", value, " is not a finite number; give one"});
  }
}
template <class Real, int Dim>
void require_finite(std::string_view name, const Eigen::Matrix<Real, Dim, 1>& value) {
  for (int k = 0; k < Dim; ++k) require_finite(name, double(value[k]));
}
/// Throws unless value > 0 and finite.
[[gnu::noinline]] inline void require_positive(std::string_view name, double value) {
  require_finite(name, value);
  if (!(value > 0)) {
    fail({name, " = ", value, " must be positive; give a value above 0"});
  }
}
/// Throws unless value ≥ 0 and finite.
[[gnu::noinline]] inline void require_not_negative(std::string_view name, double value) {
  require_finite(name, value);
  if (value < 0) {
    fail({name, " = ", value, " is negative; give a value of at least 0"});
  }
}
/// The bounds of a parameter, `lower` and `upper`, [in its unit].
struct Range {
  double lower;
  double upper;
};
/// Throws unless lower ≤ value ≤ upper.
[[gnu::noinline]] inline void require_between(std::string_view name, double value, Range range) {
  require_finite(name, value);
  if (value < range.lower || value > range.upper) {
    fail({name, " = ", value, " is outside ", range.lower, " to ", range.upper,
          "; give a value in that range"});
  }
}

/// Throws unless lower < value ≤ upper.
[[gnu::noinline]] inline void require_above(std::string_view name, double value, Range range) {
  require_finite(name, value);
  if (value <= range.lower || value > range.upper) {
    fail({name, " = ", value, " must be above ", range.lower, " and at most ", range.upper,
          "; give a value in that range"});
  }
}

/// Result of an iterative solve, of a system of `unknowns` equations with `iterations` iterations.
struct SolveReport {
  /// Why the solve ended.
  enum class Reason {
    nothing_to_solve,  ///< there are no unknowns, or b = 0
    converged,         ///< the residual is within the tolerance
    not_converged,     ///< it is not after the largest number of iterations
    broke_down,        ///< a number is not finite, or A is not positive definite
  };

  Reason reason = Reason::nothing_to_solve;
  int iterations = 0;
  double residual = 0;  ///< |b − A x| / |b|, recomputed from x [-]
  Index unknowns = 0;
};

}  // namespace silt
