// SPDX-License-Identifier: MIT
// That bodies in a flow keep momentum, float as Archimedes says, and stop before walls and each
// other.
#include <silt/geometry/close_faces.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/image_walls.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/fluid.hpp"
#include "support/restart.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

namespace silt::test::floating_bodies_test {
namespace {

constexpr double l0 = 0.02;  // [m]
constexpr double g = 9.81;   // [m/s²]

std::vector<Face<2>> faces_of_box(const Vec<2>& centre, const Vec<2>& half, double tilt = 0) {
  const auto at = [&](double a, double b) {
    return Vec<2>(centre + rotation_by(tilt) * Vec<2>(a * half[0], b * half[1]));
  };
  return polyline({at(-1, -1), at(1, -1), at(1, 1), at(-1, 1), at(-1, -1)});
}
std::vector<Face<3>> faces_of_box(const Vec<3>& centre, const Vec<3>& half) {
  return faces_of(Box<3>{.lower = centre - half, .upper = centre + half});
}

/// A tank of water with bodies; where they are, there is none.
template <int Dim>
struct Scene {
  Vec<Dim> size;
  double depth;
  std::vector<mps::FloatingBody<Dim>> bodies;
  mps::FlowSettings<Dim, mps::Recommended> settings = {};

  auto simulation() {
    settings.spacing = l0;
    settings.speed_scale = 2;
    mps::ImageWalls& walls = settings.walls;
    if constexpr (Dim == 2) {
      walls.segments = polyline({{0, size[1]}, {0, 0}, {size[0], 0}, size});
      walls.moving_2d = mps::MovingWalls<2>{.bodies = bodies};
    } else {
      walls.triangles = faces_of(Box<3>{.lower = {0, 0, 0}, .upper = size});
      walls.moving_3d = mps::MovingWalls<3>{.bodies = bodies};
    }
    mps::Fluid<Dim> fluid;
    Vec<Dim> filled = size;
    filled[Dim - 1] = depth;
    for (const auto& x : lattice<Dim>({.lower = Vec<Dim>::Zero(), .upper = filled}, l0)) {
      const bool is_free = std::ranges::none_of(bodies, [&](const auto& body) {
        // Of a convex one: on the side of its centre of each face, or closer than half a spacing.
        const Vec<Dim> centre = mass_properties_of<Dim>("body", body.faces, 1).centre;
        return std::ranges::all_of(body.faces, [&](const Face<Dim>& face) {
          const Vec<Dim> normal = normal_of(face);
          const double height = normal.dot(x - face.corners[0]);
          return (normal.dot(centre - face.corners[0]) > 0 ? -height : height) < 0.49 * l0;
        });
      });
      if (!is_free) continue;
      const Index i = mps::add_particle(fluid, x, mps::Kind::fluid);
      fluid[mps::pressure][i] = 1000 * g * (depth - x[Dim - 1]);
    }
    return Simulation{fluid, UniformGrid<Dim>{}, mps::Flow<mps::Recommended, Dim>{settings},
                      SemiImplicit<>{}};
  }
};

// The mass, centre and inertia of solids, from their faces.
TEST(MassProperties, OfSolidsAreExact) {
  const Vec<3> half{0.1, 0.2, 0.3};
  const auto box = mass_properties_of<3>("box", faces_of_box(Vec<3>(1, -2, 5), half), 500);
  const double mass = 500 * 8 * half.prod();
  EXPECT_NEAR(box.mass, mass, 1e-12 * mass);
  EXPECT_LT((box.centre - Vec<3>(1, -2, 5)).norm(), 1e-12);
  const Vec<3> inertia{mass / 3 * (0.04 + 0.09), mass / 3 * (0.01 + 0.09),
                       mass / 3 * (0.01 + 0.04)};
  EXPECT_LT((box.inertia - Eigen::Matrix3d(inertia.asDiagonal())).norm(), 1e-10);
  const auto triangle =
      mass_properties_of<2>("triangle", polyline({{0, 0}, {3, 0}, {0, 3}, {0, 0}}), 2);
  EXPECT_NEAR(triangle.mass, 9, 1e-12);
  EXPECT_LT((triangle.centre - Vec<2>(1, 1)).norm(), 1e-12);
  EXPECT_NEAR(triangle.inertia, 9, 1e-12);  // m (b² + h²)/18
}

// A body at its draught: no load but its weight's, with either density and in 2D and 3D.
template <int Dim>
void expect_that_it_floats(double ratio) {
  Vec<Dim> size = Vec<Dim>::Constant(14 * l0), half = Vec<Dim>::Constant(2.5 * l0),
           centre = size / 2;
  const double depth = 8 * l0;
  centre[Dim - 1] = depth + (0.5 - ratio) * 5 * l0;
  centre[0] += l0 / 2;
  if (Dim == 3) centre[1] += l0 / 2;
  auto sim = Scene<Dim>{.size = size,
                        .depth = depth,
                        .bodies = {{.faces = faces_of_box(centre, half), .density = 1000 * ratio}}}
                 .simulation();
  for (int k = 0; k < 25; ++k) sim.step();
  const auto state = sim.interaction().walls().bodies()[0].state();
  EXPECT_LT((state.position - centre).norm(), 1e-4 * l0);
  EXPECT_LT(state.velocity.norm(), 1e-4);
  EXPECT_LT(std::sqrt(squared_norm(state.spin)), 1e-3);
}
TEST(FloatingBodies, RestAtTheirDraught) {
  for (const double ratio : {0.2, 0.6}) expect_that_it_floats<2>(ratio);
  expect_that_it_floats<3>(0.2);
}

// In each step of a splash, the momentum of fluid and bodies changes by gravity and by the load on
// the other walls alone.
template <int Dim>
void expect_the_momentum_of_impulses() {
  Vec<Dim> size = Vec<Dim>::Constant(16 * l0), half = Vec<Dim>::Constant(4 * l0), high = size / 2;
  high[Dim - 1] = 13 * l0;
  if (Dim == 3) half[2] = 3 * l0, high[2] = 12 * l0;  // below the lid
  Vec<Dim> low = size / 2;
  low[Dim - 1] = 5 * l0;
  low[0] += 2 * l0;
  auto sim = Scene<Dim>{.size = size,
                        .depth = 8 * l0,
                        .bodies = {{.faces = faces_of_box(high, half), .density = 300},
                                   {.faces = faces_of_box(low, half / 2), .density = 2500}},
                        .settings = {.viscosity = 0}}
                 .simulation();
  const auto fluid_mass = 1000 * std::pow(l0, Dim);
  const auto momentum = [&] {
    Vec<Dim> sum = Vec<Dim>::Zero();
    for (const auto& u : sim.particles()[velocity]) sum += fluid_mass * u;
    for (const auto& body : sim.interaction().walls().bodies()) sum += body.momentum();
    return sum;
  };
  double mass = fluid_mass * double(sim.particles().size());
  for (const auto& body : sim.interaction().walls().bodies()) mass += body.mass_properties().mass;
  double deepest = 1;
  for (int k = 0; k < (Dim == 2 ? 120 : 15); ++k) {
    const Vec<Dim> before = momentum();
    sim.step();
    const Vec<Dim> change = momentum() - before;
    const mps::LoadOnGroup<Dim> on_tank(
        sim.interaction().walls().faces(), 0, sim.particles().box(), Vec<Dim>::Zero(),
        {.density = 1000, .spacing = l0, .time_step = sim.last_time_step()});
    const Vec<Dim> by_walls =
        -sim.last_time_step() *
        on_tank.sum(sim.interaction().momentum_changes(), [](const Vec<6>& own) { return own; })
            .force;
    Vec<Dim> by_gravity = Vec<Dim>::Zero();
    by_gravity[Dim - 1] = -mass * g * sim.last_time_step();
    Vec<Dim> by_contacts = Vec<Dim>::Zero();
    for (const auto& body : sim.interaction().walls().bodies())
      by_contacts += body.impulse_of_contacts();
    EXPECT_LT((change - by_gravity - by_walls - by_contacts).norm(),
              1e-10 * std::max(by_gravity.norm(), by_walls.norm()))
        << k;
    deepest = std::min(deepest, sim.interaction().walls().bodies()[1].state().position[Dim - 1]);
  }
  EXPECT_LT(deepest, low[Dim - 1]) << "it sinks";
}
TEST(FloatingBodies, KeepTheMomentum) {
  expect_the_momentum_of_impulses<2>();
  expect_the_momentum_of_impulses<3>();
}

// Without water: free fall, a spin without torque, a spring, and contacts without rebound.
TEST(FloatingBodies, MoveAsRigidBodies) {
  const auto box_at = [](const Vec<2>& centre) { return faces_of_box(centre, Vec<2>(0.04, 0.06)); };
  auto sim = Scene<2>{
      .size = {2, 2},
      .depth = 4 * l0,
      .bodies = {
          {.faces = box_at({0.3, 1.2}), .density = 800, .spin = 3},
          {.faces = box_at({1, 0.5}),
           .density = 2000,
           .velocity = {0.2, 0},
           .is_held = {true, true}},
          {.faces = box_at({1.6, 1}),
           .density = 1000,
           .is_held = {true, false},
           .load = [](const BodyState<2>& state, double) {
             return BodyLoad<2>{.force = {0, 9.6 * g - 9.6 * 100 * (state.position[1] - 1)}};
           }}}}.simulation();
  while (sim.time() < 0.2) sim.step();
  const auto& bodies = sim.interaction().walls().bodies();
  const double t = sim.time();
  EXPECT_NEAR(bodies[0].state().position[1], 1.2 - g * t * t / 2, 0.01 * g * t * t / 2 + 1e-3);
  EXPECT_NEAR(bodies[0].state().orientation.angle, 3 * t, 1e-9);
  EXPECT_LT((bodies[1].state().position - Vec<2>(1 + 0.2 * t, 0.5)).norm(), 1e-9);
  EXPECT_LT((bodies[2].state().position - Vec<2>(1.6, 1)).norm(), 1e-9) << "the spring carries it";
}
// An Euler top: the angular momentum in space is constant, and so is the energy to first order.
TEST(FloatingBodies, KeepTheAngularMomentum) {
  mps::BodyInFlow<3> body("body", {.faces = faces_of_box(Vec<3>(0, 0, 0), Vec<3>(0.1, 0.2, 0.3)),
                                   .density = 1000,
                                   .spin = {0.1, 2, 0.1}});
  const auto momentum = [&] {
    const Eigen::Matrix3d R = body.state().orientation.matrix();
    return Vec<3>(R * body.mass_properties().inertia * R.transpose() * body.state().spin);
  };
  const Vec<3> first = momentum();
  for (int k = 0; k < 5000; ++k) {
    body.begin_step("body", 0, 1e-3);
    body.end_step({}, {0, 0, 0}, 1e-3);
  }
  EXPECT_LT((momentum() - first).norm(), 0.01 * first.norm());
  EXPECT_NEAR(body.state().orientation.quaternion.norm(), 1, 1e-12);
}

template <int Dim>
double gap_between(const Faces<Dim>& faces, std::uint32_t group) {
  double least = inf;
  for_each_close_pair(faces, group, 1.0, [&](std::uint32_t own, std::uint32_t other) {
    for_each_closest_points(
        faces[own].face, faces[other].face,
        [&](const Vec<Dim>& x, const Vec<Dim>& y) { least = std::min(least, (x - y).norm()); });
  });
  return least;
}
// A body that falls on another one, and both on the floor: a spacing apart, whatever their
// densities.
template <int Dim>
void expect_a_spacing_between_bodies() {
  Vec<Dim> size = Vec<Dim>::Constant(14 * l0), half = Vec<Dim>::Constant(2 * l0), high = size / 2;
  Vec<Dim> low = size / 2;
  low[Dim - 1] = 4 * l0;
  high[Dim - 1] = 10 * l0;
  high[0] += l0 / 2;
  auto sim = Scene<Dim>{.size = size,
                        .depth = 2 * l0,
                        .bodies = {{.faces = faces_of_box(low, half), .density = 1500},
                                   {.faces = faces_of_box(high, half), .density = 7000}}}
                 .simulation();
  while (sim.time() < 0.3) sim.step();
  const auto& faces = sim.interaction().walls().faces();
  EXPECT_GT(gap_between(faces, 1), 0.95 * l0);
  EXPECT_LT(gap_between(faces, 1), 1.1 * l0);
  EXPECT_GT(gap_between(faces, 2), 0.95 * l0);
  EXPECT_LT(sim.interaction().walls().bodies()[1].state().velocity.norm(), 0.05);
}
TEST(FloatingBodies, StopASpacingBeforeWallsAndEachOther) {
  expect_a_spacing_between_bodies<2>();
  expect_a_spacing_between_bodies<3>();
}

// The only test of friction of bodies: a box that slides on the floor loses μ of what the floor
// takes from its fall, or stops; of two that rub at each other, no momentum changes.
template <int Dim>
void expect_friction_of_coulomb() {
  const double half = 2 * l0, mu = 0.3;
  const Vec<Dim> up = Vec<Dim>::Unit(Dim - 1), ahead = Vec<Dim>::Unit(0);
  // The boxes after contacts have changed their velocities, one a spacing above the other.
  const auto after = [&](const std::vector<Vec<Dim>>& velocities,
                         const std::vector<Face<Dim>>& rest) {
    std::vector<mps::BodyInFlow<Dim>> bodies;
    std::vector<std::vector<Face<Dim>>> faces;
    for (const Vec<Dim>& velocity : velocities) {
      Vec<Dim> centre = Vec<Dim>::Constant(0.5);
      centre[Dim - 1] = half + l0 + (2 * half + l0) * double(faces.size());
      faces.push_back(faces_of_box(centre, Vec<Dim>(Vec<Dim>::Constant(half))));
      bodies.emplace_back(
          "box", mps::FloatingBody<Dim>{
                     .faces = faces.back(), .density = 2000, .velocity = velocity, .friction = mu});
    }
    mps::BodyContacts<Dim>{}.end_approaches(
        bodies, Faces<Dim>("test", rest, faces), l0, 1e-3,
        [](std::size_t b) { return std::uint32_t(b + 1); },
        [](std::uint32_t, const Vec<Dim>&) { return Vec<Dim>(Vec<Dim>::Zero()); });
    return bodies;
  };
  Vec<Dim> middle = Vec<Dim>::Constant(0.5), size = middle;
  middle[Dim - 1] = -0.5;
  const auto floor = faces_of_box(middle, size);
  const double fall = 0.1;
  for (const double speed : {0.2, 0.01}) {
    const auto box = after({speed * ahead - fall * up}, floor)[0];
    const Vec<Dim> left = std::max(speed - mu * fall, 0.0) * ahead;
    EXPECT_LT((box.momentum() / box.mass_properties().mass - left).norm(), 1e-6 * fall);
  }
  const std::vector<Vec<Dim>> velocities{Vec<Dim>(0.1 * ahead), Vec<Dim>(-fall * up)};
  const auto both = after(velocities, {});
  Vec<Dim> change = Vec<Dim>::Zero();
  for (std::size_t b = 0; b < 2; ++b) {
    change += both[b].momentum() - both[b].mass_properties().mass * velocities[b];
  }
  EXPECT_LT(change.norm(), 1e-12 * both[0].momentum().norm());
  EXPECT_LT(both[0].momentum()[0], 0.99 * both[0].mass_properties().mass * 0.1);
}
TEST(FloatingBodies, RubAtWallsAndEachOther) {
  expect_friction_of_coulomb<2>();
  expect_friction_of_coulomb<3>();
}

using FloatingBodiesRestarted = FileTest;
TEST_F(FloatingBodiesRestarted, KeepTheBits) {
  const auto make = [] {
    return RunWith{
        Scene<2>{.size = {0.5, 0.6},
                 .depth = 0.16,
                 .bodies = {{.faces = faces_of_box(Vec<2>(0.2, 0.24), Vec<2>(0.06, 0.04), 0.3),
                             .density = 200,
                             .velocity = {0.3, -1}},
                            {.faces = faces_of_box(Vec<2>(0.38, 0.3), Vec<2>(0.04, 0.04)),
                             .density = 3000,
                             .spin = 2}}}
            .simulation()};
  };
  expect_the_same_bits_after_restarts(
      path, {.steps = 80, .number = 6, .further = 8, .to_the_end = 1}, make, [](const auto& run) {
        std::vector<double> numbers;
        for (const auto& body : run.simulation.interaction().walls().bodies()) {
          const auto state = body.state();
          numbers.insert(numbers.end(), {state.position[0], state.position[1],
                                         state.orientation.angle, state.velocity[1], state.spin});
        }
        return numbers;
      });
}

// A copy moves its own walls.
TEST(FloatingBodies, AreCopiedWithTheSimulation) {
  auto one =
      Scene<2>{
          .size = {0.4, 0.6},
          .depth = 0.16,
          .bodies = {{.faces = faces_of_box(Vec<2>(0.2, 0.3), Vec<2>(0.06, 0.04)), .density = 500}}}
          .simulation();
  for (int k = 0; k < 5; ++k) one.step();
  auto other = one;
  auto alone = one;
  for (int k = 0; k < 20; ++k) one.step();
  for (int k = 0; k < 20; ++k) {
    other.step();
    alone.step();
  }
  EXPECT_EQ(state_of(one.particles()), state_of(other.particles()));
  EXPECT_EQ(state_of(one.particles()), state_of(alone.particles()));
}

// No other test proves that a checkpoint tells apart all that moves walls and bodies.
TEST(FloatingBodies, AndMotionsAreToldApart) {
  const auto box = faces_of_box(Vec<2>(0.2, 0.2), Vec<2>(0.04, 0.04));
  const auto sum = [](const mps::MovingWalls<2>& walls) {
    return mps::ImageWalls{.moving_2d = walls}.checksum();
  };
  const auto of_body = [&](double inertia, double centre, double spin) {
    return sum(
        {.bodies = {{.faces = box,
                     .mass_properties =
                         MassProperties<2>{.mass = 1, .centre = {centre, 0.2}, .inertia = inertia},
                     .spin = spin}}});
  };
  const auto of_motion = [&](double speed) {
    return sum({.faces = {{.faces = box, .motion = Translation<2>{{speed, 0}}}}});
  };
  const std::vector<std::uint64_t> sums{of_body(1, 0.2, 0), of_body(2, 0.2, 0), of_body(1, 0.21, 0),
                                        of_body(1, 0.2, 3), of_motion(1),       of_motion(-1)};
  EXPECT_EQ(std::set<std::uint64_t>(sums.begin(), sums.end()).size(), sums.size());
}

// No other test proves that an impact does not depend on bodies that it does not concern.
TEST(FloatingBodies, DoNotDependOnBodiesElsewhere) {
  const auto velocity_after_impact = [](double density_of_other) {
    mps::FloatingBody<2> light{.faces = faces_of_box(Vec<2>(0.15, 0.16), Vec<2>(0.05, 0.04)),
                               .density = 50,
                               .velocity = {0, -1.5}};
    mps::FloatingBody<2> other{.faces = faces_of_box(Vec<2>(0.4, 0.45), Vec<2>(0.08, 0.08)),
                               .density = density_of_other,
                               .is_held = {true, true},
                               .keeps_orientation = true};
    auto sim = Scene<2>{.size = {0.6, 0.6}, .depth = 0.1, .bodies = {light, other}}.simulation();
    sim.run({.until = 0.05});
    const BodyState<2> state = sim.interaction().walls().bodies()[0].state();
    EXPECT_GT(state.velocity[1], -1);
    return state.velocity;
  };
  EXPECT_EQ(velocity_after_impact(200), velocity_after_impact(8000));
}

TEST(FloatingBodies, RefuseWhatIsNoBody) {
  const auto flow = [](const mps::FloatingBody<2>& body) {
    mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
    settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.4, 0}, {0.4, 1}});
    settings.walls.moving_2d = mps::MovingWalls<2>{.bodies = {body}};
    mps::Fluid<2> fluid;
    mps::add_particle(fluid, {0.1, 0.01}, mps::Kind::fluid);
    Simulation sim{fluid, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings},
                   SemiImplicit<>{}};
    sim.step();
  };
  const auto box = faces_of_box(Vec<2>(0.2, 0.2), Vec<2>(0.04, 0.04));
  const auto open = polyline({{0.1, 0.2}, {0.2, 0.2}, {0.2, 0.3}});
  EXPECT_TRUE(refuses([&] { flow({.faces = open, .density = 500}); }, {"body 0", "not closed"}));
  EXPECT_TRUE(refuses([&] { flow({.faces = {}, .density = 500}); }, {"body 0", "no volume"}));
  EXPECT_TRUE(refuses([&] { flow({.faces = box}); }, {"body 0: density", "0"}));
  EXPECT_TRUE(refuses([&] { flow({.faces = box, .density = -5}); }, {"body 0: density", "-5"}));
  EXPECT_TRUE(refuses([&] { flow({.faces = box, .density = inf}); }, {"body 0: density", "inf"}));
  EXPECT_TRUE(refuses(
      [&] {
        flow({.faces = box, .mass_properties = MassProperties<2>{.mass = 1, .centre = {0.2, 0.2}}});
      },
      {"body 0: mass_properties: inertia = 0 kg m²", "above 0"}));
  EXPECT_TRUE(refuses(
      [&] {
        flow({.faces = box,
              .mass_properties = MassProperties<2>{.mass = 1, .centre = {40, 0.2}, .inertia = 1}});
      },
      {"body 0: the centre of mass (40, 0.2) m", "of a body of"}));
  const auto eight = polyline({{0.1, 0.1}, {0.2, 0.2}, {0.2, 0.1}, {0.1, 0.21}, {0.1, 0.1}});
  EXPECT_TRUE(refuses([&] { flow({.faces = eight, .density = 500}); },
                      {"body 0: the moment of inertia", "-", "cross each other"}));
  EXPECT_TRUE(refuses([&] { flow({.faces = box, .density = 9}); },
                      {"body 0 has a mass of", "less than 0.01", "give it a larger density"}));
  EXPECT_TRUE(refuses(
      [&] {
        flow({.faces = box,
              .density = 500,
              .mass_properties = MassProperties<2>{.mass = 1, .centre = {0.2, 0.2}, .inertia = 1}});
      },
      {"body 0: density = 500", "mass_properties", "one of them"}));
  EXPECT_TRUE(refuses(
      [&] {
        flow({.faces = faces_of_box(Vec<2>(0.2, 0.2), Vec<2>(0.005, 0.009)), .density = 500});
      },
      {"body 0 is 0.018 m large", "less than the spacing"}));
  EXPECT_TRUE(refuses([&] { flow({.faces = box, .density = 500, .velocity = {nan, 0}}); },
                      {"body 0: velocity", "nan"}));
  EXPECT_TRUE(
      refuses([&] { flow({.faces = box, .density = 500, .spin = inf}); }, {"body 0: spin", "inf"}));
  EXPECT_TRUE(refuses(
      [&] {
        flow({.faces = box, .density = 500, .load = [](const auto&, double) {
                return BodyLoad<2>{.force = {nan, 0}};
              }});
      },
      {"body 0: load: force", "nan"}));
  EXPECT_TRUE(refuses(
      [&] {
        auto flat = box;
        flat[2].corners[1] = flat[2].corners[0];
        flow({.faces = flat, .density = 500});
      },
      {"body 0: face 2", "remove it"}));
  EXPECT_TRUE(refuses(
      [&] {
        auto crossed = box;
        crossed[0].corners[1] = {0.3, 0.1};
        flow({.faces = crossed, .density = 500});
      },
      {"body 0", "not closed at"}));
}

// The only test of what bodies may have in them, and across their faces, before the first step.
TEST(FloatingBodies, BeginWhereNothingElseIs) {
  const auto box = [](const Vec<2>& lower, const Vec<2>& upper) {
    return faces_of_box(Vec<2>((lower + upper) / 2), Vec<2>((upper - lower) / 2));
  };
  const auto begin = [](const std::vector<mps::FloatingBody<2>>& bodies) {
    mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
    settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.4, 0}, {0.4, 1}});
    settings.walls.moving_2d = mps::MovingWalls<2>{.bodies = bodies};
    Simulation sim{fluid_at(lattice<2>({{0, 0}, {0.4, 0.1}}, l0)), UniformGrid<2>{},
                   mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
    sim.step();
  };
  const MassProperties<2> mass{.mass = 5, .centre = {0.2, 0.3}, .inertia = 0.01};
  // Fluid in it: not in a solid, but in a hull.
  const auto sunk = box({0.1, 0.04}, {0.3, 0.3});
  EXPECT_TRUE(refuses([&] { begin({{.faces = sunk, .density = 500}}); },
                      {"fluid at (0.11, 0.05) m is inside of body 0", "remove_inside", "hull"}));
  EXPECT_NO_THROW(begin({{.faces = sunk, .mass_properties = mass}}));
  // Bodies and walls: not through each other, nor in each other, but side by side.
  const auto first = box({0.1, 0.2}, {0.2, 0.3});
  EXPECT_TRUE(refuses([&] { begin({{.faces = box({-0.1, 0.2}, {0.1, 0.3}), .density = 500}}); },
                      {"body 0 and a wall at rest go through each other at (0, 0.2"}));
  const auto with_first = [&](const std::vector<Face<2>>& other, bool is_hull = false) {
    mps::FloatingBody<2> outer{.faces = first, .density = 500};
    if (is_hull) outer = {.faces = first, .mass_properties = mass};
    begin({outer, {.faces = other, .density = 500}});
  };
  EXPECT_TRUE(refuses([&] { with_first(box({0.15, 0.25}, {0.3, 0.35})); },
                      {"body 0 and body 1 go through each other"}));
  for (const auto& other :
       {box({0.15, 0.2}, {0.25, 0.3}), first, box({0.14, 0.24}, {0.16, 0.26})}) {
    EXPECT_TRUE(refuses([&] { with_first(other); }, {"is inside of body", "do not overlap", "mass_properties"}));
  }
  EXPECT_NO_THROW(with_first(box({0.14, 0.24}, {0.16, 0.26}), true));
  EXPECT_NO_THROW(with_first(box({0.2, 0.2}, {0.3, 0.3})));
}

// The only test of a body that touches a wall from the beginning, and is pressed against it: within
// a step, its velocity changes until it fits the load, and it must not creep through the floor
// meanwhile.
TEST(FloatingBodies, StayWhereTheyArePressedAgainstAFloor) {
  const Vec<2> centre(0.15, 0.1);
  auto sim = Scene<2>{
      .size = {0.4, 0.4},
      .depth = 0.1,
      .bodies = {
          {.faces = faces_of_box(centre, Vec<2>(0.05, 0.1)),
           .density = 500,
           .load = [](const auto&, double) {
             return BodyLoad<2>{.force = {0, -400}};
           }}}}.simulation();
  while (sim.time() < 0.1) sim.step();
  const auto state = sim.interaction().walls().bodies()[0].state();
  EXPECT_LT((state.position - centre).norm(), 1e-3 * l0);
}

// The only test of a body at a periodic side, where fluid would see through it.
TEST(FloatingBodies, KeepOffPeriodicSides) {
  const auto step = [](double from, double to) {
    mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
    settings.walls.segments = polyline({{-1, 0}, {2, 0}});
    settings.walls.moving_2d =
        mps::MovingWalls<2>{.bodies = {{.faces = faces_of_box(Vec<2>((from + to) / 2, 0.3),
                                                              Vec<2>((to - from) / 2, 0.04)),
                                        .density = 500}}};
    const Box<2> box{.lower = {0, -1}, .upper = {0.4, 1}, .periodic = {true, false}};
    Simulation sim{fluid_at(lattice<2>({{0, 0}, {0.4, 0.1}}, l0), box), UniformGrid<2>{},
                   mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
    sim.step();
  };
  EXPECT_TRUE(refuses([&] { step(0.25, 0.35); },
                      {"body 0 extends from 0.25 to 0.35 m along axis 0", "periodic side"}));
  EXPECT_TRUE(refuses([&] { step(0.25, 0.6); }, {"body 0", "periodic side"}));
  EXPECT_NO_THROW(step(0.1, 0.3));
  EXPECT_NO_THROW(step(-0.2, 0.6));
}

// The only test of finite loads that nothing resolves.
TEST(FloatingBodies, RefuseLoadsThatNothingResolves) {
  const auto run = [](double force, double dt) {
    auto sim = Scene<2>{
        .size = {1, 1},
        .depth = 4 * l0,
        .bodies = {
            {.faces = faces_of_box(Vec<2>(0.5, 0.5), Vec<2>(0.04, 0.06)),
             .density = 500,
             .load = [=](const auto&, double) {
               return BodyLoad<2>{.force = {force, 0}};
             }}}}.simulation();
    for (int k = 0; k < 5; ++k) dt > 0 ? sim.step(dt) : sim.step();
  };
  for (const double dt : {0.0, 1e-3}) {
    EXPECT_TRUE(
        refuses([&] { run(1e8, dt); }, {"body 0 moves by", "more than the spacing", "load"}));
  }
}

}  // namespace
}  // namespace silt::test::floating_bodies_test
