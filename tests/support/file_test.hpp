// SPDX-License-Identifier: MIT
// A file and a folder for the duration of a test.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace silt::test {

/// A path of the running test's own in the folder for temporary files.
inline std::filesystem::path path_of_test() {
  const auto& test = *testing::UnitTest::GetInstance()->current_test_info();
  return std::filesystem::path(testing::TempDir()) /
         (std::string("silt_") + test.test_suite_name() + "_" + test.name());
}

/// An empty folder, removed with this object.
class Folder {
 public:
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }

  const std::filesystem::path path = path_of_test();
};

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

  const std::filesystem::path path = path_of_test();
};

}  // namespace silt::test
