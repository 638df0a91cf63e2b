// SPDX-License-Identifier: MIT
// Checks that several tests make: an error that names what is wrong, and equality bit by bit.
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

/// f() throws silt::Error, and its sentence has every one of the words.
template <class F>
::testing::AssertionResult refuses(F&& f, const std::vector<std::string>& words) {
  try {
    f();
  } catch (const Error& error) {
    const std::string sentence = error.what();
    for (const std::string& word : words) {
      if (sentence.find(word) == std::string::npos) {
        return ::testing::AssertionFailure() << "\"" << sentence << "\" does not say " << word;
      }
    }
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

using Bytes = std::vector<std::byte>;

template <class T>
void append(Bytes& bytes, std::span<const T> values) {
  const auto more = std::as_bytes(values);
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// Ids and all columns but those that every step makes anew.
template <class P>
Bytes state_of(const P& particles) {
  Bytes bytes;
  append(bytes, particles.ids());
  particles.for_each_field([&bytes]<class F>(auto values, F) {
    if constexpr (role_of<F>() != Role::derived) append(bytes, values);
  });
  return bytes;
}

/// Runs f() with this number of threads and puts the number back.
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
