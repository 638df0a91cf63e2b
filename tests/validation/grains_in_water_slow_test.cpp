// SPDX-License-Identifier: MIT
// Grains in water that does not resolve them, compared with theory and experiment.
#include <silt/coupled.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/geometry/shapes.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace silt::test::grains_in_water_slow_test {
namespace {

constexpr double l0 = 0.02;   // [m]
constexpr double d = l0 / 2;  // of the grains [m]
constexpr double rho = 1000;  // of the water [kg/m³]
constexpr double g = 9.81;    // [m/s²]
const Vec<3> gravity{0, 0, -g};

/// A tank with water, and grains in it.
struct Scene {
  double side;
  double depth;
  double viscosity = 1e-6;

  static Box<3> box() { return {.lower = Vec<3>::Constant(-0.1), .upper = Vec<3>::Constant(2)}; }
  /// Frictionless side walls.
  auto contacts() const {
    const dem::CundallStrack law{
        .normal_stiffness = 200, .tangential_stiffness = 140, .restitution = 0.5};
    const double inf = std::numeric_limits<double>::infinity();
    const Box<3> tank{.lower = Vec<3>::Zero(), .upper = {side, side, inf}};
    return dem::Contacts{law, dem::BoxWall<3>{.box = tank}};
  }
  template <class Law>
  auto coupled(coupled::GrainsInFluid<3> grains, const Law& drag) const {
    mps::FluidInMixture<3> water(box());
    for (const auto& x : lattice<3>({Vec<3>::Zero(), Vec<3>(side, side, depth)}, l0)) {
      mps::add_particle(water, x, mps::Kind::fluid);
    }
    coupled::make_room(water, grains, {.spacing = l0});
    mps::FlowSettings<3, mps::InMixture<>> settings{.spacing = l0};
    settings.viscosity = viscosity;
    settings.speed_scale = std::sqrt(g * depth);
    settings.walls.triangles =
        faces_of(Box<3>{Vec<3>::Zero(), Vec<3>(side, side, 2 * depth)}, Sides<3>::open());
    const mps::Flow<mps::InMixture<>, 3> flow{settings};
    return coupled::Coupled{
        Simulation{std::move(grains), NeighbourList<3>{},
                   Forces{contacts(), Gravity<3>{gravity}, coupled::FluidForces{drag}}, Leapfrog{}},
        Simulation{std::move(water), UniformGrid<3>{}, flow, SemiImplicit<>{}}};
  }
};

double volume() { return dem::volume_of<3>(d / 2); }

TEST(SettlingSphere, HasTheSpeedOfItsDragLaw) {
  // The only test of the undisturbed velocity: a sphere of half a spacing, whose wake the flow has,
  // settles as if it had none.
  for (const auto& [reynolds, viscosity] : {std::pair{10.0, 1e-4}, {100.0, 2e-5}}) {
    const double speed = reynolds * viscosity / d;
    const double drag = 3 * std::numbers::pi * rho * viscosity * d *
                        coupled::SchillerNaumann::correction(reynolds) * speed;
    const Scene scene{.side = 0.2, .depth = 0.4, .viscosity = viscosity};
    coupled::GrainsInFluid<3> grains(Scene::box());
    dem::add_grain(grains, Vec<3>(0.107, 0.107, 0.34),
                   {.radius = d / 2, .density = rho + drag / (volume() * g)});
    auto both = scene.coupled(grains, coupled::SchillerNaumann{});
    both.let_fluid_settle();
    both.run({.until = 0.1 / speed});
    const double found = -both.grains().particles()[velocity][0][2];
    EXPECT_NEAR(found / speed, 1, 0.02) << "Re = " << reynolds;
    RecordProperty("Re" + std::to_string(int(reynolds)), std::to_string(found / speed));
  }
}

TEST(HinderedSettling, HasTheExponentOfRichardsonAndZaki) {
  // The only test of drag among other grains: v = v_t ε^4.65 at small Re.
  const Scene scene{.side = 8 * l0, .depth = 16 * l0, .viscosity = 1e-3};
  for (const double share : {0.1, 0.3}) {
    const double all = scene.side * scene.side * scene.depth;
    const double distance = std::cbrt(volume() / share);
    coupled::GrainsInFluid<3> grains(Scene::box());
    const Index across = Index(std::round(scene.side / distance));
    const Index number = Index(share * all / volume());
    const Index layers = (number + across * across - 1) / (across * across);
    double shift = 0;
    for (Index k = 0; k < number; ++k) {
      const auto part = [&](Index of, Index count, double length) {
        shift = std::fmod(shift + 0.618034, 1.0);
        const double gap = std::max(0.0, length / double(count) - 1.05 * d);
        return (double(of) + 0.5) * length / double(count) + gap * (shift - 0.5);
      };
      const Vec<3> x(part(k % across, across, scene.side),
                     part(k / across % across, across, scene.side),
                     part(k / (across * across), layers, scene.depth));
      dem::add_grain(grains, x, {.radius = d / 2, .density = 1.1 * rho});
    }
    auto both = scene.coupled(grains, coupled::WenYu{});
    both.let_fluid_settle();
    const double weight = volume() * 0.1 * rho * g;
    double alone = 0;  // the speed of a single sphere
    for (int k = 0; k < 100; ++k) {
      alone = (alone + weight / coupled::WenYu::coefficient({.diameter = d,
                                                             .fluid_fraction = 1,
                                                             .speed = alone,
                                                             .density = rho,
                                                             .viscosity = rho * scene.viscosity})) /
              2;
    }
    both.run({.until = 1});
    const auto& now = std::as_const(both.grains()).particles();
    double speed = 0, fraction = 0, count = 0;
    for (Index k = 0; k < now.size(); ++k) {
      if (std::abs(now[position][k][2] - scene.depth / 2) > scene.depth / 4) continue;
      speed -= now[velocity][k][2];
      fraction += now[coupled::fluid_share][k];
      count += 1;
    }
    const double exponent = std::log(speed / count / alone) / std::log(fraction / count);
    EXPECT_NEAR(exponent, 4.65, 0.465) << share;
    RecordProperty("exponent" + std::to_string(int(100 * share)), std::to_string(exponent));
  }
}

TEST(BedUnderWater, RestsWithItsBuoyantWeight) {
  // The only test of a packed bed: hydrostatic pressure in its pores, and buoyancy of all of its
  // grains.
  const Scene scene{.side = 0.2, .depth = 0.2};
  coupled::GrainsInFluid<3> grains(Scene::box());
  double shift = 0, solid = 0;
  for (Vec<3> x : lattice<3>({Vec<3>::Zero(), Vec<3>(scene.side, scene.side, 0.1)}, l0 / 1.9)) {
    for (int axis = 0; axis < 2; ++axis) {
      shift = std::fmod(shift + 0.618034, 1.0);
      x[axis] += 0.03 * d * (shift - 0.5);
    }
    const double radius_of = d / 2 * (0.9 + 0.1 * shift);
    solid += dem::volume_of<3>(radius_of);
    dem::add_grain(grains, x, {.radius = radius_of, .density = 2650});
  }
  Simulation dry{grains, NeighbourList<3>{}, Forces{scene.contacts(), Gravity<3>{gravity}},
                 Leapfrog{GlobalDamping{.alpha = 20}}};
  dry.run({.until = 1});
  auto both = scene.coupled(dry.snapshot(), coupled::GidaspowDrag{});
  both.let_fluid_settle();
  both.run({.until = 0.6});
  const auto& bed = std::as_const(both.grains()).particles();
  double buoyancy = 0;
  for (Index k = 0; k < bed.size(); ++k) buoyancy += bed[coupled::pressure_force][k][2];
  EXPECT_NEAR(buoyancy / (rho * g * solid), 1, 0.005);
  const double load = both.grains().interaction().part<0>().load_on(bed, 0).force[2];
  EXPECT_NEAR(-load / ((2650 - rho) * g * solid), 1, 0.02);
  double error = 0;
  const auto& water = std::as_const(both.fluid()).particles();
  for (Index i = 0; i < water.size(); ++i) {
    const double at_rest = rho * g * (scene.depth - water[position][i][2]);
    error += squared(water[mps::pressure][i] - at_rest) / double(water.size());
  }
  EXPECT_LT(std::sqrt(error), 0.01 * rho * g * scene.depth);
  RecordProperty("buoyancy", std::to_string(buoyancy / (rho * g * solid)));
  RecordProperty("load", std::to_string(-load / ((2650 - rho) * g * solid)));
  RecordProperty("pressure", std::to_string(std::sqrt(error) / (rho * g * scene.depth)));
}

}  // namespace
}  // namespace silt::test::grains_in_water_slow_test
