// SPDX-License-Identifier: MIT
// Grains: runs like those of the examples, stopped at random steps, with every search, in 2D and
// 3D, in double and single precision.
#include "support/random_restarts.hpp"

#include <silt/dem.hpp>
#include <silt/dem/setup/inflow.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/dem/wall/polyline.hpp>
#include <silt/dem/wall/round_walls.hpp>
#include <silt/measure/profiles.hpp>
#include <silt/measure/timed.hpp>

#include "support/any_law.hpp"
#include "support/grains.hpp"
#include "support/restarted_grains.hpp"
#include "support/warm_particles.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

namespace silt::test::random_restarts_slow_test {
namespace {

struct Case {
  std::string name;
  std::function<void(RandomRestarts)> check;
};
void PrintTo(const Case& one, std::ostream* to) { *to << one.name; }

const dem::CundallStrack stone{.normal_stiffness = 2e5,
                               .tangential_stiffness = 1e5,
                               .restitution = 0.5,
                               .friction_angle = 0.5};

template <int Dim, class Real = double>
Vec<Dim, Real> up(double length) {
  return Real(length) * Vec<Dim, Real>::Unit(Dim - 1);
}
template <int Dim, class Real = double>
Gravity<Dim, Real> earth() {
  return Gravity<Dim, Real>{up<Dim, Real>(-9.81)};
}

// A tower that is hit by a falling grain, as in broken_tower and quickstart_tower.
void tower(const RandomRestarts& restarts) {
  constexpr double R = 0.02;
  auto grains =
      dem::make_grains(lattice<2>({{-0.1, 0}, {0.1, 0.4}}, 2 * R), {.radius = R, .density = 2500});
  const Index last =
      dem::add_grain(grains, {0.3 * R, 0.4 + 1.2 * R}, {.radius = R, .density = 2500});
  grains[velocity][last] = {0, -2.5};
  const auto make = [&] {
    Simulation simulation{
        grains, TimedSearch{UniformGrid<2>{}},
        Forces{earth<2>(), TimedInteraction{dem::Contacts{stone, dem::Plane<2>{}}}},
        Leapfrog{GlobalDamping{.alpha = 2}}};
    dem::EnergyLedger ledger{simulation};
    return RunWith{std::move(simulation), ledger};
  };
  expect_the_same_end_after_restarts(restarts, make, UnevenStep{});
}

// A hopper of discs that is filled at the top and emptied at the bottom, as in hopper.
template <class S>
void hopper(const RandomRestarts& restarts) {
  const dem::Polyline<> left{{{-0.05, 0.12}, {-0.05, 0.03}, {-0.02, 0}}};
  const dem::Polyline<> right{{{0.05, 0.12}, {0.05, 0.03}, {0.02, 0}}};
  const dem::Blend<dem::UniformSizes> discs{.sizes = {.min_radius = 0.004, .max_radius = 0.006},
                                            .density = 2500};
  auto filled = dem::make_grains(lattice<2>({{-0.0315, 0.03}, {0.0315, 0.0615}}, 0.0105),
                                 {.radius = 0.005, .density = 2500});
  for (auto& v : filled[velocity]) v = {0, -2};
  Box<2> below;
  below.upper[1] = 0.02;
  const auto make = [&] {
    Simulation simulation{
        filled, S{},
        Forces{earth<2>(), dem::Contacts{stone, left, right}.with({.steps_per_contact = 20})},
        Leapfrog{}};
    dem::Inflow<Box<2>, dem::UniformSizes> rain{
        {.lower = {-0.05, 0.07}, .upper = {0.05, 0.12}},
        discs,
        {.number = 60, .rate = 4000, .velocity = {0, -3}, .every = 7e-4, .tries = 5, .seed = 3}};
    dem::Outflow<Box<2>> drain{below, {.every = 3e-4}};
    return RunWith{std::move(simulation), drain, rain};
  };
  const std::string end = expect_the_same_end_after_restarts(restarts, make, ChosenStep{});
  EXPECT_GT(values_of<Index>(end, "part 1/added").at(0), 5u);
  EXPECT_GT(values_of<Index>(end, "part 0/number").at(0) + (restarts.steps < 200), 0u);
}

// Spheres in a funnel of triangles, to which as many are added as there is space for.
void funnel(const RandomRestarts& restarts) {
  using Vec = silt::Vec<3, float>;
  std::vector<Triangle<float>> mesh;
  const auto corner = [](int k, float half, float height) {
    return Vec(k == 1 || k == 2 ? half : -half, k > 1 ? half : -half, height);
  };
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    const Vec a = corner(k, 0.015f, 0), b = corner(next, 0.015f, 0);
    const Vec c = corner(k, 0.05f, 0.06f), d = corner(next, 0.05f, 0.06f);
    mesh.push_back({{a, b, c}});
    mesh.push_back({{b, d, c}});
  }
  const dem::MeshWall<float> wall{mesh};
  const dem::CundallStrack soft{.normal_stiffness = 5e3,
                                .tangential_stiffness = 2e3,
                                .restitution = 0.5,
                                .friction_angle = 0.5};
  const auto make = [&] {
    Simulation simulation{dem::Grains<3, float>{}, LevelGrid<3, float>{},
                          Forces{earth<3, float>(), dem::Contacts{soft, wall}}, Leapfrog{}};
    dem::Inflow<dem::VerticalCylinder<float>, dem::UniformSizes> rain{
        {.base = {0, 0, 0.02f}, .radius = 0.02f, .height = 0.04f},
        {.sizes = {.min_radius = 0.003, .max_radius = 0.007}, .density = 2500},
        {.number = 80, .velocity = {0, 0, -2}, .every = 2e-4, .tries = 20, .seed = 4}};
    return RunWith{std::move(simulation), rain};
  };
  // Without a grain, no time step is known.
  const std::string end = expect_the_same_end_after_restarts(restarts, make, [](auto& simulation) {
    simulation.step(5e-5 + 2e-6 * double(simulation.steps() % 3));
  });
  EXPECT_GT(values_of<Index>(end, "part 0/added").at(0), 3u);
}

// Smooth spheres on a vibrating floor in a periodic cell, and profiles of their averages, as in
// vibrating_floor.
void vibrating_floor(const RandomRestarts& restarts) {
  constexpr double d = 0.1;
  const dem::Law law{dem::WaltonBraun{.loading_stiffness = 2.7e5, .restitution = 0.9}};
  const dem::Moving floor{dem::Plane<3>{},
                          dem::Vibration<3>{.amplitude = up<3>(0.01), .frequency = 40}};
  const Box<3> cell{
      .lower = {0, 0, -1}, .upper = {4.2 * d, 4.2 * d, 2}, .periodic = {true, true, false}};
  dem::Grains<3> grains(cell);
  for (const auto& x :
       lattice<3>({{0, 0, 0.01}, {4.2 * d, 4.2 * d, 0.01 + 3 * 1.05 * d}}, 1.05 * d)) {
    const Index i = dem::add_grain(grains, x, {.radius = d / 2, .density = 1200});
    Random random{.seed = 5, .id = i};
    for (int k = 0; k < 3; ++k) grains[velocity][i][k] = 2 * random.normal();
  }
  const auto make = [&] {
    Simulation simulation{
        grains, NeighbourList<3>{},
        Forces{earth<3>(), dem::Contacts{law, floor}.with({.steps_per_contact = 12})}, Leapfrog{}};
    return RunWith{
        std::move(simulation),
        Profiles<3>{{.lower = -0.1, .upper = 1.4, .count = 15, .cross_section = 0.1764}}};
  };
  expect_the_same_end_after_restarts(restarts, make, ChosenStep{});
}

struct Weight {  // acts on one grain, as in bonded_beam
  Id grain = 0;
  double load = 0;  // [N]

  template <class P>
  double reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& grains, const S&, double) const {
    accelerate_each(*this, grains);
  }
  template <class P>
  void add_forces(P& grains, Index i) const {
    if (grains.id(i) == grain) grains[force][i][1] -= load;
  }
};

// A beam that breaks, as in bonded_beam.
void beam(const RandomRestarts& restarts) {
  constexpr double R = 0.01;
  dem::Grains<2> grains;
  for (Index i = 0; i <= 10; ++i) {
    dem::add_grain(grains, {2 * R * double(i), 0}, {.radius = R, .density = 2500});
  }
  grains[mass][0] *= 1e12;
  grains[inertia][0] *= 1e12;
  dem::Bonds<2> bonds{
      {.normal_stiffness = 1e9, .tangential_stiffness = 4e8, .tensile_strength = 1e5}};
  bonds.bond_all_touching(grains, UniformGrid<2>{});
  const auto make = [&] {
    return RunWith{Simulation{grains, UniformGrid<2>{}, Forces{bonds, Weight{10, 3000}},
                              Leapfrog{GlobalDamping{.alpha = 100}}}};
  };
  const std::string end = expect_the_same_end_after_restarts(
      restarts, make, [](auto& simulation) { simulation.step(5 * simulation.time_step()); });
  EXPECT_GT(values_of<std::uint64_t>(end, "broken_in_tension").at(0) + (restarts.steps < 200), 0u);
}

// A temperature that is conducted between two steps, to the neighbours found in the last one, as in
// own_field. So many grains are sorted, and their contacts found by several threads.
void own_field(const RandomRestarts& restarts) {
  constexpr double R = 0.01;
  auto grains = dem::make_grains<temperature_t>(lattice<2>({{0, 0}, {0.64, 0.8}}, 2 * R),
                                                {.radius = R, .density = 2500});
  for (Index i = 0; i < grains.size(); ++i) {
    grains[temperature][i] = 300 + double(grains.id(i) % 7);
    grains[velocity][i] = {std::sin(double(i)), 2};
  }
  const auto make = [&] {
    return RunWith{Simulation{
        grains, UniformGrid<2>{},
        Forces{Gravity<2>{{2.5, -9.5}}, dem::Contacts{stone, dem::Plane<2>{}}}, Leapfrog{}}};
  };
  expect_the_same_end_after_restarts(restarts, make, [](auto& simulation) {
    simulation.step();
    conduct_heat(simulation, 50 * simulation.last_time_step());
  });
}

// A law without history and without a stable time step, as in own_contact_law.
struct Rubber {
  double modulus = 0;   // [Pa]
  double friction = 0;  // [-]

  template <class Contact>
  typename Contact::Vec force(const Contact& c) const {
    using Real = typename Contact::Real;
    const Real spring = Real(modulus) * std::sqrt(c.effective_radius * c.overlap) * c.overlap;
    const typename Contact::Vec drag = Real(-5) * c.tangential_velocity();
    const Real limit = std::min(Real(1), Real(friction) * spring / (drag.norm() + Real(1e-30)));
    return spring * c.normal + limit * drag;
  }
};
void own_law(const RandomRestarts& restarts) {
  const auto balls = crowd<3, float>(3, 6);
  const auto make = [&] {
    return RunWith{Simulation{
        balls, BruteForce<3, float>{},
        Forces{earth<3, float>(), dem::Contacts{Rubber{1e7, 0.5}, dem::Plane<3, float>{}}},
        Leapfrog{}}};
  };
  expect_the_same_end_after_restarts(restarts, make, [](auto& simulation) {
    const double steps = double(simulation.steps());
    simulation.step(1e-4 + 2e-5 * std::fmod(steps, 4));
    // Between two steps, the program drops another ball.
    if (simulation.steps() % 3 != 0) return;
    dem::add_grain(simulation.particles(), Vec<3, float>(0.03f, 0.03f, 0.1f + 0.01f * float(steps)),
                   pebble);
  });
}

// Spheres of two sizes and two materials that roll, slide and stick.
void two_materials(const RandomRestarts& restarts) {
  const auto law = [](double modulus, double friction) {
    const dem::Elastic elastic{.young_modulus = modulus, .poisson_ratio = 0.3};
    return dem::Law{dem::Hertz{.elastic = elastic, .restitution = 0.6},
                    dem::Mindlin{.elastic = elastic, .friction_angle = friction},
                    dem::RollingResistance{.rolling_friction = 0.1, .twisting_friction = 0.1},
                    dem::DmtAdhesion{.surface_energy = 1}};
  };
  const dem::Materials materials{law(1e7, 0.5), law(3e6, 0.2)};
  auto grains = crowd<3, double>(4, 8);
  for (Index i = 0; i < grains.size(); i += 3) grains[dem::material][i] = 1;
  const auto make = [&] {
    Simulation simulation{
        grains, NeighbourList<3, double, LevelGrid<3>>{},
        Forces{earth<3>(), dem::Contacts{materials, dem::Plane<3>{.material = 1}}}, Leapfrog{}};
    dem::EnergyLedger ledger{simulation};
    return RunWith{std::move(simulation), ledger};
  };
  expect_the_same_end_after_restarts(restarts, make, UnevenStep{});
}

// A boulder among pebbles in a rotating drum: so many have its cell in common that the list is over
// levels of sizes. From time to time, pebbles grow.
void drum(RandomRestarts restarts) {
  restarts.to_the_end = std::min<Index>(restarts.to_the_end, 10);
  restarts.further = 3;
  using Vec = silt::Vec<2, float>;
  const Vec centre(0.5f, 0.5f), boulder(0.5f, 0.42f);
  const dem::Moving wall{dem::Circle<float>{.centre = centre, .radius = 0.5f},
                         dem::Rotation<2, float>{.about = centre, .spin = 3}};
  dem::Grains<2, float> grains;
  dem::add_grain(grains, boulder, {.radius = 0.4, .density = 2500});
  for (const auto& x : lattice<2, float>({{0, 0}, {0.994f, 0.994f}}, 0.014f)) {
    if ((x - boulder).norm() < 0.4075f || (x - centre).norm() > 0.4925f) continue;
    const Index i = dem::add_grain(grains, x, {.radius = 0.0068, .density = 2500});
    grains[velocity][i] = Vec(std::sin(float(i)), -1);
  }
  const auto make = [&] {
    return RunWith{Simulation{grains, NeighbourList<2, float>{},
                              Forces{earth<2, float>(), dem::Contacts{stone, wall}}, Leapfrog{}}};
  };
  const auto step = [](auto& simulation) {
    simulation.step();
    if (simulation.steps() % 3 != 0) return;
    auto& pebbles = simulation.particles();
    for (Id id = simulation.steps(); id < pebbles.size(); id += 50) {
      pebbles[radius][pebbles.index_of(id)] *= 1.01f;
    }
  };
  const std::string end = expect_the_same_end_after_restarts(restarts, make, step);
  EXPECT_EQ(values_of<char>(end, "grid/has_levels").at(0), 1);
  EXPECT_GT(values_of<Id>(end, "particles/id").size(), 1024u);  // fewer are never sorted
}

// Grains that drift together through a periodic box without walls. Their list is rebuilt when they
// have moved relative to their mean.
void cloud(const RandomRestarts& restarts) {
  const Box<2> box{.lower = {0, 0}, .upper = {0.3, 0.3}, .periodic = {true, true}};
  dem::Grains<2> grains(box);
  Random random{.seed = 9};
  for (const auto& x : lattice<2>(box, 0.025)) {
    const Index i = dem::add_grain(grains, x, {.radius = 0.01, .density = 2500});
    grains[velocity][i] = {3 + 0.3 * random.normal(), 0.3 * random.normal()};
  }
  const auto make = [&] {
    return RunWith{Simulation{grains, NeighbourList<2>{}, dem::Contacts{stone}, Leapfrog{}}};
  };
  expect_the_same_end_after_restarts(restarts, make, UnevenStep{});
}

// Every law of the library.
void laws(RandomRestarts restarts) {
  const auto grains = crowd<2, double>(6, 1);
  restarts.number = std::max<Index>(2, restarts.number / 8);
  for (const auto& law : all_laws<2>()) {
    SCOPED_TRACE(law.name);
    restarts.seed += 1;
    const auto make = [&] {
      return RunWith{Simulation{grains, NeighbourList<2>{{.skin_fraction = 0.1}},
                                Forces{earth<2>(), dem::Contacts{law.law, dem::Plane<2>{}}},
                                Leapfrog{}}};
    };
    expect_the_same_end_after_restarts(restarts, make, ChosenStep{});
  }
}

// All parts with state at once, and enough grains for several threads.
void all_parts(RandomRestarts restarts) {
  restarts.to_the_end = std::min<Index>(restarts.to_the_end, 10);
  const RestartedGrains<2> bed({40, 28});
  dem::CundallStrack stiff = stone;  // grains fall on the bed
  stiff.normal_stiffness = 1e6;
  stiff.tangential_stiffness = 5e5;
  const auto make = [&] { return bed.make(stiff, NeighbourList<2>{}); };
  expect_the_same_end_after_restarts(restarts, make, ChosenStep{});
}

const std::vector<Case> cases{
    {"broken_tower", tower},
    {"hopper_brute_force", hopper<BruteForce<2>>},
    {"hopper_uniform_grid", hopper<UniformGrid<2>>},
    {"hopper_level_grid", hopper<LevelGrid<2>>},
    {"hopper_list", hopper<NeighbourList<2>>},
    {"hopper_list_of_levels", hopper<NeighbourList<2, double, LevelGrid<2>>>},
    {"hopper_in_space", funnel},
    {"vibrating_floor", vibrating_floor},
    {"bonded_beam", beam},
    {"own_field", own_field},
    {"own_contact_law", own_law},
    {"two_materials", two_materials},
    {"drum_with_a_boulder", drum},
    {"drifting_cloud", cloud},
    {"all_laws", laws},
    {"all_parts", all_parts},
};

class RandomRestartsOfGrains : public testing::TestWithParam<Case> {};

TEST_P(RandomRestartsOfGrains, EndLikeAnUninterruptedRun) {
  GetParam().check({.steps = 250, .number = 200, .to_the_end = 200});
}
INSTANTIATE_TEST_SUITE_P(Cases, RandomRestartsOfGrains, testing::ValuesIn(cases),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace silt::test::random_restarts_slow_test
