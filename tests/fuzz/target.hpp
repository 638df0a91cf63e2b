// SPDX-License-Identifier: MIT
// Shared by the fuzz targets. A target is a source file with LLVMFuzzerTestOneInput, which calls
// the library with an input of arbitrary bytes. Any exception that leaves it is a finding: calls of
// the library are made through accepts(), which catches silt::Error and nothing else.
//
// A target is linked either with libFuzzer or with replay.cpp, see CMakeLists.txt. To be included
// by one source file of a program only.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include "fuzz/counts.hpp"
#include "support/failing_allocations.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace silt::fuzz {

/// Whether f() returns; false if it throws silt::Error.
template <class F>
bool accepts(F&& f) {
  try {
    std::forward<F>(f)();
  } catch (const Error& error) {
    if (std::string_view(error.what()).empty()) throw std::logic_error("an error without a text");
    ++refused;
    return false;
  }
  ++accepted;
  return true;
}

/// Reports a finding unless the condition holds.
inline void require(bool condition, const std::string& what) {
  if (!condition) throw std::logic_error(what);
}

/// Calls f(); reports a finding if it needs more memory than so many times the bytes of the input,
/// and 1 MiB.
template <class F>
void require_memory(std::size_t times, std::size_t bytes, F&& f) {
  const std::int64_t needed = test::peak_of(std::forward<F>(f));
  require(needed <= std::int64_t(times * bytes + (1 << 20)), "too much memory for this input");
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A file in a temporary folder of its own.
class InputFile {
 public:
  explicit InputFile(const std::string& name = "input")
      : folder_(std::filesystem::temp_directory_path() / random_name()), path_(folder_ / name) {
    std::filesystem::create_directory(folder_);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  const std::filesystem::path& folder() const { return folder_; }
  const std::filesystem::path& path() const { return path_; }
  void write(std::string_view bytes) const {
    // A file that is written again would wait for the disk on some file systems.
    std::filesystem::remove(path_);
    std::ofstream stream(path_, std::ios::binary);
    stream << bytes;
    stream.close();
    if (!stream) throw std::runtime_error("cannot write " + path_.string());
  }

 private:
  static std::string random_name() {
    std::random_device random;
    return "silt_fuzz_" + std::to_string(random()) + std::to_string(random());
  }

  std::filesystem::path folder_;
  std::filesystem::path path_;
};

/// Reads choices and numbers from the bytes of an input; when they are used up, zeros. Bytes below
/// 64, which include digits and blanks, choose the usual value of a number: a file of text is a
/// sequence of calls without mistakes.
class Choices {
 public:
  Choices(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  bool are_left() const { return at_ != end_; }
  std::uint8_t byte() { return are_left() ? *at_++ : std::uint8_t(0); }
  /// One of 0 … n-1.
  Index below(Index n) { return byte() % n; }
  bool flag() { return byte() % 2 != 0; }
  template <class T>
  T raw() {
    std::uint8_t bytes[sizeof(T)];
    for (std::uint8_t& each : bytes) each = byte();
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }

  /// The usual value, one near it, or one that is not expected.
  double number(double usual) {
    const std::uint8_t kind = byte();
    if (kind < 64) return usual;
    if (kind < 128) return usual * (0.5 + byte() / 128.0);
    if (kind >= 224) return raw<double>();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    static const double numbers[] = {0.0,
                                     -0.0,
                                     1.0,
                                     -1.0,
                                     0.5,
                                     2.0,
                                     1e-6,
                                     1e6,
                                     1e-15,
                                     1e15,
                                     1e-30,
                                     1e30,
                                     -1e30,
                                     1e-150,
                                     1e150,
                                     1e-300,
                                     1e300,
                                     -1e300,
                                     infinity,
                                     -infinity,
                                     std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::max(),
                                     std::numeric_limits<double>::min(),
                                     std::numeric_limits<double>::denorm_min(),
                                     std::numeric_limits<double>::epsilon(),
                                     1 + std::numeric_limits<double>::epsilon(),
                                     4294967296.0,
                                     9007199254740993.0,
                                     18446744073709551616.0,
                                     -usual,
                                     1e3 * usual,
                                     1e-3 * usual};
    return numbers[Index(kind - 128) % std::size(numbers)];
  }
  template <int Dim>
  Vec<Dim> vector(const Vec<Dim>& usual) {
    Vec<Dim> values;
    for (int k = 0; k < Dim; ++k) values[k] = number(usual[k]);
    return values;
  }
  /// The usual number, or one that is not expected.
  Index count(Index usual) {
    const std::uint8_t kind = byte();
    if (kind < 64) return usual;
    if (kind < 128) return Index(kind - 64);
    static const Index numbers[] = {0,
                                    1,
                                    255,
                                    256,
                                    65536,
                                    (Index(1) << 31) - 1,
                                    Index(1) << 31,
                                    (Index(1) << 32) - 1,
                                    Index(1) << 32,
                                    Index(1) << 61,
                                    Index(1) << 63,
                                    std::numeric_limits<Index>::max()};
    return kind < 224 ? numbers[kind % std::size(numbers)] : raw<Index>();
  }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

}  // namespace silt::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
