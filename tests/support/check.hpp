// SPDX-License-Identifier: MIT
// Checks used by several tests: error messages, and bitwise equality.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace silt::test {

/// f() throws silt::Error, and its message contains all of the fragments.
template <class F>
::testing::AssertionResult refuses(F&& f, const std::vector<std::string>& fragments) {
  try {
    f();
  } catch (const Error& error) {
    const std::string message = error.what();
    for (const std::string& fragment : fragments) {
      if (message.find(fragment) == std::string::npos) {
        return ::testing::AssertionFailure()
               << "\"" << message << "\" does not contain \"" << fragment << "\"";
      }
    }
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

using Bytes = std::vector<std::byte>;

/// The bytes of the values of a range.
template <class Values>
void append(Bytes& bytes, const Values& values) {
  for (const auto& value : values) {
    const auto more = std::as_bytes(std::span(&value, 1));
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
}

/// Ids and all columns except those that every step recomputes.
template <class P>
Bytes state_of(const P& particles) {
  Bytes bytes;
  append(bytes, particles.ids());
  particles.for_each_field([&bytes]<class F>(auto values, F) {
    if constexpr (role_of<F>() != Role::derived) append(bytes, values);
  });
  return bytes;
}

/// Calls f() with this number of threads and restores the previous number.
template <class F>
auto with_threads(int number, F&& f) {
  struct PutBack {
    int before = threads();
    bool given = detail::threads_are_given();
    ~PutBack() {
      use_threads(before);
      detail::threads_are_given() = given;
    }
  } put_back;
  use_threads(number);
  return f();
}

}  // namespace silt::test
