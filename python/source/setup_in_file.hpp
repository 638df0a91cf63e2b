// SPDX-License-Identifier: MIT
// What a checkpoint of Python was set up with, beyond what the library compares: read_checkpoint()
// refuses another set-up by the name of the argument, with both values.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace silt::python {

/// An argument that is numbers [in its unit].
struct Argument {
  std::string name;
  std::vector<double> numbers;
};

/// Arguments that are not state: a checkpoint keeps them to compare them.
struct ArgumentsInFile {
  std::vector<Argument> all;

  template <class Archive>
  void transfer(Archive& archive) {
    for (Argument& each : all) archive(each.name, each.numbers);
  }
};

/// As Python writes it: different numbers have different texts.
inline std::string python_text(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}
inline std::string python_text(const std::vector<double>& numbers) {
  if (numbers.size() == 1) return python_text(numbers.front());
  std::string text = "(";
  for (const double each : numbers) text += (text.size() > 1 ? ", " : "") + python_text(each);
  return text += ')';
}
inline std::string python_text(OnEscape value) {
  return value == OnEscape::remove ? "'remove'" : "'refuse'";
}
template <std::size_t n>
std::string python_text(const std::array<bool, n>& flags) {
  std::string text = "(";
  for (const bool each : flags) {
    if (text.size() > 1) text += ", ";
    text += each ? "True" : "False";
  }
  return text += ')';
}

inline bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (const double each : b) {
    if (is_finite(each)) largest = std::max(largest, std::abs(each));
  }
  // As for SetupPart: another machine's mathematical functions may differ by round-off.
  return std::ranges::equal(
      a, b, [&](double x, double y) { return x == y || std::abs(x - y) <= 1e-9 * largest; });
}
template <class T>
bool is_same(const T& a, const T& b) {
  return a == b;
}

/// Throws if the checkpoint was written with another value of the argument than the present one.
template <class T>
void require_same(const std::filesystem::path& file, const std::string& name, const T& written,
                  const T& present) {
  if (is_same(written, present)) return;
  fail("read_checkpoint: " + file.string() + " was written with " + name + " = " +
       python_text(written) + ", but here it is " + python_text(present) +
       "; set up the same one, or, if the change is meant, read it with accepts_other_setup=True");
}
inline void require_same(const std::filesystem::path& file, const ArgumentsInFile& written,
                         const ArgumentsInFile& present) {
  for (Index k = 0; k < present.all.size(); ++k) {
    require_same(file, present.all[k].name, written.all[k].numbers, present.all[k].numbers);
  }
}
template <int Dim>
void require_same(const std::filesystem::path& file, const Box<Dim>& written,
                  const Box<Dim>& present) {
  const auto numbers = [](const Vec<Dim>& x) { return std::vector<double>(x.begin(), x.end()); };
  require_same(file, "box: lower", numbers(written.lower), numbers(present.lower));
  require_same(file, "box: upper", numbers(written.upper), numbers(present.upper));
  require_same(file, "box: periodic", written.periodic, present.periodic);
  require_same(file, "box: on_escape", written.on_escape, present.on_escape);
}

}  // namespace silt::python
