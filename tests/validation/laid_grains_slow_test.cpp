// SPDX-License-Identifier: MIT
// Grains laid into water, and carried by it, in 2D and 3D: volume, weight and velocity are exact.
#include <silt/coupled.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/measure/wall_load.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

namespace silt::test::laid_grains_slow_test {
namespace {

constexpr double rho = 1000;  // of the water [kg/m³]
constexpr double g = 9.81;    // [m/s²]

/// Drag per metre of depth, linear.
struct DragOfDiscs {
  double coefficient(const coupled::GrainInFluid& at) const { return 100 * at.diameter; }
};
template <int Dim>
using Drag = std::conditional_t<Dim == 2, DragOfDiscs, coupled::DiFelice>;

/// Adds up the load of water and grains from 1 s on.
template <int Dim>
struct LoadOnFloor {
  const WallLoad<Dim>& floor;
  double &load, &time;
  void after_step(const auto& simulation, const Run&) const {
    if (simulation.time() < 1) return;
    const double dt = simulation.last_time_step();
    const auto& bed = simulation.grains().particles();
    const double of_grains =
        simulation.grains().interaction().template part<0>().load_on(bed, 0).force[Dim - 1];
    load -= dt * (of_grains + floor.read(simulation.fluid())[Dim - 1]);
    time += dt;
  }
};

template <class D>
class GrainsInWater : public ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(GrainsInWater, Dimensions);

TYPED_TEST(GrainsInWater, RaiseTheLevelAndLoadTheFloor) {
  // The only test of grains that displace water which was not made for them: the level rises by
  // their volume, and the floor carries them and the water.
  constexpr int Dim = TypeParam::value, up = Dim - 1;
  for (const double l0 : {0.02, 0.0125}) {
    const double d = l0 / 2, side = 0.2, depth = 0.2, bed = 0.1;
    Box<Dim> box;
    box.lower.setConstant(-0.1);
    box.upper.setConstant(1);
    Vec<Dim> tank = Vec<Dim>::Constant(side), filled = tank, covered = tank;
    tank[up] = 2 * depth, filled[up] = depth, covered[up] = bed;
    const auto region = [](const Vec<Dim>& upper) {
      return Box<Dim>{.lower = Vec<Dim>::Zero(), .upper = upper};
    };
    coupled::GrainsInFluid<Dim> grains{box};
    double solid = 0;
    // With gaps: as many as water can rest between, in 2D too.
    for (const auto& x : lattice<Dim>(region(covered), 1.25 * d)) {
      dem::add_grain(grains, x, {.radius = d / 2, .density = 2650});
      solid += dem::volume_of<Dim>(d / 2);
    }
    const dem::CundallStrack law{.normal_stiffness = Dim == 2 ? 1e5 : 500, .restitution = 0.5};
    // Without friction, only the floor carries weight.
    Vec<Dim> open_above = tank;
    open_above[up] = std::numeric_limits<double>::infinity();
    const dem::Contacts contacts{law, dem::BoxWall<Dim>{.box = region(open_above)}};
    mps::FluidInMixture<Dim> water{box};
    for (const auto& x : lattice<Dim>(region(filled), l0)) {
      mps::add_particle(water, x, mps::Kind::fluid);
    }
    mps::FlowSettings<Dim, mps::InMixture<>> settings{.spacing = l0};
    settings.viscosity = 1e-6;
    settings.speed_scale = std::sqrt(g * depth);
    // Discs leave so little between them that particles are 2.6 spacings apart.
    if (Dim == 2) settings.radius = settings.laplacian_radius = 4.2;
    settings.walls.template faces<Dim>() = faces_of(region(tank), Sides<Dim>::open());
    coupled::Coupled both{Simulation{grains, NeighbourList<Dim>{},
                                     Forces{contacts, Gravity<Dim>{-g * Vec<Dim>::Unit(up)},
                                            coupled::FluidForces{Drag<Dim>{}}},
                                     Leapfrog{}},
                          Simulation{water, UniformGrid<Dim>{},
                                     mps::Flow<mps::InMixture<>, Dim>{settings}, SemiImplicit<>{}}};
    both.let_fluid_settle();
    Sides<Dim> lowest{};
    lowest.lower[up] = true;
    const WallLoad<Dim> floor{faces_of(region(tank), lowest)};
    double load = 0, time = 0;
    const LoadOnFloor<Dim> mean{floor, load, time};
    both.run({.until = 2}, mean);
    const double area = std::pow(side, up);
    const double weight = (rho * depth * area + 2650 * solid) * g;
    EXPECT_NEAR(load / time / weight, 1, 0.005) << l0;
    double level = 0, count = 0;
    for (double s = 0.5 * l0; s < side; s += l0) {
      Vec<Dim> point = Vec<Dim>::Constant(s);
      level += SurfaceHeight<Dim>{.point = point, .spacing = l0}.read(both);
      count += 1;
    }
    const double rise = level / count - depth;
    EXPECT_NEAR((depth + rise) / (depth + solid / area), 1, 0.01) << l0;
    const std::string name = std::to_string(int(std::round(l0 * 1e4)));
    this->RecordProperty("load_" + name, std::to_string(load / time / weight));
    this->RecordProperty("rise_" + name, std::to_string(rise / (solid / area)));
  }
}

TYPED_TEST(GrainsInWater, FollowAShear) {
  // The only test of grains that the water carries: one of its density has its velocity.
  constexpr int Dim = TypeParam::value, up = Dim - 1;
  for (const double l0 : {0.02, 0.0125}) {
    const double side = 10 * l0, rate = 1, d = l0 / 2;  // [m], [1/s], [m]
    Box<Dim> box;
    box.lower.setZero();
    box.upper.setConstant(side);
    box.lower[up] = -0.1, box.upper[up] = side + 0.1;
    for (int k = 0; k < up; ++k) box.periodic[std::size_t(k)] = true;
    coupled::GrainsInFluid<Dim> grains{box};
    const auto speed = [&](double height) { return rate * (height - side / 2); };
    for (const double height : {0.31 * side, 0.72 * side}) {
      Vec<Dim> x = Vec<Dim>::Constant(0.4 * side);
      x[up] = height;
      const Index k = dem::add_grain(grains, x, {.radius = d / 2, .density = rho});
      grains[velocity][k][0] = speed(height);
    }
    mps::FluidInMixture<Dim> water{box};
    for (const auto& x : lattice<Dim>({Vec<Dim>::Zero(), Vec<Dim>::Constant(side)}, l0)) {
      const Index i = mps::add_particle(water, x, mps::Kind::fluid);
      water[velocity][i][0] = speed(x[up]);
    }
    mps::FlowSettings<Dim, mps::InMixture<>> settings{.spacing = l0};
    settings.viscosity = 1e-6;
    settings.gravity.setZero();
    settings.speed_scale = rate * side;
    settings.max_time_step = 0.01;
    Box<Dim> long_box = box;
    for (int k = 0; k < up; ++k) long_box.lower[k] = -2 * side, long_box.upper[k] = 3 * side;
    long_box.lower[up] = 0, long_box.upper[up] = side;
    Sides<Dim> both_ends{};
    both_ends.lower[up] = both_ends.upper[up] = true;
    settings.walls.template faces<Dim>() = faces_of(long_box, both_ends);
    settings = mps::without_free_surface(settings);
    const dem::CundallStrack law{.normal_stiffness = Dim == 2 ? 1e4 : 100, .restitution = 0.5};
    coupled::Coupled both{
        Simulation{grains, NeighbourList<Dim>{},
                   Forces{dem::Contacts{law}, Gravity<Dim>{Vec<Dim>(Vec<Dim>::Zero())},
                          coupled::FluidForces{Drag<Dim>{}}},
                   Leapfrog{}},
        Simulation{water, UniformGrid<Dim>{}, mps::Flow<mps::InMixture<>, Dim>{settings},
                   SemiImplicit<>{}}};
    both.run({.until = 1});
    double worst = 0;
    const auto now = both.grains().snapshot();
    for (Index k = 0; k < now.size(); ++k) {
      worst = std::max(worst, std::abs(now[velocity][k][0] - speed(now[position][k][up])));
    }
    EXPECT_LT(worst, 0.01 * rate * side / 2) << l0;
    const std::string name = std::to_string(int(std::round(l0 * 1e4)));
    this->RecordProperty("difference_" + name, std::to_string(worst / (rate * side / 2)));
  }
}

}  // namespace
}  // namespace silt::test::laid_grains_slow_test
