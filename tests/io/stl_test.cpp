// SPDX-License-Identifier: MIT
#include <silt/io/stl.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace silt::test::stl_test {
namespace {

class Stl : public test::FileTest {
 protected:
  auto refuses_to_read(const std::string& text, std::vector<std::string> fragments) {
    write(text);
    fragments.push_back(path.string());
    return test::refuses([this] { read_stl(path); }, fragments);
  }

  // Numbers that are exact in single precision.
  const std::vector<Triangle<double>> two{
      {{Vec<3>(0, 0, 0), Vec<3>(1, 0, 0), Vec<3>(0, 0.5, 0)}},
      {{Vec<3>(1, 0, 0), Vec<3>(1, 0.5, -0.25), Vec<3>(0, 0.5, 0)}}};
};

void expect_same(const std::vector<Triangle<double>>& a, const std::vector<Triangle<double>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (Index t = 0; t < a.size(); ++t) EXPECT_EQ(a[t].corners, b[t].corners) << t;
}

TEST_F(Stl, ReadsBackWhatItWrote) {
  for (const StlFormat format : {StlFormat::binary, StlFormat::text}) {
    write_stl(path, two, format);
    expect_same(read_stl(path), two);
    EXPECT_EQ(read_stl(path, {.scale = 1e-3})[1].corners[1], Vec<3>(1e-3, 0.5e-3, -0.25e-3));
  }
}

TEST_F(Stl, ReadsBinaryFilesThatBeginLikeText) {
  write_stl(path, two);
  std::string like_text = bytes();
  like_text.replace(0, 24, "solid facet normal 0 0 0");
  write(like_text);
  expect_same(read_stl(path), two);
  write(like_text + "made by hand");
  expect_same(read_stl(path), two);
}

TEST_F(Stl, ReadsVariantsOfTheTextFormat) {
  write("\n  SOLID the name, of a facet\r\n"
        "  Facet Normal nan -nan(ind) 0\r\n    Outer Loop\r\n"
        "      Vertex +0 0.0 0e0\r\n Vertex 1.000000E+00 0 0\r\n vertex 0 5e-1 0\r\n"
        "    EndLoop\r\n  EndFacet\r\nendsolid\r\n"
        "solid second\nfacet normal 0 0 1 outer loop\n"
        "vertex 1 0 0 vertex 1 .5 -.25 vertex 0 .5 0\nendloop endfacet\nendsolid second\n\n");
  expect_same(read_stl(path), two);
}

TEST_F(Stl, RejectsTruncatedFiles) {
  for (const StlFormat format : {StlFormat::binary, StlFormat::text}) {
    write_stl(path, two, format);
    const std::string whole = bytes();
    const Index min_size = format == StlFormat::binary ? 0 : 6;
    for (Index size = min_size; size + 14 < whole.size(); size += 7) {
      EXPECT_TRUE(refuses_to_read(whole.substr(0, size), {"read_stl"})) << size;
    }
  }
  write_stl(path, two);
  EXPECT_TRUE(refuses_to_read(bytes().substr(0, 150), {"triangle 1 of 2", "export it again"}));
  EXPECT_TRUE(refuses_to_read("", {"0 bytes"}));
}

// What is beyond the number in the head would be lost.
TEST_F(Stl, RejectsMoreTrianglesThanAFileSaysItHas) {
  write_stl(path, two);
  auto one_more = bytes() + std::string(50, '\0');
  EXPECT_TRUE(refuses_to_read(one_more, {"has 2 triangles, but has the bytes of 3", "again"}));
  one_more.pop_back();
  write(one_more);
  expect_same(read_stl(path), two);
}

TEST_F(Stl, RefusesToWriteCoordinatesBeyondTheirPrecision) {
  auto large = two;
  for (auto& corner : large[1].corners) corner *= -1e39;
  EXPECT_TRUE(test::refuses([&] { write_stl(path, large); },
                            {"write_stl: a coordinate of 1e+39 m", "StlFormat::text"}));
  write_stl(path, large, StlFormat::text);
  expect_same(read_stl(path), large);
}

TEST_F(Stl, ReportsTheLocationOfAnErrorInText) {
  const std::string begin = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const std::string end = "endloop\nendfacet\nendsolid\n";
  EXPECT_TRUE(refuses_to_read(begin + "vertex 0 one 0\n" + end,
                              {"line 6", "triangle 0", "\"one\"", "a number"}));
  EXPECT_TRUE(refuses_to_read(begin + "vertex 0 +-1 0\n" + end, {"line 6", "\"+-1\"", "a number"}));
  EXPECT_TRUE(refuses_to_read(begin + end, {"line 6", "\"endloop\"", "vertex"}));
  EXPECT_TRUE(refuses_to_read(begin + "vertex 0 1", {"the file ends", "a number"}));
  EXPECT_TRUE(refuses_to_read(begin + "vertex 0 nan 0\n" + end, {"triangle 0", "nan", "finite"}));
  EXPECT_TRUE(refuses_to_read(begin + "vertex 3 0 0\n" + end, {"triangle 0", "no area", "repair"}));
  EXPECT_TRUE(refuses_to_read("solid nothing\nendsolid\n", {"no triangle"}));
}

TEST_F(Stl, RejectsInvalidTriangles) {
  auto broken = two;
  broken[1].corners[2][0] = std::numeric_limits<double>::quiet_NaN();
  write_stl(path, broken);
  EXPECT_TRUE(test::refuses([this] { read_stl(path); }, {"triangle 1", "nan", "give one"}));
  broken = two;
  broken[0].corners[2] = broken[0].corners[1];
  write_stl(path, broken);
  EXPECT_TRUE(test::refuses([this] { read_stl(path); }, {"triangle 0", "no area"}));
}

TEST_F(Stl, ReportsTheFileThatCannotBeOpened) {
  EXPECT_TRUE(test::refuses([] { read_stl("no/such/file.stl"); }, {"no/such/file.stl", "No such"}));
  EXPECT_TRUE(test::refuses([this] { write_stl("no/such/file.stl", two); }, {"no/such/file.stl"}));
  EXPECT_TRUE(test::refuses([] { read_stl(testing::TempDir()); }, {"read_stl", "directory"}));
}

}  // namespace
}  // namespace silt::test::stl_test
