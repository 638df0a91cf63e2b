// SPDX-License-Identifier: MIT
// Walls, their motions, meshes and loads accept or refuse wrong and extreme values as these tables
// say; an accepted wall has a nearest point with a unit normal.
#include <silt/io/stl.hpp>

#include "support/any_wall.hpp"
#include "support/bad_input_table.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include "support/triangles.hpp"
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace silt::test::bad_input_of_walls_test {
namespace {

// Finds the points of the wall that are nearest to a grain.
template <int Dim, class W>
void use(const W& given) {
  const AnyWall<Dim> wall(given);
  const Vec<Dim> x = Vec<Dim>::Constant(0.5);
  for (Index element = 0; element < wall.element_count(); ++element) {
    const auto nearest = wall.nearest(element, x);
    EXPECT_NEAR(nearest.normal.norm(), 1, 1e-6);
    EXPECT_FALSE(nearest.distance != nearest.distance);
  }
}

void use_plane(const dem::Plane<3>& plane) { use<3>(plane); }
void use_box(const Box<3>& box) { use<3>(dem::BoxWall<3>{box}); }
void use_circle(const dem::Circle<>& circle) { use<2>(circle); }
void use_cylinder(const dem::Cylinder<>& cylinder) { use<3>(cylinder); }
void use_segment(const dem::Segment<>& segment) { use<2>(segment); }

TEST(BadInput, OfWallsIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"Plane: point", [](double x) { use_plane({.point = {0, x, 0}}); }, accepts::finite},
      {"Plane: normal", [](double x) { use_plane({.normal = {0, 0, x}}); },
       accepts::minus_one | accepts::positive},
      {"Plane: normal", [](double x) { use_plane({.normal = {x, 0, 1}}); }, accepts::finite},
      {"Box: lower", [](double x) { use_box({.lower = {0, x, 0}, .upper = {2, 2, 2}}); },
       accepts::zero | accepts::minus_one | accepts::tiny | accepts::minus_infinite},
      {"Box: upper", [](double x) { use_box({.lower = {0, 0, -2}, .upper = {1, 1, x}}); },
       accepts::finite | accepts::infinite},
      {"Box: lower",
       [](double x) {
         use_box({.lower = {0, x, 0}, .upper = {2, 2, 2}, .periodic = {false, true, false}});
       },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"Box: upper",
       [](double x) {
         use_box({.lower = {0, 0, -2}, .upper = {1, 1, x}, .periodic = {false, false, true}});
       },
       accepts::finite},
      {"Circle: centre", [](double x) { use_circle({.centre = {x, 0}, .radius = 1}); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"Circle: radius", [](double x) { use_circle({.radius = x}); }, accepts::positive},
      {"Cylinder: from", [](double x) { use_cylinder({.from = {0, 0, x}, .radius = 1}); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"Cylinder: to", [](double x) { use_cylinder({.to = {0, 0, x}, .radius = 1}); },
       accepts::minus_one},
      {"Cylinder: radius", [](double x) { use_cylinder({.radius = x}); }, accepts::positive},
      {"Segment: from", [](double x) { use_segment({.from = {x, 0}, .to = {1, 1}}); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"Segment: to", [](double x) { use_segment({.from = {0, 0}, .to = {x, 0}}); },
       accepts::minus_one},
      {"Polyline: point",
       [](double x) { use<2>(dem::Polyline<>{.points = {{0, 0}, {x, 1}, {2, 2}}}); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"Polyline: point", [](double x) { use<2>(dem::Polyline<>{.points = {{0, 0}, {x, 0}}}); },
       accepts::minus_one}});
}

// A wall of triangles, one corner of which is as given.
void use_mesh(double x, const dem::MeshSettings& settings = {}) {
  Triangles triangles = box_of_triangles({.lower = {0, 0, 0}, .upper = {1, 1, 1}});
  triangles.push_back({{Vec<3>(2, 0, 0), Vec<3>(2, 1, 0), Vec<3>(3, 1, x)}});
  use<3>(dem::MeshWall<>(triangles, settings));
}

TEST(BadInput, OfMeshesIsRefused) {
  const Folder folder;
  const auto path = folder.path / "box.stl";
  write_stl(path, box_of_triangles({.lower = {0, 0, 0}, .upper = {1, 1, 1}}));
  check_parameters(std::vector<NumberParameter>{
      {"MeshWall: triangle 12", [](double x) { use_mesh(x); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"MeshSettings: flat_angle", [](double x) { use_mesh(0, {.flat_angle = x}); },
       accepts::zero | accepts::tiny},
      {"StlSettings: scale",
       [&](double x) { use<3>(dem::MeshWall<>(read_stl(path, {.scale = x}))); },
       accepts::nothing}});
}

// Positions and velocities of a moving wall in the course of a run.
template <class Motion>
void use_motion(const Motion& motion) {
  const dem::WallSet walls{dem::Moving{dem::Plane<3>{}, motion}};
  for (const double t : {0.0, 1e-3, 1e3}) {
    const auto moved = walls.template at<3, double>({.positions = t, .velocities = t});
    const auto nearest = moved.nearest(0, {0.5, 0.5, 0.5});
    EXPECT_TRUE(is_finite(nearest.normal));
    EXPECT_TRUE(is_finite(nearest.distance));
    EXPECT_TRUE(is_finite(moved.velocity(0).at({1, 2, 3})));
  }
}
void use_translation(const dem::Translation<3>& motion) { use_motion(motion); }
void use_rotation(const dem::Rotation<3>& motion) { use_motion(motion); }
void use_vibration(const dem::Vibration<3>& motion) { use_motion(motion); }

TEST(BadInput, OfMotionsOfWallsIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"Translation: velocity", [](double x) { use_translation({.velocity = {0, x, 0}}); },
       accepts::finite},
      {"Rotation: about", [](double x) { use_rotation({.about = {x, 0, 0}, .spin = {0, 1, 0}}); },
       accepts::finite},
      {"Rotation: spin", [](double x) { use_rotation({.spin = {0, x, 0}}); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"Vibration: amplitude",
       [](double x) { use_vibration({.amplitude = {0, 0, x}, .frequency = 50}); }, accepts::finite},
      {"Vibration: frequency",
       [](double x) { use_vibration({.amplitude = {0, 0, 1e-3}, .frequency = x}); },
       accepts::not_negative},
      {"Vibration: phase",
       [](double x) { use_vibration({.amplitude = {0, 0, 1e-3}, .frequency = 50, .phase = x}); },
       accepts::finite}});
}

// A user-defined motion that is at rest, with this period.
struct Pulse {
  double seconds = 0;

  dem::Pose<2, double> pose_at(double) const { return {}; }
  dem::RigidVelocity<2, double> velocity_at(double) const { return {}; }
  double period() const { return seconds; }
};

TEST(BadInput, OfThePeriodOfAMotionIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"Moving: period",
       [](double x) {
         const dem::Moving wall{dem::Plane<2>{}, Pulse{x}};
         EXPECT_EQ(dem::WallSet{wall}.shortest_period(), x);
       },
       accepts::positive | accepts::infinite}});
}

// A grain on a plane, after a step.
auto grain_on_a_plane(const dem::Plane<2>& plane) {
  Simulation sim{one_grain<2>({0, 0.0099}, {0, 0}), UniformGrid<2>{},
                 dem::Contacts(dem::CundallStrack{.normal_stiffness = 1e5}, plane), Leapfrog{}};
  sim.step();
  EXPECT_EQ(sim.interaction().size(), 1u);
  return sim;
}

TEST(BadInput, OfLoadsAndMaterialsOfWallsIsRefused) {
  const auto sim = grain_on_a_plane({});
  const auto& contacts = sim.interaction();
  const auto& grains = sim.particles();
  check_parameters(std::vector<IntegerParameter>{
      {"dem::Contacts: wall",
       [&](std::int64_t n) {
         EXPECT_TRUE(is_finite(contacts.load_on(grains, static_cast<Index>(n)).torque));
       },
       accepts::zero},
      {"dem::Contacts: material",
       [&](std::int64_t n) { grain_on_a_plane({.material = static_cast<std::uint32_t>(n)}); },
       accepts::zero, 1 << 30}});
  check_parameters(std::vector<NumberParameter>{
      {"dem::Contacts: about",
       [&](double x) { EXPECT_TRUE(is_finite(contacts.load_on(grains, 0, {x, 0}).torque)); },
       accepts::finite}});
}

}  // namespace
}  // namespace silt::test::bad_input_of_walls_test
