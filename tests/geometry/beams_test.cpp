// SPDX-License-Identifier: MIT
#include <silt/geometry/beams.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/geometry/shapes.hpp>

#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace silt::test::beams_test {
namespace {

template <int Dim>
using Beam = typename Beams<Dim>::Beam;

// All faces, which are one facet.
template <int Dim>
Beam<Dim> beam_through(Beams<Dim>& beams, const Faces<Dim>& facet, const Vec<Dim>& viewpoint,
                       double shift, const Beam<Dim>& before = {}) {
  std::vector<std::uint32_t> numbers(facet.elements().size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  return beams.through(
      numbers, [&](std::uint32_t k) -> const auto& { return facet[k]; }, viewpoint,
      facet[0].height(viewpoint), shift, before);
}

template <int Dim>
bool is_passed(const Faces<Dim>& facet, const Vec<Dim>& from, const Vec<Dim>& to) {
  return std::ranges::any_of(facet.elements(), [&](const auto& element) {
    return (element.height(from) > 0) != (element.height(to) > 0) &&
           passage_of(element.face, from, to, 0) == Passage::through;
  });
}

std::vector<Face<3>> rectangle(const Vec<3>& origin, const Vec<3>& one, const Vec<3>& other) {
  return {{{origin, origin + one, origin + one + other}},
          {{origin, origin + one + other, origin + other}}};
}

// The three quarters of a square of side 2 at z = 0 around the origin without the first one.
Faces<3> l_shape() {
  std::vector<Face<3>> triangles;
  for (const Vec<3>& corner : {Vec<3>(-1, -1, 0), Vec<3>(0, -1, 0), Vec<3>(-1, 0, 0)}) {
    for (const auto& face : rectangle(corner, {1, 0, 0}, {0, 1, 0})) triangles.push_back(face);
  }
  return Faces<3>("L", triangles);
}

template <int Dim>
void expect_what_lines_reach(const Faces<Dim>& facet, unsigned seed) {
  int reached = 0;
  for (const Vec<Dim>& viewpoint : random_points(20, cube<Dim>(-2.0, 2.0), seed)) {
    Beams<Dim> beams;
    const auto beam = beam_through(beams, facet, viewpoint, 0);
    for (const Vec<Dim>& x : random_points(200, cube<Dim>(-2.0, 2.0), seed + 1)) {
      const bool is_reached = is_passed(facet, viewpoint, x);
      EXPECT_EQ(beams.contains(beam, x), is_reached) << viewpoint.transpose() << " to "
                                                     << x.transpose();
      reached += is_reached;
    }
  }
  EXPECT_GT(reached, 40);
}

TEST(Beams, ContainThePointsThatStraightLinesReach) {
  expect_what_lines_reach(Faces<2>("wall", polyline({{-1, 0}, {1, 0.5}})), 1);
  expect_what_lines_reach(Faces<2>("two of one line", polyline({{-1, 0}, {0, 0}, {1, 0}})), 2);
  expect_what_lines_reach(Faces<3>("rectangle", rectangle({-1, -1, 0}, {2, 0, 1}, {0, 2, 0})), 3);
  expect_what_lines_reach(l_shape(), 4);
}

TEST(Beams, EndAtTheLinesThroughTheEndsOfAWall) {
  const Faces<2> wall("wall", polyline({{-1, 0}, {1, 0}}));
  Beams<2> beams;
  const Beam<2> beam = beam_through<2>(beams, wall, {0, -1}, 0);
  EXPECT_TRUE(beams.contains(beam, {1.99, 1}));
  EXPECT_TRUE(beams.contains(beam, {2, 1}));
  EXPECT_FALSE(beams.contains(beam, {2.01, 1}));
  EXPECT_FALSE(beams.contains(beam, {0, -0.5}));  // before the wall
}

// A parallel line at this distance may pass an end of the wall that the line itself misses.
TEST(Beams, AreWiderByTheShiftOfLines) {
  const Faces<2> wall("wall", polyline({{-9, 0}, {0, 0}}));
  Beams<2> beams;
  constexpr double shift = 0.125;
  const Beam<2> beam = beam_through<2>(beams, wall, {0, -1}, shift);
  for (const double height : {0.5, 1.0, 4.0}) {
    // The end is closer to the line than the shift if the line's angle has this sine.
    const double width = (1 + height) * shift / std::sqrt(1 - shift * shift);
    EXPECT_TRUE(beams.contains(beam, {width - 1e-9, height})) << height;
    EXPECT_FALSE(beams.contains(beam, {width + 1e-9, height})) << height;
  }
}

TEST(Beams, MissNoShiftedLine) {
  const Faces<3> facet = l_shape();
  constexpr double shift = 0.2;
  const auto viewpoints = random_points(20, cube<3>(-2.0, 2.0), 5);
  const auto points = random_points(100, cube<3>(-2.0, 2.0), 6);
  const auto shifts = random_points(20, cube<3>(-shift / 2, shift / 2), 7);
  int reached_only_if_shifted = 0;
  for (const Vec<3>& viewpoint : viewpoints) {
    Beams<3> beams;
    const Beam<3> beam = beam_through(beams, facet, viewpoint, shift);
    for (const Vec<3>& x : points) {
      if (facet[0].height(viewpoint) * facet[0].height(x) > 0) continue;
      for (const Vec<3>& by : shifts) {
        if (!is_passed<3>(facet, viewpoint + by, x + by)) continue;
        EXPECT_TRUE(beams.contains(beam, x)) << viewpoint.transpose() << " to " << x.transpose();
        reached_only_if_shifted += !is_passed(facet, viewpoint, x);
      }
    }
  }
  EXPECT_GT(reached_only_if_shifted, 100);
}

// The image of a point in the second facet is where a straight line through both would lead.
template <int Dim>
void expect_what_lines_reach_through(const Faces<Dim>& one, const Faces<Dim>& other) {
  const auto mirror = mirror_in<Dim>(other[0].normal, other[0].offset);
  int reached = 0;
  Beams<Dim> beams;
  for (const Vec<Dim>& viewpoint : random_points(20, cube<Dim>(-2.0, 2.0), 8)) {
    beams.clear();
    const auto before = beam_through(beams, one, viewpoint, 0);
    const auto beam = beam_through(beams, other, mirror(viewpoint), 0, before);
    for (const Vec<Dim>& x : random_points(1000, cube<Dim>(-2.0, 2.0), 9)) {
      const Vec<Dim> image = mirror(x);
      const bool is_reached =
          is_passed(one, viewpoint, image) && is_passed(other, viewpoint, image);
      EXPECT_EQ(beams.contains(beam, x), is_reached) << viewpoint.transpose() << " to "
                                                     << x.transpose();
      reached += is_reached;
    }
  }
  EXPECT_GT(reached, 100);
}

TEST(Beams, ContainWhatLinesReachThroughTwoFacets) {
  expect_what_lines_reach_through(Faces<2>("one", polyline({{-1, 0.1}, {1, -0.2}})),
                                  Faces<2>("other", polyline({{-1, 0.7}, {1, 1}})));
  expect_what_lines_reach_through(
      Faces<3>("one", rectangle({-1, -1, 0}, {2, 0, 0.3}, {0, 2, 0})),
      Faces<3>("other", rectangle({-1, -1, 0.5}, {2, 0, 0}, {0, 2, 0.4})));
}

TEST(Beams, MayMeetEveryFaceThatHasAPointOfThem) {
  const Faces<3> facet = l_shape();
  const Vec<3> viewpoint(0.2, -0.3, -1);
  Beams<3> beams;
  const Beam<3> beam = beam_through(beams, facet, viewpoint, 0.1);
  const auto corners = random_points(900, cube<3>(-3.0, 3.0), 10);
  int met = 0, missed = 0;
  for (Index k = 0; k < corners.size(); k += 3) {
    const Face<3> face{{corners[k], corners[k + 1], corners[k + 2]}};
    missed += !beams.may_meet(beam, face, 3);
    for (const Vec<3>& shares : random_points(10, cube<3>(0.0, 1.0), 11)) {
      Vec<3> x = Vec<3>::Zero();
      for (int m = 0; m < 3; ++m) x += shares[m] / shares.sum() * face.corners[std::size_t(m)];
      const double distance = (x - viewpoint).norm();
      if (!beams.contains(beam, x)) continue;
      EXPECT_TRUE(beams.may_meet(beam, face, distance)) << x.transpose();
      ++met;
    }
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(missed, 20);
}

TEST(Beams, OfNoFacetAreEverywhere) {
  const Beams<3> beams;
  EXPECT_TRUE(beams.contains({}, {1, 2, 3}));
  EXPECT_TRUE(beams.may_meet({}, {{Vec<3>(0, 0, 0), {1, 0, 0}, {0, 1, 0}}}, 1));
}

}  // namespace
}  // namespace silt::test::beams_test
