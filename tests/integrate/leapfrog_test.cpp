// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/grains.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace silt::test::leapfrog_test {
namespace {

// A user-defined interaction: every particle on a spring to the origin.
struct SpringToOrigin {
  double omega = 1;

  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& particles, const S&, double) const {
    for (Index i = 0; i < particles.size(); ++i) {
      particles[force][i] -= omega * omega * particles[mass][i] * particles[position][i];
    }
  }
};

struct Deviation {
  double position;
  double velocity;
  double energy;
};

template <int Dim>
Deviation after_some_swings(double dt) {
  Vec<Dim> x0 = Vec<Dim>::Zero();
  Vec<Dim> v0 = Vec<Dim>::Zero();
  x0[0] = 1;
  v0[Dim - 1] = 0.5;
  Simulation sim{one_grain<Dim>(x0, v0), UniformGrid<Dim>{}, SpringToOrigin{}, Leapfrog{}};
  const double end = 8;
  sim.run({.until = end, .time_step = dt});
  const double t = sim.time();
  const auto now = sim.snapshot();
  const Vec<Dim> x = x0 * std::cos(t) + v0 * std::sin(t);
  const Vec<Dim> v = -x0 * std::sin(t) + v0 * std::cos(t);
  const double energy = (now[velocity][0].squaredNorm() + now[position][0].squaredNorm()) / 2;
  return {(now[position][0] - x).norm(), (now[velocity][0] - v).norm(),
          std::abs(energy - (x0.squaredNorm() + v0.squaredNorm()) / 2)};
}

TEST(Leapfrog, TakesAnotherDampingBetweenSteps) {
  Simulation sim{one_grain<2>({1, 0}, {0, 0.5}), UniformGrid<2>{}, SpringToOrigin{},
                 Leapfrog{GlobalDamping{.alpha = 0.2}}};
  const auto energy = [&] {
    const auto now = sim.snapshot();
    return (now[velocity][0].squaredNorm() + now[position][0].squaredNorm()) / 2;
  };
  sim.run({.until = 4, .time_step = 0.01});
  const double damped = energy();
  EXPECT_LT(damped, 0.5 * 0.625);
  sim.integrator().set_damping({.alpha = 0});
  sim.run({.until = 8, .time_step = 0.01});
  EXPECT_NEAR(energy() / damped, 1, 1e-3);
  EXPECT_TRUE(refuses([&] { sim.integrator().set_damping({.alpha = -1}); }, {"alpha = -1"}));
  EXPECT_EQ(sim.integrator().damping().alpha, 0);
}

TEST(Leapfrog, IsOfSecondOrderInPositionAndInTheVelocityOfASnapshot) {
  const Deviation coarse = after_some_swings<2>(1.0 / 16);
  const Deviation fine = after_some_swings<2>(1.0 / 32);
  const Deviation finest = after_some_swings<3>(1.0 / 64);
  EXPECT_NEAR(std::log2(coarse.position / fine.position), 2, 0.05);
  EXPECT_NEAR(std::log2(coarse.velocity / fine.velocity), 2, 0.05);
  EXPECT_NEAR(std::log2(fine.position / finest.position), 2, 0.05);
  EXPECT_NEAR(std::log2(fine.velocity / finest.velocity), 2, 0.05);
}

TEST(Leapfrog, ConservesTheEnergyOfAnOscillatorOverManyPeriods) {
  Simulation sim{one_grain<2>({1, 0}, {0, 0}), UniformGrid<2>{}, SpringToOrigin{}, Leapfrog{}};
  double least = 1;
  double most = 0;
  sim.run({.until = 2000, .output_every = 1, .time_step = 0.05}, [&](const auto& s) {
    const auto now = s.snapshot();
    const double energy = (now[velocity][0].squaredNorm() + now[position][0].squaredNorm()) / 2;
    least = std::min(least, energy);
    most = std::max(most, energy);
  });
  EXPECT_LT(most - least, 1e-3);
}

// A closed chain of springs: the force on a particle depends on the positions of its neighbours.
struct Chain {
  template <class P>
  double reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& particles, const S&, double) const {
    for (Index i = 0; i < particles.size(); ++i) pull(particles, i);
  }

 protected:
  template <class P>
  static void pull(P& particles, Index i) {
    const auto x = particles[position];
    const Index n = x.size();
    particles[force][i] += x[(i + 1) % n] + x[(i + n - 1) % n] - 2 * x[i];
  }
};
struct ChainLinkByLink : Chain {
  template <class P>
  void add_forces(P& particles, Index i) const {
    pull(particles, i);
  }
};

TEST(Leapfrog, UsesPositionsOfTheBeginningOfAStepIfForcesAreAddedByParticle) {
  const auto positions = [](auto chain) {
    dem::Grains<2> grains;
    for (const auto& x : random_points(200, cube<2, double>(0, 9), 4)) {
      dem::add_grain(grains, x, {.radius = 0.5, .density = 1});
    }
    Simulation sim{grains, UniformGrid<2>{}, chain, Leapfrog{}};
    std::vector<Vec<2>> all;
    for (int step = 0; step < 5; ++step) {
      sim.step(0.05);
      all.insert(all.end(), sim.particles()[position].begin(), sim.particles()[position].end());
    }
    return all;
  };
  EXPECT_EQ(positions(ChainLinkByLink{}), positions(Chain{}));
}

TEST(Leapfrog, IsOfSecondOrderWithAChangingTimeStep) {
  const auto deviation = [](double scale) {
    Simulation sim{one_grain<2>({1, 0}, {0, 0}), UniformGrid<2>{}, SpringToOrigin{}, Leapfrog{}};
    while (sim.time() < 6) sim.step(scale * (1 + 0.5 * std::sin(3 * sim.time())));
    return std::abs(sim.particles()[position][0][0] - std::cos(sim.time()));
  };
  EXPECT_GT(std::log2(deviation(0.02) / deviation(0.01)), 1.7);
}

TEST(Leapfrog, IsExactForFreeFall) {
  Simulation sim{one_grain<3>({0, 0, 5}, {1, 0, 2}), UniformGrid<3>{}, Gravity<3>{{0, 0, -9.81}},
                 Leapfrog{}};
  sim.run({.until = 1, .time_step = 1.0 / 64});
  const auto now = sim.snapshot();
  EXPECT_NEAR(now[position][0][0], 1, 1e-12);
  EXPECT_NEAR(now[position][0][2], 5 + 2 - 9.81 / 2, 1e-12) << "a parabola is exact";
  EXPECT_NEAR(now[velocity][0][2], 2 - 9.81, 1e-12);
}

TEST(Leapfrog, ConservesKineticEnergyInAPeriodicBoxWithoutContacts) {
  auto box = cube<2, double>(0, 1);
  box.periodic.fill(true);
  dem::Grains<2> grains(box);
  const auto v = random_points(30, cube<2, double>(-3, 3), 2);
  for (Index i = 0; i < v.size(); ++i) {
    // Each on a line of its own: no contacts.
    dem::add_grain(grains, {0.5, (double(i) + 0.5) / 30}, {.radius = 0.01, .density = 1});
    grains[velocity][i] = {v[i][0], 0};
    grains[spin][i] = v[i][1];
  }
  Simulation sim{grains, NeighbourList<2>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1}}, Leapfrog{}};
  const double before = energy_of_motion(sim.particles());
  sim.run({.until = 20, .time_step = 1.0 / 1024});
  EXPECT_EQ(energy_of_motion(sim.particles()), before);
  const auto now = sim.snapshot();
  for (const auto& x : now[position]) EXPECT_TRUE(0 <= x[0] && x[0] < 1);
}

TEST(Leapfrog, RotatesGrainsByTheirSpin) {
  auto flat = one_grain<2>({0, 0}, {0, 0});
  flat[spin][0] = 3;
  Simulation disc{flat, UniformGrid<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
  disc.run({.until = 2, .time_step = 0.125});
  EXPECT_DOUBLE_EQ(disc.particles()[angle][0], 6);
  dem::Grains<3, double, angle_t> round;
  dem::add_grain(round, {0, 0, 0}, {.radius = 0.5, .density = 1});
  round[spin][0] = {1, -2, 3};
  Simulation sphere{round, UniformGrid<3>{}, Gravity<3>{{0, 0, 0}}, Leapfrog{}};
  sphere.run({.until = 2, .time_step = 0.125});
  EXPECT_EQ(sphere.particles()[angle][0], Vec<3>(2, -4, 6));
}

// --- global damping ------------------------------------------------------------------------------

TEST(GlobalDamping, DecreasesVelocitiesByTheFactorOfEquation32) {
  // α Δt/2 = 1/4: each step leaves (1 − 1/4)/(1 + 1/4) = 3/5 of velocity and spin.
  auto grains = one_grain<2>({0, 0}, {8, 0});
  grains[spin][0] = 40;
  Simulation sim{grains, UniformGrid<2>{}, Gravity<2>{{0, 0}}, Leapfrog{GlobalDamping{.alpha = 2}}};
  sim.step(0.25);
  double v = sim.particles()[velocity][0][0];
  EXPECT_NEAR(sim.snapshot()[velocity][0][0], v * 0.8, 1e-14) << "the mean of the half steps, (27)";
  for (int k = 0; k < 5; ++k) {
    sim.step(0.25);
    v *= 0.6;
    EXPECT_NEAR(sim.particles()[velocity][0][0], v, 1e-14);
    EXPECT_NEAR(sim.particles()[spin][0], 5 * v, 1e-13) << "(33) is (32) for the spin";
  }
}

TEST(GlobalDamping, StartsFromTheGivenVelocity) {
  Simulation sim{one_grain<2>({0, 0}, {8, 0}), UniformGrid<2>{}, Gravity<2>{{0, 0}},
                 Leapfrog{GlobalDamping{.alpha = 2}}};
  sim.step(0.25);
  // v^{1/2} and v^{−1/2} have the mean 8 and the ratio 3/5.
  EXPECT_NEAR(sim.particles()[velocity][0][0], 6, 1e-14);
}

TEST(GlobalDamping, DecreasesFreeVelocitiesExponentially) {
  const auto left = [](double dt) {
    Simulation sim{one_grain<3>({0, 0, 0}, {0, 2, 0}), UniformGrid<3>{}, Gravity<3>{{0, 0, 0}},
                   Leapfrog{GlobalDamping{.alpha = 0.7}}};
    sim.run({.until = 4, .time_step = dt});
    return sim.snapshot()[velocity][0][1] - 2 * std::exp(-0.7 * sim.time());
  };
  EXPECT_LT(std::abs(left(1.0 / 64)), 1e-4);
  EXPECT_NEAR(std::log2(left(1.0 / 16) / left(1.0 / 32)), 2, 0.05);
}

TEST(GlobalDamping, LimitsFreeFallToGravityOverAlpha) {
  Simulation sim{one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, -9.81}},
                 Leapfrog{GlobalDamping{.alpha = 0.5}}};
  sim.run({.until = 80, .time_step = 0.05});
  EXPECT_NEAR(sim.particles()[velocity][0][1], -9.81 / 0.5, 1e-9);
}

TEST(GlobalDamping, RejectsInvalidRates) {
  EXPECT_TRUE(refuses([] { Leapfrog{GlobalDamping{.alpha = -1}}; }, {"GlobalDamping: alpha = -1"}));
  EXPECT_TRUE(
      refuses([] { Leapfrog{GlobalDamping{.alpha = std::numeric_limits<double>::quiet_NaN()}}; },
              {"GlobalDamping: alpha = nan"}));
}

template <class P>
double speed_after_three_steps() {
  P particles;
  particles.add(Vec<3>::Zero());
  particles[mass][0] = 2;
  Simulation sim{particles, BruteForce<3>{}, Gravity<3>{{0, 0, -1}}, Leapfrog{}};
  for (int step = 0; step < 3; ++step) sim.step(0.1);
  EXPECT_EQ(sim.particles()[mass][0], 2);
  return sim.particles()[velocity][0][2];
}

TEST(Leapfrog, MovesParticlesInAnyBundles) {
  using Columns = Particles<3, double, velocity_t, mass_t, force_t>;
  const double speed = speed_after_three_steps<Columns>();
  using One = Particles<3, double, velocity_t, mass_t, force_t,
                        Bundle<position_t, velocity_t, mass_t>>;
  EXPECT_EQ(speed_after_three_steps<One>(), speed);
  using Part = Particles<3, double, velocity_t, mass_t, force_t, Bundle<velocity_t, mass_t>>;
  EXPECT_EQ(speed_after_three_steps<Part>(), speed);
}

TEST(Leapfrog, RefusesAnAngleThatIsNotFinite) {
  for (int k = 0; k < 3; ++k) {
    dem::Grains<3, double, angle_t> grains;
    dem::add_grain(grains, {0, 0, 0}, {.radius = 0.1, .density = 1});
    grains[angle][0][k] = std::numeric_limits<double>::quiet_NaN();
    Simulation sim{grains, BruteForce<3>{}, Gravity<3>{{0, 0, -1}}, Leapfrog{}};
    EXPECT_TRUE(refuses([&] { sim.step(0.1); }, {"angle", "not finite"})) << "component " << k;
  }
}

// A second grain has this mass or inertia, from the beginning or after a step.
template <int Dim, class Field, class Interaction>
void expect_refused(const Interaction& interaction, Field field, double value,
                    const std::string& text) {
  auto grains = two_grains<Dim>(0.1, Vec<Dim>(Vec<Dim>::Zero()));
  const double valid = grains[field][1];
  grains[field][1] = value;
  Simulation sim{grains, UniformGrid<Dim>{}, interaction, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(0.01); }, {text, "positive", "id 1", "step 0"}));
  sim.particles()[field][1] = valid;
  sim.step(0.01);
  EXPECT_EQ(sim.steps(), 1u);
}

TEST(Leapfrog, RefusesAMassOrInertiaThatIsNotPositiveAndFiniteInTheFirstStep) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const double value : {0.0, -1.0, 1e-310, inf, std::nan("")}) {
    const std::string of_mass = "Leapfrog: mass = " + to_text(value) + " kg";
    expect_refused<2>(Gravity<2>{{0, -9.81}}, mass, value, of_mass);
    expect_refused<3>(Forces{SpringToOrigin{}}, mass, value, of_mass);
    const std::string of_inertia = "Leapfrog: inertia = " + to_text(value) + " kg m²";
    expect_refused<2>(SpringToOrigin{}, inertia, value, of_inertia);
    expect_refused<3>(Gravity<3>{{0, 0, -9.81}}, inertia, value, of_inertia);
  }
}

TEST(Leapfrog, RefusesAMassThatIsNotPositiveInSinglePrecision) {
  dem::Grains<3, float> grains;
  dem::add_grain(grains, {0, 0, 0}, pebble);
  grains[mass][0] = -1;
  Simulation sim{grains, UniformGrid<3, float>{}, Gravity<3, float>{{0, 0, -9.81f}}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(0.01); }, {"Leapfrog: mass = -1 kg", "id 0"}));
}

TEST(Leapfrog, NamesAMassThatMakesALaterStepNotFinite) {
  Simulation sim{one_grain<3>({0, 0, 0}, {0, 0, 0}), UniformGrid<3>{}, Gravity<3>{{0, 0, -9.81}},
                 Leapfrog{}};
  sim.step(0.01);
  sim.particles()[mass][0] = 0;
  EXPECT_TRUE(refuses([&] { sim.step(0.01); }, {"Leapfrog: mass = 0 kg", "id 0", "step 1"}));
}

}  // namespace
}  // namespace silt::test::leapfrog_test
