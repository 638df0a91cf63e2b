// SPDX-License-Identifier: MIT
#include <silt/io/csv.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/reads_these.hpp"

#include <gtest/gtest.h>

#if __has_include(<sys/resource.h>)
#include <csignal>
#include <sys/resource.h>
#include <sys/stat.h>
#endif

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

namespace silt::test::csv_test {
namespace {

class Csv : public test::FileTest {
 protected:
  auto refuses_to_read(const std::string& text, const std::vector<std::string>& fragments) {
    write(text);
    return test::refuses([this] { read_csv(path); }, fragments);
  }
};

TEST_F(Csv, NumbersAreReadBackExactly) {
  const std::vector<double> values{0.1, -1.0 / 3, std::numbers::pi * 1e-300, 5e-324, 0,
                                   std::numeric_limits<double>::max()};
  {
    CsvFile file{path, {"t", "x_front"}};
    for (const double value : values) file.row({value, -value});
  }
  const CsvTable table = read_csv(path);
  EXPECT_EQ(table.names(), (std::vector<std::string>{"t", "x_front"}));
  EXPECT_EQ(table["t"], values);
  EXPECT_EQ(table["x_front"][0], -0.1);
}

TEST_F(Csv, EveryRowIsWrittenToDiscImmediately) {
  CsvFile file{path, {"t"}};
  EXPECT_EQ(read_csv(path).rows(), 0u);
  file.row({0.5});
  EXPECT_EQ(read_csv(path)["t"], (std::vector<double>{0.5}));
}

TEST_F(Csv, ARowOfTheWrongLengthIsRejected) {
  CsvFile file{path, {"t", "x"}};
  EXPECT_THROW(file.row({1}), Error);
  EXPECT_THROW(file.row({1, 2, 3}), Error);
  EXPECT_EQ(read_csv(path).rows(), 0u);
}

#if __has_include(<sys/resource.h>)
TEST_F(Csv, ARowThatCannotBeWrittenLeavesTheFileUnchanged) {
  CsvFile file{path, {"t", "x"}};
  file.row({1, 2});
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit full = before;
  full.rlim_cur = std::filesystem::file_size(path) + 3;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  const auto refused = test::refuses([&] { file.row({3.25, 4.25}); }, {"CsvFile: cannot write"});
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(refused);
  file.row({5, 6});
  EXPECT_EQ(bytes(), "t,x\n1,2\n5,6\n");
}

TEST_F(Csv, DevicesAreRefusedBeforeTheyAreRead) {
  EXPECT_TRUE(test::refuses([] { read_csv("/dev/null"); },
                            {"read_csv: cannot read /dev/null", "device; give a file"}));
}

TEST_F(Csv, APipeIsRead) {
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  std::thread writer([this] { std::ofstream(path) << "t\n0.5\n"; });
  EXPECT_EQ(read_csv(path)["t"], (std::vector<double>{0.5}));
  writer.join();
}
#endif

TEST_F(Csv, AFileThatCannotBeWrittenIsReportedWithTheReason) {
  const auto below = path / "below" / "a.csv";
  EXPECT_TRUE(test::refuses([&] { CsvFile(below, {"t"}); },
                            {"CsvFile", below.string(), "No such file or directory"}));
  EXPECT_THROW(CsvFile(path, {}), Error);
}

TEST_F(Csv, CommentsBlanksAndCarriageReturnsAreSkipped) {
  write("# Martin and Moyce\r\n\r\n T , Z\r\n1, 2.5\r\n  # more\r\n-3e2,\t4\r\n");
  const CsvTable table = read_csv(path);
  EXPECT_EQ(table["T"], (std::vector<double>{1, -300}));
  EXPECT_EQ(table["Z"], (std::vector<double>{2.5, 4}));
}

TEST_F(Csv, AByteOrderMarkAndPlusSignsAreRead) {
  write("\xEF\xBB\xBFt,x\r\n+1,+2.5e+1\r\n");
  const CsvTable table = read_csv(path);
  EXPECT_EQ(table["t"], (std::vector<double>{1}));
  EXPECT_EQ(table["x"], (std::vector<double>{25}));
  EXPECT_TRUE(refuses_to_read("t\n+-5\n", {"line 2, column t: \"+-5\""}));
  EXPECT_TRUE(refuses_to_read("t\n++5\n", {"line 2, column t: \"++5\""}));
}

TEST_F(Csv, ErrorsNameLineAndColumn) {
  EXPECT_TRUE(refuses_to_read("t,x\n1,2\n3,4m\n", {"line 3, column x: \"4m\""}));
  EXPECT_TRUE(refuses_to_read("t,x\n1,\n", {"line 2, column x: \"\""}));
  EXPECT_TRUE(refuses_to_read("# c\nt,x\n1\n", {"line 3: 1 values for 2"}));
  EXPECT_TRUE(refuses_to_read("t,t\n", {"line 1: the column name \"t\""}));
  EXPECT_TRUE(refuses_to_read("", {"no line of column names"}));
}

TEST_F(Csv, AMissingFileOrAFolderIsRejected) {
  EXPECT_TRUE(test::refuses([this] { read_csv(path); },
                            {"read_csv", path.string(), "No such file or directory"}));
  EXPECT_TRUE(test::refuses([] { read_csv(testing::TempDir()); }, {"read_csv", "directory"}));
}

TEST_F(Csv, AMissingColumnIsReportedWithTheExistingOnes) {
  write("t,x\n");
  EXPECT_TRUE(test::refuses([this] { read_csv(path)["y"]; }, {"no column y; it has t, x"}));
}

TEST_F(Csv, ATableThatIsNoLongerThereIsReported) {
  CsvFile table(path, {"a"});
  table.row({1});
  const auto read = [&] {
    ReadsThese archive({{"size", std::uint64_t(std::filesystem::file_size(path))}});
    table.transfer(archive);
  };
  read();
  std::filesystem::resize_file(path, 2);
  EXPECT_TRUE(refuses([&] { table.row({2}); }, {"CsvFile", "has 2 bytes, but had 4"}));
  std::filesystem::remove(path);
  EXPECT_TRUE(refuses([&] { table.row({2}); }, {"CsvFile: cannot write"}));
}

}  // namespace
}  // namespace silt::test::csv_test
