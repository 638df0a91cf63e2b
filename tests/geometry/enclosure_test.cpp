// SPDX-License-Identifier: MIT
#include <silt/core/lattice.hpp>
#include <silt/geometry/enclosure.hpp>
#include <silt/geometry/shapes.hpp>

#include "support/points.hpp"
#include <gtest/gtest.h>

#include <vector>

namespace silt::test::enclosure_test {
namespace {

template <int Dim>
void expect_what_is_inside(const std::vector<Face<Dim>>& faces, const std::vector<Vec<Dim>>& points) {
  const Enclosure<Dim> space(faces);
  Index inside = 0;
  for (const auto& x : points) {
    if (distance_from(faces, x) < 1e-9) continue;
    const bool expected = is_inside(faces, x);
    EXPECT_EQ(space.contains(x), expected) << x.transpose();
    const double near = 0.3;
    EXPECT_EQ(space.has_face_within(near, x), distance_from(faces, x) < near) << x.transpose();
    inside += expected ? 1 : 0;
  }
  EXPECT_GT(inside, points.size() / 10);
  EXPECT_LT(inside, points.size());
}

// The only test of a line that passes edges and corners of what it leaves.
TEST(Enclosure, ContainsWhatIsInside) {
  // In the plane, not convex, with points level with its corners.
  const std::vector<Vec<2>> corners{{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, 1}, {1, 1}, {1, 4}, {0, 4}, {0, 0}};
  auto points = lattice<2>({.lower = {-1.5, -1.5}, .upper = {5.5, 5.5}}, 1.0);
  for (const auto& x : lattice<2>({.lower = {-1, -1}, .upper = {5, 5}}, 0.4)) points.push_back(x);
  expect_what_is_inside<2>(polyline(corners), points);
  const std::vector<Face<3>> box = faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {2, 2, 2}});
  const auto grid = lattice<3>({.lower = {-0.7, -0.7, -0.7}, .upper = {2.7, 2.7, 2.7}}, 0.425);
  expect_what_is_inside<3>(box, grid);
  // Of two boxes that overlap, also what is in both.
  std::vector<Face<3>> both = box;
  for (const auto& face : faces_of(Box<3>{.lower = {1, 0.5, 0.5}, .upper = {3, 1.5, 1.5}})) {
    both.push_back(face);
  }
  expect_what_is_inside<3>(both, grid);
}

}  // namespace
}  // namespace silt::test::enclosure_test
