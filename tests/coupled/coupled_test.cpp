// SPDX-License-Identifier: MIT
// Grains in water that does not resolve them: volume and momentum are kept, a step is undone in
// both, and what does not fit is refused.
#include <silt/coupled.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/file.hpp>
#include <silt/io/vtk.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::test::coupled_test {
namespace {

constexpr double l0 = 0.02;    // [m]
constexpr double g = 9.81;     // [m/s²]
constexpr double depth = 0.2;  // of the water [m]
constexpr double side = 0.16;  // of the tank [m]

/// Drag per metre of depth.
struct DragOfDiscs {
  double factor = 10;
  double coefficient(const coupled::GrainInFluid& at) const {
    return factor * at.viscosity / at.fluid_fraction + 100 * at.speed * at.diameter;
  }
};
/// Fails after some steps of the grains.
struct FailsLater {
  static inline int steps_left = std::numeric_limits<int>::max();
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P&, S&, double) const {
    if (steps_left-- <= 0) fail("FailsLater: no steps are left");
  }
};
template <int Dim>
using Drag = std::conditional_t<Dim == 2, DragOfDiscs, coupled::GidaspowDrag>;

/// A tank of water with grains.
template <int Dim, class Law = Drag<Dim>>
struct Scene {
  double diameter = 0.5 * l0;
  double density = 2650;
  double viscosity = 1e-6;
  Vec<Dim> gravity_of_grains = -g * Vec<Dim>::Unit(Dim - 1);
  std::vector<Vec<Dim>> grains = {};
  bool periodic_grains = false;
  double contact_stiffness = Dim == 2 ? 1e3 : 10;
  coupled::FluidForceCoefficients coefficients = {};

  static Box<Dim> box() {
    Box<Dim> box;
    box.lower.setConstant(-5 * l0);
    box.upper.setConstant(1);
    return box;
  }
  auto grain_simulation() const {
    Box<Dim> of_grains = box();
    if (periodic_grains) of_grains.periodic[0] = true;
    coupled::GrainsInFluid<Dim> all(of_grains);
    for (const auto& x : grains) {
      dem::add_grain(all, x, {.radius = diameter / 2, .density = density});
    }
    const dem::CundallStrack law{.normal_stiffness = contact_stiffness,
                                 .tangential_stiffness = contact_stiffness / 2,
                                 .restitution = 0.5};
    const dem::Plane<Dim> floor{.normal = Vec<Dim>::Unit(Dim - 1)};
    return Simulation{all, NeighbourList<Dim>{},
                      Forces{dem::Contacts{law, floor}, Gravity<Dim>{gravity_of_grains},
                             FailsLater{}, coupled::FluidForces{Law{}, coefficients}},
                      Leapfrog{}};
  }
  auto fluid_simulation() const {
    mps::FluidInMixture<Dim> water(box());
    Vec<Dim> size = Vec<Dim>::Constant(side), filled = size;
    filled[Dim - 1] = depth;
    size[Dim - 1] = 2 * depth;
    for (const auto& x : lattice<Dim>({.lower = Vec<Dim>::Zero(), .upper = filled}, l0)) {
      const Index i = mps::add_particle(water, x, mps::Kind::fluid);
      water[mps::pressure][i] = 1000 * g * (depth - x[Dim - 1]);
    }
    const Box<Dim> tank{.lower = Vec<Dim>::Zero(), .upper = size};
    mps::FlowSettings<Dim, mps::InMixture<>> settings{.spacing = l0};
    settings.viscosity = viscosity;
    settings.speed_scale = std::sqrt(g * depth);
    if constexpr (Dim == 2) {
      settings.walls.segments = faces_of(tank, Sides<2>::open());
    } else {
      settings.walls.triangles = faces_of(tank, Sides<3>::open());
    }
    return Simulation{water, UniformGrid<Dim>{}, mps::Flow<mps::InMixture<>, Dim>{settings},
                      SemiImplicit<>{}};
  }
  auto coupled() const { return coupled::Coupled{grain_simulation(), fluid_simulation()}; }
};

/// Grains everywhere, also beside the walls and on the surface.
template <int Dim>
std::vector<Vec<Dim>> scattered(double distance, double top) {
  std::vector<Vec<Dim>> points;
  Vec<Dim> upper = Vec<Dim>::Constant(side);
  upper[Dim - 1] = top;
  double shift = 0;
  for (Vec<Dim> x : lattice<Dim>({.lower = Vec<Dim>::Zero(), .upper = upper}, distance)) {
    shift = std::fmod(shift + 0.382, 1.0);
    x[0] += 0.1 * distance * (shift - 0.5);
    points.push_back(x);
  }
  return points;
}

template <class P>
Vec<P::dimension> momentum(const P& particles, double mass_of_fluid) {
  Vec<P::dimension> sum = Vec<P::dimension>::Zero();
  for (Index i = 0; i < particles.size(); ++i) {
    double m = mass_of_fluid;
    if constexpr (HasFields<P, mass_t>) m = particles[mass][i];
    sum += m * particles[velocity][i];
  }
  return sum;
}

template <class D>
class Coupled : public ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Coupled, Dimensions);

TYPED_TEST(Coupled, KeepsTheVolumeOfGrains) {
  // The only test of ε: what the particles lack is the volume of all grains in the water.
  constexpr int Dim = TypeParam::value;
  auto both = Scene<Dim>{.grains = scattered<Dim>(1.3 * l0, depth)}.coupled();
  const auto expect_volume = [&] {
    const auto& grains = std::as_const(both.grains()).particles();
    double given = 0, all = 0, found = 0;
    for (Index k = 0; k < grains.size(); ++k) {
      all += dem::volume_of<Dim>(grains[radius][k]);
      given += grains[coupled::immersion][k] * dem::volume_of<Dim>(grains[radius][k]);
    }
    for (const double epsilon : std::as_const(both.fluid()).particles()[mps::fluid_fraction]) {
      found += std::pow(l0, Dim) * (1 / epsilon - 1);
    }
    EXPECT_NEAR(found, given, 1e-13 * given);
    return given / all;
  };
  EXPECT_EQ(expect_volume(), 1);  // the surface is not known before the first step
  both.step();
  both.step();
  EXPECT_GT(expect_volume(), 0.9);
}

TYPED_TEST(Coupled, KeepMomentum) {
  // The only test that what grains and fluid exchange has no sum: their momentum changes by gravity
  // and walls alone. These act on the fluid where its momentum_changes() say.
  constexpr int Dim = TypeParam::value;
  // Without viscosity, as images in walls resist it.
  auto both = Scene<Dim, DragOfDiscs>{.viscosity = 0,
                                      .grains = scattered<Dim>(1.7 * l0, 0.7 * depth),
                                      .coefficients = {.added_mass = 0.5, .lift = 0.5}}
                  .coupled();
  const double m = 1000 * std::pow(l0, Dim);
  for (int step = 0; step < 8; ++step) {
    const Vec<Dim> before =
        momentum(both.grains().particles(), 0) + momentum(both.fluid().particles(), m);
    const double begin = both.time();
    both.step();
    if (step == 0) continue;  // velocities of grains were not yet half a step back
    const double dt = both.time() - begin;
    const auto& grains = std::as_const(both.grains()).particles();
    const auto& forces = both.grains().interaction().template part<3>();
    double mass_of_grains = 0;
    for (const double each : grains[mass]) mass_of_grains += each;
    Vec<Dim> impulse =
        -g *
        (mass_of_grains * forces.acted_for() + m * double(both.fluid().particles().size()) * dt) *
        Vec<Dim>::Unit(Dim - 1);
    const double largest = impulse.norm();
    for (const auto& change : both.fluid().interaction().momentum_changes()) {
      impulse += m * change.velocity_change;
    }
    const Vec<Dim> after = momentum(grains, 0) + momentum(both.fluid().particles(), m);
    EXPECT_LT((after - before - impulse).norm(), 1e-12 * largest);
  }
}

TYPED_TEST(Coupled, CloseTheirEnergies) {
  // The only test of the energy balance of both: kinetic energies change by the work of all forces,
  // and what the exchange takes from both is lost.
  constexpr int Dim = TypeParam::value;
  for (const double added_mass : {0.0, 0.5}) {
    auto both = Scene<Dim, DragOfDiscs>{.diameter = l0,
                                        .grains = scattered<Dim>(1.2 * l0, 3 * l0),
                                        .contact_stiffness = Dim == 2 ? 1e5 : 1e3,
                                        .coefficients = {.added_mass = added_mass, .lift = 0.5}}
                    .coupled();
    for (auto&& v : both.grains().particles()[velocity]) v[Dim - 1] = -0.3;
    both.run({.until = 0.03});
    const coupled::CoupledEnergy energy = both.energy();
    const auto& of_grains = energy.grains;
    const double largest =
        std::max({std::abs(of_grains.by_pressure), std::abs(of_grains.by_contacts),
                  std::abs(of_grains.potential), std::abs(energy.fluid.initial)});
    EXPECT_NEAR(of_grains.kinetic, kinetic_energy(std::as_const(both.grains()).particles()),
                1e-12 * largest);
    EXPECT_LT(std::abs(energy.imbalance()), 1e-10 * largest);
    EXPECT_LT(of_grains.by_contacts, 0);
    EXPECT_NEAR(energy.fluid.by_force, 0, 1e-10 * largest);
    EXPECT_NEAR(energy.fluid.added, 0, 1e-10 * largest);
    EXPECT_GT(std::abs(energy.by_exchange_on_fluid), 1e-4 * largest);
    EXPECT_GT(energy.lost_by_exchange(), added_mass > 0 ? -largest : 0);
  }
}

TYPED_TEST(Coupled, AccelerateALightGrainWithItsAddedMass) {
  // The only test of the added mass: a light grain rises at first with (ρ − ρ_g)/(ρ_g + Cₘ ρ) g.
  constexpr int Dim = TypeParam::value;
  auto both = Scene<Dim, coupled::NoDrag>{.diameter = 0.1 * l0,
                                          .density = 100,
                                          .grains = {Vec<Dim>::Constant(0.43 * side)},
                                          .coefficients = {.added_mass = 0.5}}
                  .coupled();
  EXPECT_LT(both.let_fluid_settle(), 1e-4);
  const auto speed = [&] { return both.grains().snapshot()[velocity][0][Dim - 1]; };
  const auto take_steps = [&](int number) {
    for (int step = 0; step < number; ++step) both.step(2e-4);
  };
  take_steps(4);  // of another length than those in which the fluid came to rest
  const double begin = both.time(), before = speed();
  take_steps(8);
  EXPECT_NEAR((speed() - before) / (both.time() - begin), 900.0 / 600 * g, 0.02 * 900.0 / 600 * g);
}

TYPED_TEST(Coupled, LetALightGrainRiseSteadily) {
  // The only test of stiff drag that grows with the speed: it does not swing about its final one.
  constexpr int Dim = TypeParam::value;
  using Law = std::conditional_t<Dim == 2, DragOfDiscs, coupled::SchillerNaumann>;
  Vec<Dim> x = Vec<Dim>::Constant(0.43 * side);
  x[Dim - 1] = l0;
  auto both = Scene<Dim, Law>{.diameter = 0.25 * l0, .density = 50, .grains = {x}}.coupled();
  both.let_fluid_settle();
  double slowest = 1e9, fastest = 0;
  for (int step = 0; step < 16; ++step) {
    both.step();
    if (step < 8) continue;
    const double speed = std::as_const(both.grains()).particles()[velocity][0][Dim - 1];
    slowest = std::min(slowest, speed);
    fastest = std::max(fastest, speed);
  }
  EXPECT_LT(fastest, 1.15 * slowest);
}

TYPED_TEST(Coupled, MayLoseParticles) {
  // The only test of particles of both that leave their boxes within a step, and of their energy.
  constexpr int Dim = TypeParam::value;
  Scene<Dim, DragOfDiscs> scene{.grains = scattered<Dim>(2 * l0, depth),
                                .coefficients = {.added_mass = 0.5}};
  scene.grains.push_back(Vec<Dim>::Constant(side / 2));
  scene.grains.back()[Dim - 1] = depth + 0.45 * l0;  // leaves in the first step
  auto grains = scene.grain_simulation();
  auto fluid = scene.fluid_simulation();
  Box<Dim> box = scene.box();
  box.upper[Dim - 1] = depth + l0 / 2;
  box.on_escape = OnEscape::remove;
  const auto throw_up = [&](auto& particles) {
    particles.set_box(box);
    for (auto&& v : particles[velocity]) v[Dim - 1] = 1;
    return particles.size();
  };
  const Index of_grains = throw_up(grains.particles()), of_fluid = throw_up(fluid.particles());
  coupled::Coupled both{grains, fluid};
  both.run({.until = 0.04});
  EXPECT_LT(both.grains().particles().size(), of_grains);
  EXPECT_LT(both.fluid().particles().size(), of_fluid);
  const coupled::CoupledEnergy energy = both.energy();
  EXPECT_LT(std::abs(energy.imbalance()), 1e-10 * std::abs(energy.fluid.initial));
}

TYPED_TEST(Coupled, LiftAGrainInAShear) {
  // The only test of the lift: C_L ρ V (u − v) × ω, with the vorticity of a linear u.
  constexpr int Dim = TypeParam::value, up = Dim - 1;
  const double rate = 2;  // [1/s]
  auto both = Scene<Dim, coupled::NoDrag>{.grains = {Vec<Dim>::Constant(0.43 * side)},
                                          .coefficients = {.lift = 0.5}}
                  .coupled();
  auto& fluid = both.particles();
  for (Index i = 0; i < fluid.size(); ++i) fluid[velocity][i][0] = rate * fluid[position][i][up];
  both.step(1e-6);
  const auto& grains = std::as_const(both.grains()).particles();
  const double u = grains[coupled::fluid_velocity][0][0];
  const double expected = 1e-6 * 0.5 * 1000 * dem::volume_of<Dim>(0.25 * l0) * u * rate;
  EXPECT_NEAR(grains[coupled::exchanged_impulse][0][up], expected, 1e-6 * expected);
}

TYPED_TEST(Coupled, LeaveAGrainOfTheDensityOfWaterAtRest) {
  // The only test of buoyancy without drag: at rest it is −V ∇P, and that is the weight.
  constexpr int Dim = TypeParam::value;
  Vec<Dim> x = Vec<Dim>::Constant(0.43 * side);
  auto both = Scene<Dim>{.density = 1000, .grains = {x}}.coupled();
  EXPECT_LT(both.let_fluid_settle(), 1e-4);
  const auto at_first = both.grains().snapshot();
  EXPECT_EQ(at_first[velocity][0].norm(), 0);  // no step, of which the length is 0
  both.run({.until = 0.1});
  const auto& grains = std::as_const(both.grains()).particles();
  EXPECT_LT((grains[position][0] - x).norm(), 1e-3 * l0);
  EXPECT_LT(grains[velocity][0].norm(), 1e-3 * std::sqrt(g * l0));
}

TYPED_TEST(Coupled, HaveTheSameBitsOnAnyThreadsAfterARestartAndAFailedStep) {
  // The only test of the state of both: threads, checkpoint, and what a step undoes in both.
  constexpr int Dim = TypeParam::value;
  const auto begin = [] {
    return Scene<Dim, DragOfDiscs>{.grains = scattered<Dim>(1.5 * l0, 0.8 * depth)}.coupled();
  };
  const auto hash = [](const auto& both) {
    std::vector<double> numbers{both.time()};
    const auto add = [&](const auto& particles) {
      for (Index i = 0; i < particles.size(); ++i) {
        for (const double x : particles[position][i]) numbers.push_back(x);
        for (const double u : particles[velocity][i]) numbers.push_back(u);
      }
    };
    add(both.grains().particles());
    const auto& fluid = std::as_const(both.fluid()).particles();
    add(fluid);
    for (Index i = 0; i < fluid.size(); ++i) {
      for (const double a : fluid[mps::momentum_exchange][i]) numbers.push_back(a);
      numbers.insert(numbers.end(), {fluid[mps::fluid_fraction_rate][i], fluid[mps::response][i]});
    }
    return numbers;
  };
  auto first = begin();
  const Folder folder;
  for (int step = 0; step < 6; ++step) {
    if (step == 3) write_checkpoint(folder.path / "both.silt", first);
    first.step();
  }
  for (const int threads : {1, 3}) {
    use_threads(threads);
    auto second = begin();
    for (int step = 0; step < 6; ++step) {
      if (step == 2 || step == 4) {
        const auto before = hash(second);
        if (step == 2) {
          // The grains go their way, and then the flow refuses the step.
          EXPECT_THROW(second.step(0.1), Error);
        } else {
          // The grains fail in one of their steps.
          const auto steps_of_grains = second.grains().steps();
          FailsLater::steps_left = 3;
          EXPECT_THROW(second.step(), Error);
          FailsLater::steps_left = std::numeric_limits<int>::max();
          EXPECT_EQ(second.grains().steps(), steps_of_grains);
        }
        EXPECT_EQ(before, hash(second));
      }
      second.step();
    }
    EXPECT_EQ(hash(first), hash(second)) << threads;
    auto third = begin();
    read_checkpoint(folder.path / "both.silt", third);
    for (int step = 3; step < 6; ++step) third.step();
    EXPECT_EQ(hash(first), hash(third)) << threads;
  }
  use_threads(1);
}

struct CountsSteps {
  std::uint64_t steps = 0;
  template <class Sim>
  void after_step(const Sim& simulation, const silt::Run&) {
    steps = simulation.steps();
  }
};
struct RemovesOne {
  template <class Sim>
  void before_step(Sim& fluid) const {
    if (fluid.steps() == 1) fluid.particles().remove_if([](Index i) { return i == 0; });
  }
};

TEST(CoupledObservers, SeeTheSimulationTheyAreOf) {
  // The only test of OfGrains and OfFluid, and of a series of frames of both.
  auto both = Scene<2>{.grains = {Vec<2>(0.43 * side, 0.43 * side)}}.coupled();
  const Folder folder;
  Index outputs = 0;
  auto counts = [&](const auto& simulation) {
    EXPECT_EQ(simulation.particles().size(), 1u);
    ++outputs;
  };
  const Index before = both.fluid().particles().size();
  coupled::OfFluid steps{CountsSteps{}};
  both.run({.until = 2.5 * both.time_step()}, coupled::OfGrains{counts}, steps,
           coupled::OfFluid{RemovesOne{}}, VtkSeries{folder.path / "both"});
  EXPECT_EQ(outputs, 2u);
  EXPECT_EQ(steps.observer().steps, both.fluid().steps());
  EXPECT_EQ(both.fluid().particles().size(), before - 1);
  const std::string list = file::read("test", folder.path / "both.pvd");
  for (const std::string entry : {"timestep=\"0\" part=\"0\" file=\"both/both_grains_000000.vtu\"",
                                  "part=\"1\" file=\"both/both_fluid_000001.vtu\""}) {
    EXPECT_NE(list.find(entry), std::string::npos) << list;
  }
  const std::string frame = file::read("test", folder.path / "both" / "both_grains_000001.vtu");
  EXPECT_NE(frame.find("NumberOfPoints=\"1\""), std::string::npos);
}

TEST(CoupledChecks, RefuseWhatDoesNotFit) {
  // The only test of these refusals.
  const Vec<3> middle = Vec<3>::Constant(side / 2);
  const auto refuses_scene = [](const Scene<3>& scene, const std::vector<std::string>& words) {
    return refuses([&] { scene.coupled(); }, words);
  };
  EXPECT_TRUE(refuses_scene({.diameter = 1.1 * l0, .grains = {middle}},
                            {"diameter of 0.022", "floating body"}));
  EXPECT_TRUE(refuses_scene({.viscosity = 0, .grains = {middle}}, {"viscosity = 0", "NoDrag"}));
  EXPECT_TRUE(refuses_scene({.gravity_of_grains = {0, 0, -1}, .grains = {middle}},
                            {"gravity is (0, 0, -1)", "give both the same"}));
  EXPECT_TRUE(refuses_scene({.grains = {middle}, .periodic_grains = true},
                            {"along axis 0", "not periodic alike"}));
  EXPECT_TRUE(refuses_scene({.grains = {Vec<3>(side, middle[1], middle[2])}},
                            {"on a wall of the flow", "move it"}));
  // Far more of them than fit.
  EXPECT_TRUE(refuses_scene({.diameter = l0, .grains = scattered<3>(0.5 * l0, depth)},
                            {"fluid fraction of", "closest packing, 0.2595"}));
  EXPECT_TRUE(refuses([] { coupled::FluidForces(coupled::StokesDrag{}, {.added_mass = 1e300}); },
                      {"added_mass = 1e+300", "0 to 100"}));
  auto grains = Scene<3>{.grains = {middle}}.grain_simulation();
  grains.run({.until = 1e-3});
  EXPECT_TRUE(refuses([&] { coupled::Coupled(grains, Scene<3>{}.fluid_simulation()); },
                      {"the grains are at 0.001", "begin at the same time"}));
  auto both = Scene<3>{.grains = {middle}}.coupled();
  both.step();
  EXPECT_TRUE(
      refuses([&] { both.let_fluid_settle(); }, {"let_fluid_settle() was called after a step"}));
}

TEST(MakeRoom, RemovesAsMuchWaterAsGrainsDisplace) {
  // The only test of the number of particles that make_room() removes.
  const Scene<3> scene{.grains = scattered<3>(0.6 * l0, 0.5 * depth)};
  auto water = scene.fluid_simulation().particles();
  const auto grains = scene.grain_simulation().particles();
  double volume = 0;
  for (const double R : grains[radius]) volume += dem::volume_of<3>(R);
  const Index before = water.size();
  const Index removed = coupled::make_room(water, grains, {.spacing = l0});
  EXPECT_EQ(before - water.size(), removed);
  EXPECT_NEAR(double(removed), volume / (l0 * l0 * l0), 0.51);
}

}  // namespace
}  // namespace silt::test::coupled_test
