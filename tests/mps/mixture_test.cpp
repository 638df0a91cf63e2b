// SPDX-License-Identifier: MIT
// The fluid of a mixture, with given fractions ε.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/operator/own_density.hpp>
#include <silt/mps/scheme/mixture.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

namespace silt::test::mixture_test {
namespace {

constexpr double l0 = 0.05;  // [m]
constexpr double g = 9.81;   // [m/s²]

/// A tank with a layer of the fraction ε below a layer of fluid alone, each on a lattice of its
/// own.
template <int Dim>
struct Layers {
  double fraction = 1;
  int columns = 6;  // of the lower layer
  int rows = 4;     // of either one
  double radius = 3.1;

  double wide() const { return l0 / std::pow(fraction, 1.0 / Dim); }
  double length() const { return columns * wide(); }
  int upper_columns() const { return int(std::round(length() / l0)); }
  double above() const { return length() / upper_columns(); }
  double upper_row() const { return std::pow(l0, Dim) / std::pow(above(), Dim - 1); }
  double height() const { return rows * (wide() + upper_row()); }

  auto simulation() const {
    Box<Dim> box;
    box.lower.setConstant(-5 * l0);
    box.upper.setConstant(10);
    mps::FluidInMixture<Dim> fluid(box);
    const auto add = [&](int number, double across, double up, double from, double epsilon) {
      for (int k = 0; k < rows; ++k) {
        for (int j = 0; j < (Dim == 3 ? number : 1); ++j) {
          for (int i = 0; i < number; ++i) {
            Vec<Dim> x = Vec<Dim>::Constant((j + 0.5) * across);
            x[0] = (i + 0.5) * across;
            x[Dim - 1] = from + (k + 0.5) * up;
            const Index added = mps::add_particle(fluid, x, mps::Kind::fluid);
            fluid[mps::fluid_fraction][added] = epsilon;
            fluid[mps::pressure][added] = 1000 * g * (height() - x[Dim - 1]);
          }
        }
      }
    };
    add(columns, wide(), wide(), 0, fraction);
    add(upper_columns(), above(), upper_row(), rows * wide(), 1);
    Vec<Dim> size = Vec<Dim>::Constant(length());
    size[Dim - 1] = 2 * height();
    mps::FlowSettings<Dim, mps::InMixture<>> settings{.spacing = l0};
    settings.radius = settings.laplacian_radius = radius;
    settings.speed_scale = std::sqrt(g * height());
    const Box<Dim> tank{.lower = Vec<Dim>::Zero(), .upper = size};
    if constexpr (Dim == 2) {
      settings.walls.segments = faces_of(tank, Sides<2>::open());
    } else {
      settings.walls.triangles = faces_of(tank, Sides<3>::open());
    }
    return Simulation{fluid, UniformGrid<Dim>{}, mps::Flow<mps::InMixture<>, Dim>{settings},
                      SemiImplicit<>{}};
  }
};

template <class D>
class FluidInMixture : public ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(FluidInMixture, Dimensions);

TYPED_TEST(FluidInMixture, RestsWhereTheFractionJumps) {
  // The only test of bulk volumes in the operators: fluid with ε = 0.6 below fluid alone has the
  // pressure of its depth, and stays where it is.
  constexpr int Dim = TypeParam::value;
  const Layers<Dim> layers{.fraction = 0.6};
  auto sim = layers.simulation();
  sim.run({.until = 0.3});
  const double height = layers.height();
  double fastest = 0, error = 0;
  const auto& fluid = std::as_const(sim).particles();
  for (Index i = 0; i < fluid.size(); ++i) {
    fastest = std::max(fastest, fluid[velocity][i].norm());
    const double at_rest = 1000 * g * (height - fluid[position][i][Dim - 1]);
    error = std::max(error, std::abs(fluid[mps::pressure][i] - at_rest));
  }
  EXPECT_LT(fastest, 2e-3 * std::sqrt(g * height));
  EXPECT_LT(error, 2e-3 * 1000 * g * height);
}

TYPED_TEST(FluidInMixture, AloneIsAFlowWithoutFractions) {
  // The only test that ε = 1 is no mixture: the same flow, to round-off.
  constexpr int Dim = TypeParam::value;
  const Layers<Dim> layers{.rows = 2};
  auto sim = layers.simulation();
  mps::Fluid<Dim> alone(sim.particles().box());
  for (const auto& x : std::as_const(sim).particles()[position]) {
    mps::add_particle(alone, x, mps::Kind::fluid);
  }
  alone[position][3][0] += 0.1 * l0;
  sim.particles()[position][3][0] += 0.1 * l0;
  std::ranges::fill(sim.particles()[mps::pressure], 0.0);
  const auto& given = sim.interaction().settings();
  mps::FlowSettings<Dim, mps::Recommended> settings{.spacing = l0};
  settings.speed_scale = given.speed_scale;
  settings.walls = given.walls;
  Simulation other{alone, UniformGrid<Dim>{}, mps::Flow<mps::Recommended, Dim>{settings},
                   SemiImplicit<>{}};
  for (int step = 0; step < 10; ++step) {
    sim.step();
    other.step();
  }
  for (Index i = 0; i < alone.size(); ++i) {
    const Vec<Dim> away = sim.particles()[position][i] - other.particles()[position][i];
    EXPECT_LT(away.norm(), 1e-6 * l0);
    EXPECT_NEAR(sim.particles()[mps::pressure][i], other.particles()[mps::pressure][i],
                1e-4 * 1000 * g * layers.height());
  }
}

TEST(FluidFraction, IsRefusedOutOfItsRange) {
  // The only test of these refusals.
  const auto step_with = [](double fraction) {
    auto sim = Layers<2>{.rows = 2}.simulation();
    sim.particles()[mps::fluid_fraction][1] = fraction;
    sim.step();
  };
  EXPECT_TRUE(refuses([&] { step_with(0); }, {"fluid_fraction = 0", "set it"}));
  EXPECT_TRUE(refuses([&] { step_with(1.5); }, {"fluid_fraction = 1.5", "at most 1"}));
  EXPECT_TRUE(refuses([&] { step_with(0.15); },
                      {"fluid_fraction of 0.15", "2.58199 spacings apart", "at least 3.87"}));
}

TEST(OwnDensity, CompletesThatOfEveryLattice) {
  // The only test of c(V): with it, n is n0 on lattices of any spacing, also of a kernel that is
  // infinite at r = 0.
  const auto expect_completed = [](const auto& kernel) {
    using K = std::remove_cvref_t<decltype(kernel)>;
    const mps::OwnDensity<3, double> own(3.1, kernel);
    const double n0 = mps::lattice_values<3, K>(3.1).n0;
    EXPECT_EQ(own(1), 0);
    for (const double volume : {1.01, 1.3, 2.0, 3.7}) {
      const double n = volume * mps::lattice_values<3, K>(3.1 / std::cbrt(volume)).n0;
      EXPECT_NEAR((n + own(volume)) / n0, 1, 1e-4) << volume;
    }
  };
  expect_completed(mps::WendlandKernel{});
  expect_completed(mps::InverseKernel{});
}

}  // namespace
}  // namespace silt::test::mixture_test
