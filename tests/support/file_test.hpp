// SPDX-License-Identifier: MIT
// Fixture for tests that use a file.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace silt::test {

/// Fixture for tests that write a file at `path` and read it. The file is removed after the test.
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
