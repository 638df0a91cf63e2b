// SPDX-License-Identifier: MIT
// Tests that have a file of their own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace silt::test {

/// Fixture of tests that write a file at `path` and read it back. It is gone when the test ends.
class FileTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path); }

  void write(const std::string& bytes) const {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  std::string bytes() const {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  const std::filesystem::path path = [] {
    const auto& test = *testing::UnitTest::GetInstance()->current_test_info();
    return std::filesystem::path(testing::TempDir()) /
           (std::string("silt_") + test.test_suite_name() + "_" + test.name());
  }();
};

}  // namespace silt::test
