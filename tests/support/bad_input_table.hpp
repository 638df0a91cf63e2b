// SPDX-License-Identifier: MIT
// Tables of parameters: each wrong or extreme value is either accepted, as the parameter's row
// says, or refused by an error whose message has the form "Name: parameter = value …; remedy".
#pragma once

#include <silt/core/error.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace silt::test {

/// Sets of values, one bit for each value.
namespace accepts {
inline constexpr unsigned nothing = 0;
inline constexpr unsigned zero = 1;
inline constexpr unsigned minus_one = 2;
inline constexpr unsigned tiny = 4;  ///< 1e-310, which is below the normal numbers
inline constexpr unsigned huge = 8;  ///< 1e300; of integers, see IntegerParameter
inline constexpr unsigned infinite = 16;
inline constexpr unsigned minus_infinite = 32;
inline constexpr unsigned not_a_number = 64;

inline constexpr unsigned positive = tiny | huge;
inline constexpr unsigned not_negative = zero | positive;
inline constexpr unsigned finite = minus_one | not_negative;
}  // namespace accepts

/// A number: its name as in messages, such as "Plane: point", and a function that uses it.
struct NumberParameter {
  std::string name;
  std::function<void(double)> use;
  unsigned accepted;
};

struct IntegerParameter {
  std::string name;
  std::function<void(std::int64_t)> use;
  unsigned accepted;
  std::int64_t huge = std::int64_t{1} << 60;
};

/// Why the message has another form; empty if it has none of these faults. One of the texts in
/// `values` has to occur in it.
inline std::string fault_of(const std::string& message, const std::string& name,
                            const std::vector<std::string>& values) {
  const auto contains = [&](const std::string& text) {
    return message.find(text) != std::string::npos;
  };
  for (std::size_t from = 0; from < name.size();) {
    const std::size_t colon = std::min(name.find(": ", from), name.size());
    const std::string part = name.substr(from, colon - from);
    if (!contains(part)) return "does not name " + part;
    from = colon + 2;
  }
  bool has_value = false;
  for (const std::string& value : values) has_value = has_value || contains(value);
  if (!has_value) return "does not contain the value " + values.front();
  if (!contains("; ")) return "gives no remedy after a semicolon";
  if (contains("\n")) return "has more than one line";
  if (message.ends_with('.')) return "ends with a full stop";
  if (message.size() >= 300) return "is longer than 300 bytes";
  return {};
}

/// Calls use() and compares what happens with what the row of a table says.
inline void check_value(const std::string& name, const std::vector<std::string>& values,
                        bool is_accepted, const std::function<void()>& use) {
  const std::string what = name + " = " + values.front();
  SCOPED_TRACE(what);
  std::optional<std::string> message;
  try {
    use();
  } catch (const Error& error) {
    message = error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << what << " throws another exception than silt::Error: " << error.what();
    return;
  }
  if (message && is_accepted) {
    ADD_FAILURE() << what << " is in the list of accepted values, but is refused: " << *message;
  } else if (!message && !is_accepted) {
    ADD_FAILURE() << what << " is not in the list of accepted values, but is accepted";
  } else if (message) {
    const std::string fault = fault_of(*message, name, values);
    EXPECT_TRUE(fault.empty()) << what << ": the message \"" << *message << "\" " << fault;
  }
}

/// Uses every parameter with every value.
inline void check_parameters(const std::vector<NumberParameter>& parameters) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const struct {
    unsigned bit;
    double number;
  } values[] = {{accepts::zero, 0},
                {accepts::minus_one, -1},
                {accepts::tiny, 1e-310},
                {accepts::huge, 1e300},
                {accepts::infinite, infinity},
                {accepts::minus_infinite, -infinity},
                {accepts::not_a_number, std::numeric_limits<double>::quiet_NaN()}};
  for (const NumberParameter& each : parameters) {
    for (const auto& [bit, number] : values) {
      check_value(each.name, {to_text(number)}, (each.accepted & bit) != 0,
                  [&] { each.use(number); });
    }
  }
}

inline void check_parameters(const std::vector<IntegerParameter>& parameters) {
  for (const IntegerParameter& each : parameters) {
    const struct {
      unsigned bit;
      std::int64_t number;
    } values[] = {{accepts::zero, 0}, {accepts::minus_one, -1}, {accepts::huge, each.huge}};
    for (const auto& [bit, number] : values) {
      // Some parameters have no sign or 32 bits, and some messages have six digits.
      const auto without_sign = static_cast<std::uint64_t>(number);
      const auto shorter = static_cast<std::uint32_t>(without_sign);
      check_value(each.name,
                  {std::to_string(number), std::to_string(without_sign), std::to_string(shorter),
                   to_text(double(number)), to_text(double(without_sign))},
                  (each.accepted & bit) != 0, [&] { each.use(number); });
    }
  }
}

/// Calls change(); if that throws, state() must be as before.
template <class State, class Change>
void change_or_keep(State&& state, Change&& change) {
  const auto before = state();
  try {
    change();
  } catch (...) {
    EXPECT_EQ(state(), before) << "the state has changed, although the value was refused";
    throw;
  }
}

}  // namespace silt::test
