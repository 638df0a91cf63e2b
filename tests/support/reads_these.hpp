// SPDX-License-Identifier: MIT
// What a reader makes of values that a checkpoint with a valid checksum may contain.
#pragma once

#include <any>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace silt::test {

/// An archive that reads these values, as if from a checkpoint.
class ReadsThese {
 public:
  static constexpr bool reads = true;

  explicit ReadsThese(std::map<std::string, std::any> values) : values_(std::move(values)) {}

  template <class T>
  void operator()(std::string_view name, T& value) {
    value = std::any_cast<T>(values_.at(std::string(name)));
  }
  void same(std::string_view, const std::string&) {}

 private:
  std::map<std::string, std::any> values_;
};

}  // namespace silt::test
