// SPDX-License-Identifier: MIT
// Clumps in simulations: conservation, a sphere as a clump, contacts within and between clumps,
// restarts, threads, rolling back, inflow and outflow, and the ledger. No other test has rigid
// bodies of grains.
#include <silt/dem/clump/clump_blend.hpp>
#include <silt/dem/clump/clump_leapfrog.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/vtk_clumps.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include "support/ledger.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace silt::test::clumps_test {
namespace {

constexpr double R = 0.01;
constexpr double density = 2500;

template <int Dim>
Vec<Dim> at(double x, double y, double z = 0) {
  if constexpr (Dim == 2) {
    return {x, y};
  } else {
    return {x, y, z};
  }
}
template <int Dim>
AngularVec<Dim> spinning(double x, double y, double z) {
  if constexpr (Dim == 2) {
    return z;
  } else {
    return {x, y, z};
  }
}

// Three spheres in a bent line, with three different moments of inertia.
template <int Dim>
const dem::ClumpShape<Dim>& bent() {
  static const dem::ClumpShape<Dim> shape(
      {{at<Dim>(0, 0), R}, {at<Dim>(R, 0), R}, {at<Dim>(1.8 * R, 0.9 * R), 0.8 * R}}, density);
  return shape;
}

const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 5e4,
                             .restitution = 0.6,
                             .friction_angle = 0.4};

template <int Dim>
struct Bed {
  dem::ClumpGrains<Dim> grains;
  dem::Clumps<Dim> clumps;
};
// A few clumps and single grains, which fall on each other.
template <int Dim>
Bed<Dim> bed_of_clumps(int along = 3) {
  Bed<Dim> bed;
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < along; ++j) {
      dem::ClumpPlacement<Dim> place{.position = at<Dim>(0.05 * i, 0.03 + 0.05 * j, 0.003 * j),
                                     .velocity = at<Dim>(0.3 * (j - 1), -0.2 * i, 0.1)};
      place.orientation = Orientation<Dim>{}.turned(spinning<Dim>(0.3 * i, 0.5 * j, 0.7 * i + j));
      place.spin = spinning<Dim>(20 * i, -10, 15 - 10 * j);
      bed.clumps.add(bed.grains, bent<Dim>(), place);
    }
    dem::add_grain(bed.grains, at<Dim>(0.05 * i, 0.2), {.radius = R, .density = density});
  }
  return bed;
}
template <int Dim>
auto simulation(Bed<Dim> bed) {
  return Simulation{std::move(bed.grains), UniformGrid<Dim>{},
                    Forces{dem::Contacts{law, dem::Plane<Dim>{.normal = at<Dim>(0, 1)}},
                           Gravity<Dim>{at<Dim>(0, -9.81)}},
                    dem::ClumpLeapfrog{std::move(bed.clumps), GlobalDamping{}}};
}

template <class D>
class Clumps : public ::testing::Test {};
using Dims = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Clumps, Dims);

TYPED_TEST(Clumps, DivideTheirMassAndMomentOfInertia) {
  constexpr int Dim = TypeParam::value;
  auto bed = bed_of_clumps<Dim>(1);
  const auto& shape = bent<Dim>();
  ASSERT_EQ(bed.grains.size(), 4u);
  double mass_of_spheres = 0;
  Vec<Dim> centre = Vec<Dim>::Zero();
  for (Index i = 0; i < 3; ++i) {
    const double m = bed.grains[mass][i];
    EXPECT_GT(m, 0);
    EXPECT_GT(bed.grains[inertia][i], 0.02 * m * R * R);
    EXPECT_EQ(bed.grains[dem::clump][i], bed.clumps.name(0));
    EXPECT_EQ(bed.grains[dem::clump_mass][i], shape.mass_properties().mass);
    mass_of_spheres += m;
    centre += m * bed.grains[position][i];
  }
  const auto body = bed.clumps.state(0);
  EXPECT_NEAR(mass_of_spheres / shape.mass_properties().mass, 1, 1e-12);
  EXPECT_LT((centre / mass_of_spheres - body.position).norm(), 1e-12 * R);
  EXPECT_EQ(bed.grains[dem::clump][3], 0u);
  EXPECT_EQ(bed.grains[dem::clump_mass][3], bed.grains[mass][3]);
  // Energy and angular momentum of the body: ½ M V² + ½ ω Θ ω.
  const double M = shape.mass_properties().mass;
  bed.grains.remove(bed.grains.id(3));
  const double energy = energy_of_motion(bed.grains) + bed.clumps.energy_beyond_spheres(bed.grains);
  const auto L = bed.clumps.angular_momentum(0);
  EXPECT_NEAR(energy, M * body.velocity.squaredNorm() / 2 + dot(L, body.spin) / 2, 1e-12 * energy);
}

// In the middle of nowhere, with an L and a spin about three axes.
TYPED_TEST(Clumps, FlyFreely) {
  constexpr int Dim = TypeParam::value;
  Bed<Dim> bed;
  bed.clumps.add(bed.grains, bent<Dim>(),
                 {.position = at<Dim>(1, 2, 3),
                  .velocity = at<Dim>(0.3, -0.2, 0.1),
                  .spin = spinning<Dim>(3, 4, 5)});
  auto sim = Simulation{bed.grains, UniformGrid<Dim>{}, Gravity<Dim>{at<Dim>(0, 0)},
                        dem::ClumpLeapfrog{bed.clumps}};
  const auto energy = [&] {
    const auto grains = sim.snapshot();
    return energy_of_motion(grains) + sim.integrator().clumps().energy_beyond_spheres(grains);
  };
  const auto momentum_of = [&]() -> AngularVec<Dim> {
    const auto grains = sim.snapshot();
    return angular_momentum(grains, sim.integrator().clumps().state(0).position) +
           sim.integrator().clumps().momentum_beyond_spheres(grains);
  };
  const double before = energy();
  const auto L = momentum_of();
  const int steps = SILT_SLOW_TESTS ? 100000 : 10000;
  for (int k = 0; k < steps; ++k) sim.step(1e-3);
  const double scale = std::sqrt(squared_norm(L));
  EXPECT_NEAR(energy() / before, 1, 1e-8);
  EXPECT_LT(std::sqrt(squared_norm(AngularVec<Dim>(momentum_of() - L))), 1e-12 * scale);
  // Rigid to round-off.
  const auto& x = std::as_const(sim.particles())[position];
  EXPECT_NEAR((x[1] - x[0]).norm(), R, 1e-12);
}

// Of one sphere, or disc, and not of it.
TYPED_TEST(Clumps, OfOneSphereMoveAsASphere) {
  constexpr int Dim = TypeParam::value;
  const auto fall = [](bool as_clumps) {
    Bed<Dim> bed;
    const dem::ClumpShape<Dim> sphere({{at<Dim>(0.5, 0.2, 0.1), R}}, density);
    for (int i = 0; i < 3; ++i) {
      const Vec<Dim> x = at<Dim>(0.006 * i, 0.02 + 0.03 * i, 0.002 * i);
      if (as_clumps) {
        bed.clumps.add(bed.grains, sphere, {.position = x, .spin = spinning<Dim>(1, 2, 3)});
      } else {
        const Index k = dem::add_grain(bed.grains, x, {.radius = R, .density = density});
        bed.grains[spin][k] = spinning<Dim>(1, 2, 3);
      }
    }
    auto sim = simulation(std::move(bed));
    const double dt = Dim == 2 ? 1e-4 : 2e-5;
    for (int k = 0; k < 0.1 / dt; ++k) sim.step(dt);
    return sim.snapshot();
  };
  const auto clumps = fall(true), spheres = fall(false);
  for (Index i = 0; i < 3; ++i) {
    EXPECT_LT((clumps[position][i] - spheres[position][i]).norm(), 1e-11 * R);
    EXPECT_LT((clumps[velocity][i] - spheres[velocity][i]).norm(), 1e-10);
    EXPECT_LT(std::sqrt(squared_norm(AngularVec<Dim>(clumps[spin][i] - spheres[spin][i]))), 1e-7);
  }
}

// Without walls: contacts and gravity alone change the momentum, and damping of contacts only the
// energy.
TYPED_TEST(Clumps, ConserveMomentumInContacts) {
  constexpr int Dim = TypeParam::value;
  Bed<Dim> bed;
  bed.clumps.add(bed.grains, bent<Dim>(), {.velocity = at<Dim>(1, 0.1, -0.1)});
  bed.clumps.add(bed.grains, bent<Dim>(),
                 {.position = at<Dim>(0.045, 0.004, 0.003), .spin = spinning<Dim>(3, -2, 1)});
  auto sim = simulation(std::move(bed));
  sim.interaction().template part<0>().set_wall_present(0, false);
  sim.interaction().template part<1>() = Gravity<Dim>{at<Dim>(0, 0)};
  const auto momenta = [&] {
    const auto grains = sim.snapshot();
    const AngularVec<Dim> L = angular_momentum(grains, at<Dim>(0, 0)) +
                              sim.integrator().clumps().momentum_beyond_spheres(grains);
    return std::pair(momentum(grains), L);
  };
  const auto [p, L] = momenta();
  Index most = 0;
  for (int k = 0; k < 2000; ++k) {
    sim.step(2e-5);
    most = std::max(most, sim.interaction().template part<0>().size());
  }
  const auto [p_after, L_after] = momenta();
  EXPECT_GE(most, 1u);  // never within a clump
  EXPECT_LE(most, 3u);
  EXPECT_LT((p_after - p).norm(), 1e-12 * p.norm());
  const double scale = p.norm() * R;
  EXPECT_LT(std::sqrt(squared_norm(AngularVec<Dim>(L_after - L))), 1e-6 * scale);
}

TYPED_TEST(Clumps, GiveTheSameBitsOnAnyThreadsAndAfterARestart) {
  constexpr int Dim = TypeParam::value;
  const double dt = Dim == 2 ? 1e-4 : 2e-5;
  const int steps = Dim == 2 ? 300 : 2500;
  const auto run_steps = [&](auto& sim, int number) {
    for (int k = 0; k < number; ++k) sim.step(dt);
  };
  auto one = simulation(bed_of_clumps<Dim>());
  with_threads(1, [&] { run_steps(one, 2 * steps); });
  auto many = simulation(bed_of_clumps<Dim>());
  with_threads(3, [&] { run_steps(many, steps); });
  const Folder folder;
  write_checkpoint(folder.path / "clumps.silt", many);
  auto other = simulation(bed_of_clumps<Dim>(1));
  read_checkpoint(folder.path / "clumps.silt", other);
  run_steps(many, steps);
  run_steps(other, steps);
  EXPECT_GT(one.interaction().template part<0>().size(), 0u);
  EXPECT_EQ(state_of(one.particles()), state_of(many.particles()));
  EXPECT_EQ(state_of(one.particles()), state_of(other.particles()));
  for (Index k = 0; k < one.integrator().clumps().size(); ++k) {
    EXPECT_EQ(one.integrator().clumps().state(k).velocity,
              other.integrator().clumps().state(k).velocity);
  }
}

TYPED_TEST(Clumps, BalanceTheirEnergyInEveryStep) {
  constexpr int Dim = TypeParam::value;
  auto bed = bed_of_clumps<Dim>();
  auto sim = simulation(std::move(bed));
  sim.integrator().set_damping(GlobalDamping{.alpha = 0.3});
  dem::EnergyLedger ledger(sim);
  const double dt = Dim == 2 ? 1e-4 : 2e-5;
  expect_closing(sim, ledger, Dim == 2 ? 500 : 2500, dt);
  EXPECT_LT(ledger.work().normal_dashpot, 0);
  EXPECT_LT(ledger.work().damping, 0);
  EXPECT_LT(std::abs(ledger.integration_error()), 0.01 * ledger.initial_energies().kinetic);
}

TYPED_TEST(Clumps, AreAsBeforeAfterAStepThatFails) {
  constexpr int Dim = TypeParam::value;
  auto sim = simulation(bed_of_clumps<Dim>());
  for (int k = 0; k < 5; ++k) sim.step(1e-5);
  const auto before = state_of(sim.particles());
  const auto body = sim.integrator().clumps().state(3);
  EXPECT_TRUE(refuses([&] { sim.step(0.5); }, {"time step"}));
  EXPECT_EQ(state_of(sim.particles()), before);
  EXPECT_EQ(sim.integrator().clumps().state(3).position, body.position);
  EXPECT_EQ(sim.integrator().clumps().state(3).velocity, body.velocity);
}

TYPED_TEST(Clumps, AreRemovedWithTheirSpheres) {
  constexpr int Dim = TypeParam::value;
  auto sim = simulation(bed_of_clumps<Dim>());
  sim.step(1e-5);
  auto& clumps = sim.integrator().clumps();
  const Id first = clumps.name(0), third = clumps.name(2);
  EXPECT_EQ(clumps.remove_if(sim.particles(), [](Index k) { return k % 2 == 1; }), 4u);
  EXPECT_EQ(clumps.size(), 5u);
  EXPECT_EQ(clumps.name(0), first);
  EXPECT_EQ(clumps.name(1), third);
  EXPECT_EQ(sim.particles().size(), 5 * 3u + 3u);
  sim.step(1e-5);
  clumps.add(sim.particles(), bent<Dim>(), {.position = at<Dim>(-0.1, 0.1)});
  sim.step(1e-5);
  const auto names = std::as_const(sim.particles())[dem::clump];
  sim.particles().remove_if([&](Index i) { return names[i] == third; });
  sim.step(1e-5);
  EXPECT_EQ(clumps.size(), 5u);
  sim.particles().remove(first - 1);
  EXPECT_TRUE(refuses([&] { sim.step(1e-5); }, {"dem::Clumps: the sphere 0 of the clump 1"}));
}

// A row of spheres that keeps its motion is a wall that moves: a grain in a dent of it is carried,
// and the load is their weight. Another one is pushed by a force.
TYPED_TEST(Clumps, AreDriven) {
  constexpr int Dim = TypeParam::value;
  Bed<Dim> bed;
  std::vector<Ball<Dim>> row;
  for (int k = 0; k < 5; ++k) row.push_back({at<Dim>(2 * R * k, 0), R});
  const dem::ClumpShape<Dim> bumps(row, density);
  bed.clumps.add(bed.grains, bumps, {.position = at<Dim>(0, -0.1), .velocity = at<Dim>(0.05, 0)});
  bed.clumps.add(bed.grains, bent<Dim>(), {.position = at<Dim>(1, 0)});
  const Index grain =
      dem::add_grain(bed.grains, at<Dim>(R, -0.1 + 1.75 * R), {.radius = R, .density = density});
  const double weight = 9.81 * bed.grains[mass][grain];
  const double M = bumps.mass_properties().mass, m = bent<Dim>().mass_properties().mass;
  auto sim = simulation(std::move(bed));
  sim.interaction().template part<0>().set_wall_present(0, false);
  auto& clumps = sim.integrator().clumps();
  clumps.set_drive(0, dem::ClumpDrive<Dim>::given_motion());
  clumps.set_drive(1, {.force = at<Dim>(0.5 * m, 9.81 * m)});
  dem::EnergyLedger ledger(sim);
  const double dt = Dim == 2 ? 5e-5 : 2e-5;
  sim.run({.until = 0.5, .time_step = dt}, ledger);
  EXPECT_NEAR(clumps.state(0).position[0], 0.05 * sim.time(), 1e-12);
  EXPECT_NEAR(clumps.state(0).position[1], -0.1, 1e-15);
  EXPECT_NEAR(clumps.state(1).position[0], 1 + 0.0625, 1e-4);
  EXPECT_NEAR(clumps.state(1).velocity[0], 0.25, 1e-4);
  EXPECT_NEAR(sim.snapshot()[velocity][grain][0], 0.05, 1e-3);
  EXPECT_NEAR(clumps.load(0).force[1] / (-weight - 9.81 * M), 1, 1e-3);
  const auto energy_of = [](const dem::Energies& e) { return e.kinetic + e.rotational; };
  EXPECT_NEAR(ledger.work().sum(),
              energy_of(ledger.energies()) - energy_of(ledger.initial_energies()),
              1e-9 * ledger.work().max_term());
  EXPECT_GT(ledger.work().drives, 0);
  clumps.set_velocity(0, at<Dim>(0, 0));
  sim.run({.until = 0.55, .time_step = dt});
  EXPECT_NEAR(clumps.state(0).position[0], 0.025, 2e-6);
}

// By scatter() and Inflow, from above into Outflow below.
TYPED_TEST(Clumps, FlowInAndOut) {
  constexpr int Dim = TypeParam::value;
  const dem::ClumpBlend<Dim> blend({bent<Dim>(), bent<Dim>().scaled(0.7)});
  Bed<Dim> bed;
  const Box<Dim> low{.lower = at<Dim>(-0.1, 0.05, -0.1), .upper = at<Dim>(0.1, 0.2, 0.1)};
  dem::scatter(bed.grains, bed.clumps, blend, low, {.number = 12});
  ASSERT_EQ(bed.clumps.size(), 12u);
  double smallest = 1;
  const auto x = std::as_const(bed.grains)[position];
  for (Index i = 0; i < bed.grains.size(); ++i) {
    EXPECT_GT(low.clearance(x[i]), 0);
    for (Index j = 0; j < i; ++j) {
      if (bed.grains[dem::clump][i] == bed.grains[dem::clump][j]) continue;
      smallest =
          std::min(smallest, (x[i] - x[j]).norm() - bed.grains[radius][i] - bed.grains[radius][j]);
    }
  }
  EXPECT_GT(smallest, 0);
  auto sim = simulation(std::move(bed));
  const Box<Dim> high{.lower = at<Dim>(-0.1, 0.3, -0.1), .upper = at<Dim>(0.1, 0.4, 0.1)};
  Box<Dim> beyond;
  beyond.upper = at<Dim>(INFINITY, 0.02, INFINITY);
  dem::Inflow rain(high, blend, {.number = 6, .velocity = at<Dim>(0, -2)});
  dem::Outflow drain(beyond);
  sim.interaction().template part<0>().set_wall_present(0, false);
  sim.run({.until = 0.05}, rain, drain);
  EXPECT_EQ(rain.number(), 6u);
  const std::string frame = vtk_frame_of_clumps(sim.particles(), sim.integrator().clumps());
  for (const char* name : {"clump", "orientation", "velocity", "spin"}) {
    EXPECT_NE(frame.find(message_of({"Name=\"", name, "\""})), std::string::npos) << name;
  }
  sim.run({.until = 0.4}, rain, drain);
  EXPECT_EQ(drain.number(), 18u);
  EXPECT_EQ(sim.particles().size(), 0u);
  EXPECT_EQ(sim.integrator().clumps().size(), 0u);
}

// In any direction and anywhere: in lines and planes, of different spheres, with a heavy core.
TEST(ClumpShape, DoesNotDependOnItsDirectionAndPlace) {
  const std::vector<std::vector<Ball<3>>> shapes{
      {{{0, 0, 0}, R}, {{1.5 * R, 0, 0}, 0.7 * R}},
      {{{0, 0, 0}, R}, {{1.5 * R, 0, 0}, 0.7 * R}, {{-R, 0, 0}, 0.8 * R}},
      {{{0, 0, 0}, R}, {{R, 0, 0}, R}, {{2 * R, 0, 0}, R}, {{3 * R, 0, 0}, R}, {{4 * R, 0, 0}, R}},
      {{{0, 0, 0}, R}, {{R, 0, 0}, 0.7 * R}, {{0, 1.2 * R, 0}, 0.6 * R}},
      {{{0, 0, 0}, R}, {{R, 0, 0}, 0.2 * R}, {{0, R, 0}, 0.2 * R}, {{0, -R, R}, 0.2 * R}}};
  Random random{.seed = 5};
  for (const auto& balls : shapes) {
    const dem::ClumpShape<3> given(balls, density);
    for (int k = 0; k < 20; ++k) {
      const Vec<3> axis = Vec<3>(random.normal(), random.normal(), random.normal()).normalized();
      const auto turn = rotation_about(axis, random.uniform({0, 6}));
      const Vec<3> shift = 10 * Vec<3>(random.normal(), random.normal(), random.normal());
      auto moved = balls;
      for (Ball<3>& ball : moved) ball.centre = turn * ball.centre + shift;
      const dem::ClumpShape<3> other(moved, density);
      for (std::size_t s = 0; s < balls.size(); ++s) {
        ASSERT_NEAR(other.shares()[s].mass / given.shares()[s].mass, 1, 1e-6);
        ASSERT_NEAR(other.shares()[s].inertia / given.shares()[s].inertia, 1, 1e-6);
      }
    }
  }
  const dem::ClumpShape<3> heavy({{{-2 * R, 0, 0}, R}, {{2 * R, 0, 0}, R}, {{0, 0, 0}, R / 2}},
                                 {.mass = 1, .inertia = Inertia<3>::Identity() * R * R / 100});
  EXPECT_GT(heavy.shares()[0].mass, 1e-4);
}

// Ten wrong inputs.
TEST(ClumpsRefuse, WhatIsNoClump) {
  using Shape = dem::ClumpShape<3>;
  const std::vector<Ball<3>> one{{{0, 0, 0}, R}};
  EXPECT_TRUE(refuses([&] { Shape({}, 1000); }, {"dem::ClumpShape: there are no spheres"}));
  EXPECT_TRUE(refuses([&] { Shape(one, -1); }, {"dem::ClumpShape: density = -1"}));
  EXPECT_TRUE(refuses([&] { Shape({{{0, 0, 0}, 0}}, 1); }, {"radius of a sphere = 0"}));
  MassProperties<3> given{.mass = 1, .inertia = Inertia<3>::Identity() * 1e-5};
  EXPECT_NO_THROW(Shape(one, given));
  given.centre = {0.1, 0, 0};
  EXPECT_TRUE(refuses([&] { Shape(one, given); }, {"no masses at the centres of its spheres"}));
  given.centre = {0, 0, 0};
  given.inertia(0, 0) = -1;
  EXPECT_TRUE(refuses([&] { Shape(one, given); }, {"dem::ClumpShape: mass_properties: inertia"}));
  given.mass = 0;
  EXPECT_TRUE(refuses([&] { Shape(one, given); }, {"dem::ClumpShape: mass_properties: mass = 0"}));
  EXPECT_TRUE(refuses([&] { Shape(one, 1).scaled(0); }, {"dem::ClumpShape: factor = 0"}));
  dem::ClumpGrains<3> grains;
  dem::Clumps<3> clumps;
  const Shape sphere(one, 1000);
  EXPECT_TRUE(refuses([&] { clumps.add(grains, sphere, {.position = {NAN, 0, 0}}); },
                      {"dem::ClumpPlacement: position"}));
  EXPECT_TRUE(
      refuses([&] { clumps.add(grains, sphere, {.orientation = {.quaternion = {1, 1, 0, 0}}}); },
              {"dem::ClumpPlacement: orientation: the square of the quaternion is 2"}));
  EXPECT_EQ(grains.size(), 0u);
  clumps.add(grains, Shape({{{0, 0, 0}, R}, {{R, 0, 0}, R}}, 1000), {.spin = {0, 0, 3}});
  Simulation sim{grains, UniformGrid<3>{}, Gravity<3>{{0, 0, 0}}, dem::ClumpLeapfrog{clumps}};
  EXPECT_TRUE(refuses([&] { sim.step(1); }, {"the clump 1 turns by", "in a step of 1 s"}));
  // Not those of the integrator.
  clumps.add(sim.particles(), sphere, {.position = {1, 0, 0}});
  EXPECT_TRUE(
      refuses([&] { sim.step(1e-3); }, {"belongs to the clump 3", "integrator().clumps()"}));
  EXPECT_TRUE(refuses(
      [&] {
        Simulation none{grains, UniformGrid<3>{}, Gravity<3>{{0, 0, 0}},
                        dem::ClumpLeapfrog{dem::Clumps<3>{}}};
        none.step(1e-3);
      },
      {"belongs to the clump 1"}));
  auto escaping = grains;
  Box<3> box{.lower = {-1, -1, -1}, .upper = {1, 1, 1}, .on_escape = OnEscape::remove};
  escaping.set_box(box);
  Simulation losing{escaping, UniformGrid<3>{}, Gravity<3>{{0, 0, 0}}, dem::ClumpLeapfrog{clumps}};
  EXPECT_TRUE(refuses([&] { losing.step(1e-3); }, {"OnEscape::remove"}));
  box.periodic = {true, true, true};
  box.upper = {-0.95, 1, 1};
  dem::ClumpGrains<3> narrow(box);
  dem::Clumps<3> long_ones;
  EXPECT_TRUE(
      refuses([&] { long_ones.add(narrow, Shape({{{0, 0, 0}, R}, {{2 * R, 0, 0}, R}}, 1), {}); },
              {"longer than half of the period"}));
  dem::ClumpGrains<3> massless;
  massless.add(Vec<3>(0, 0, 0), Initial{radius, R}, Initial{mass, 1.0}, Initial{inertia, 1e-5});
  Simulation odd{massless, UniformGrid<3>{}, dem::Contacts{law},
                 dem::ClumpLeapfrog{dem::Clumps<3>{}}};
  EXPECT_TRUE(refuses([&] { odd.step(1e-6); }, {"dem::Contacts: clump_mass of a grain"}));
}

}  // namespace
}  // namespace silt::test::clumps_test
