// SPDX-License-Identifier: MIT
#include <silt/core/rotation.hpp>
#include <silt/geometry/face_crossing.hpp>
#include <silt/geometry/shapes.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace silt::test::face_crossing_test {
namespace {

constexpr double tolerance = 1e-4;  // [m]

template <int Dim>
using Surface = std::vector<Face<Dim>>;

// The faces at rest and a group that moves to a pose in the step.
template <int Dim>
bool crosses_in_step(const Surface<Dim>& at_rest, const Surface<Dim>& moving, const Pose<Dim>& move) {
  Faces<Dim> faces("faces", at_rest, {moving});
  faces.begin_step({StepOfFaces<Dim>{.before = {}, .move = move, .velocity = {}}});
  return find_crossing_in_step(faces, tolerance).has_value();
}
template <int Dim>
bool crosses_now(const Surface<Dim>& at_rest, const Surface<Dim>& moving) {
  return find_crossing(Faces<Dim>("faces", at_rest, {moving}), tolerance).has_value();
}
Pose<3> shift_by(const Vec<3>& shift) { return {.shift = shift}; }

// A square bar along an axis, on one of its edges: its lowest and highest edges are at ±h.
Surface<3> bar(int axis, double h, double z) {
  const auto corner = [&](int k, double end) {
    const double angle = k * 1.5707963267948966;
    Vec<3> x = Vec<3>::Zero();
    x[axis] = end;
    x[1 - axis] = h * std::cos(angle);
    x[2] = z + h * std::sin(angle);
    return x;
  };
  Surface<3> faces;
  for (int k = 0; k < 4; ++k) {
    const Vec<3> a = corner(k, -1), b = corner(k + 1, -1), c = corner(k + 1, 1), d = corner(k, 1);
    faces.push_back({{a, b, c}});
    faces.push_back({{a, c, d}});
  }
  return faces;
}
Surface<3> box(const Vec<3>& lower, const Vec<3>& upper) {
  return faces_of(Box<3>{.lower = lower, .upper = upper});
}

// The only test of edges that go through edges: no corner comes to a face.
TEST(FaceCrossing, IsFoundWhereTwoBarsGoThroughEachOther) {
  const double h = 0.1, gap = 0.01;
  const Surface<3> low = bar(0, h, 0), high = bar(1, h, 2 * h + gap);
  EXPECT_FALSE(crosses_in_step(low, high, shift_by({0, 0, -gap})));
  EXPECT_TRUE(crosses_in_step(low, high, shift_by({0, 0, -gap - 0.002})));
  EXPECT_TRUE(crosses_in_step(low, high, shift_by({0.3, 0.1, -gap - 0.002})));
  EXPECT_TRUE(crosses_in_step(high, low, shift_by({0, 0, gap + 0.002})));
  EXPECT_FALSE(crosses_in_step(low, high, shift_by({0.3, 0.1, -gap / 2})));
  // Thinner than the step, so that nothing is left of it at the end.
  const double thin = 0.001;
  EXPECT_TRUE(crosses_in_step(bar(0, thin, 0), bar(1, thin, gap), shift_by({0, 0, -2 * gap})));
  EXPECT_FALSE(crosses_in_step(bar(0, thin, 0), bar(1, thin, gap), shift_by({0.5, 0.5, 2 * gap})));
}

// What is allowed: the only test that faces on each other are no crossing, also to round-off.
TEST(FaceCrossing, IsNotFoundWhereFacesTouchAndSlide) {
  const Surface<3> tank = box({0, 0, 0}, {1, 1, 1});
  const Surface<3> gate = box({0.4, 0, 0}, {0.5, 1, 0.8});  // in contact with floor and sides
  EXPECT_FALSE(crosses_now(tank, gate));
  const double round_off = 0.3 * tolerance;
  for (const Vec<3>& move : {Vec<3>(0, 0, 0.05), Vec<3>(0.05, 0, 0), Vec<3>(-0.03, 0, round_off),
                             Vec<3>(0, -round_off, 0)}) {
    EXPECT_FALSE(crosses_in_step(tank, gate, shift_by(move))) << move.transpose();
  }
  EXPECT_TRUE(crosses_in_step(tank, gate, shift_by({0, 0, -0.01})));
  EXPECT_TRUE(crosses_in_step(tank, gate, shift_by({0, 0.01, 0})));
  // A piston that fills a tank of any height, where the diagonals of the walls meet its corner.
  Sides<3> lowest{};
  lowest.lower[2] = true;
  const Box<3> shaft{.lower = {0, 0, 0}, .upper = {0.16, 0.16, 1.1}};
  for (double z = 0; z < 0.05; z += 0.00017) {
    Surface<3> piston = faces_of(shaft, lowest);
    for (Face<3>& face : piston) {
      for (Vec<3>& corner : face.corners) corner[2] = z;
    }
    EXPECT_FALSE(crosses_in_step(faces_of(shaft), piston, shift_by({0, 0, 1e-3}))) << z;
  }
  // A flap that turns about its lower edge, on the floor, between the sides.
  const Surface<3> flap{{{Vec<3>(0.5, 0, 0), Vec<3>(0.5, 1, 0), Vec<3>(0.5, 1, 0.9)}},
                        {{Vec<3>(0.5, 0, 0), Vec<3>(0.5, 1, 0.9), Vec<3>(0.5, 0, 0.9)}}};
  Pose<3> turn{.rotation = rotation_about(Vec<3>(0, 1, 0), 0.05)};
  turn.shift = Vec<3>(0.5, 0, 0) - turn.rotation * Vec<3>(0.5, 0, 0);
  EXPECT_FALSE(crosses_now(tank, flap));
  EXPECT_FALSE(crosses_in_step(tank, flap, turn));
  // Two boxes with a common side, of which one moves along it.
  EXPECT_FALSE(crosses_in_step(box({0, 0, 0}, {1, 1, 1}), box({1, 0.1, 0}, {2, 0.9, 0.5}),
                               shift_by({0, 0.05, 0.01})));
}

// The only test of corners at the ends of faces: a floor that ends below a piston, and a lid that
// goes through a floor as wide as it is.
TEST(FaceCrossing, IsFoundAtARimOnlyIfTheFaceGoesThrough) {
  const auto floor = polyline({{0, 0}, {3, 0}}), piston = polyline({{0, 0}, {0, 0.75}});
  EXPECT_FALSE(crosses_in_step<2>(floor, piston, {.shift = {0.01, 0}}));
  EXPECT_FALSE(crosses_in_step<2>(floor, piston, {.shift = {-0.01, 0}}));
  EXPECT_TRUE(crosses_in_step<2>(floor, piston, {.shift = {0.01, -0.02}}));
  const auto tank = polyline({{0, 1}, {0, 0}, {1, 0}, {1, 1}});
  EXPECT_TRUE(crosses_in_step<2>(tank, polyline({{0, 0.01}, {1, 0.01}}), {.shift = {0, -0.02}}));
}

TEST(FaceCrossing, IsFoundWhereItBegins) {
  const Surface<3> tank = box({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(crosses_now(tank, box({0.4, 0.1, -0.01}, {0.5, 0.9, 0.8})));
  EXPECT_TRUE(crosses_now(tank, bar(0, 0.1, 0.5)));
  EXPECT_FALSE(crosses_now(tank, box({0.4, 0.1, 0}, {0.5, 0.9, 1})));
  const auto floor = polyline({{-1, 0}, {1, 0}});
  EXPECT_TRUE(crosses_now<2>(floor, polyline({{0, -0.01}, {0.2, 0.3}})));
  EXPECT_FALSE(crosses_now<2>(floor, polyline({{0, 0}, {0.2, 0.3}})));
  EXPECT_FALSE(crosses_now<2>(floor, polyline({{1, -0.3}, {1, 0.3}})));
}

// In the plane, where a corner passes a face, or the end of one.
TEST(FaceCrossing, IsFoundInThePlane) {
  const auto floor = polyline({{-1, 0}, {1, 0}}), plate = polyline({{0, 0.01}, {0, 0.5}});
  EXPECT_FALSE(crosses_in_step<2>(floor, plate, {.shift = {0.3, -0.01}}));
  EXPECT_TRUE(crosses_in_step<2>(floor, plate, {.shift = {0.3, -0.02}}));
  EXPECT_FALSE(crosses_in_step<2>(floor, polyline({{1.01, 0.01}, {1.01, 0.5}}), {.shift = {0, -0.3}}));
  EXPECT_TRUE(crosses_in_step<2>(floor, polyline({{-0.02, 0.01}, {2, 0.01}}), {.shift = {0, -0.02}}));
}

}  // namespace
}  // namespace silt::test::face_crossing_test
