// SPDX-License-Identifier: MIT
// That the water around grains feels the body force of its flow within the steps of the grains,
// too: a grain of the density of water stays at rest in it, as under gravity.
#include <silt/coupled.hpp>
#include <silt/geometry/shapes.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace silt::test::body_force_test {
namespace {

constexpr double g = 9.81, lift = 0.6 * g;  // of the body force, upwards [m/s²]

struct Lift {
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& grains, S&, double) const {
    for (Index i = 0; i < grains.size(); ++i) grains[force][i][1] += grains[mass][i] * lift;
  }
};
struct StiffDrag {
  static constexpr int dimension = 2;
  static double coefficient(const coupled::GrainInFluid& at) { return 1e5 * at.viscosity; }
};

TEST(BodyForce, LeavesAGrainOfTheDensityOfWaterAtRest) {
  constexpr double l0 = 0.02, depth = 0.2, d = 0.01;
  const Box<2> box{.lower = {-0.1, -0.1}, .upper = {0.3, 1}};
  coupled::GrainsInFluid<2> grains{box};
  dem::add_grain(grains, {0.103, 0.098}, {.radius = d / 2, .density = 1000});
  mps::FluidInMixture<2> water{box};
  for (const auto& x : lattice<2>({{0, 0}, {0.2, depth}}, l0)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  mps::FlowSettings<2, mps::InMixture<>> settings{
      .spacing = l0, .speed_scale = 1.4, .body_force = [](const Vec<2>&, double) {
        return Vec<2>(0, lift);
      }};
  settings.walls.segments = faces_of(Box<2>{{0, 0}, {0.2, 0.4}}, Sides<2>::open());
  const dem::CundallStrack law{.normal_stiffness = 1e3, .restitution = 0.5};
  coupled::Coupled both{Simulation{std::move(grains), NeighbourList<2>{},
                                   Forces{dem::Contacts{law}, Gravity<2>{{0, -g}}, Lift{},
                                          coupled::FluidForces{StiffDrag{}}},
                                   Leapfrog{}},
                        Simulation{std::move(water), UniformGrid<2>{},
                                   mps::Flow<mps::InMixture<>>{settings}, SemiImplicit<>{}}};
  both.let_fluid_settle();
  double fastest = 0;
  while (both.time() < 0.2) {
    both.step();
    fastest = std::max(fastest, both.grains().particles()[velocity][0].norm());
  }
  EXPECT_LT(fastest, 1e-3 * std::sqrt(g * d));
}

}  // namespace
}  // namespace silt::test::body_force_test
