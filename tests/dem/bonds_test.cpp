// SPDX-License-Identifier: MIT
// Bonds against beam theory, conservation of momentum, and rolling back, removing, reordering and
// restarting.
#include <silt/dem/bond/bonds.hpp>
#include <silt/io/checkpoint.hpp>

#include <Eigen/Geometry>

#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/slow_types.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace silt::test::bonds_test {
namespace {

constexpr double R = 0.01;
const dem::ParallelBond cement{
    .normal_stiffness = 1e9, .tangential_stiffness = 4e8, .radius_share = 0.8};

// The same, soft enough for any time step.
const dem::ParallelBond soft{
    .normal_stiffness = 10, .tangential_stiffness = 4, .radius_share = 0.8};

// Touching grains along the first axis.
template <int Dim, class Real = double>
auto chain(Index n) {
  dem::Grains<Dim, Real> grains;
  for (Index i = 0; i < n; ++i) {
    dem::add_grain(grains, Vec<Dim, Real>(Real(2 * R * double(i)) * Vec<Dim, Real>::Unit(0)),
                   pebble);
  }
  return grains;
}

template <int Dim, class Real, class P>
auto bonded(const P& grains, const dem::ParallelBond& law) {
  dem::Bonds<Dim, Real> bonds{law};
  bonds.bond_all_touching(grains, BruteForce<Dim, Real>{});
  return bonds;
}

// Evaluates the forces of bonds on grains, dt after the previous evaluation.
template <class B, class P>
void evaluate(B& bonds, P& grains, double dt) {
  clear(grains);
  BruteForce<P::dimension, typename P::Real> search;
  bonds.accelerate(grains, search, dt);
}

// A square or block with bonds in all directions.
template <int Dim, class Real>
auto block(Index along, double strength = 2e3) {
  auto grains = crowd<Dim, Real>(along, 11);
  for (auto& v : grains[velocity]) v *= Real(0.05);
  for (auto& w : grains[spin]) w *= Real(0.05);
  dem::Bonds<Dim, Real> bonds{dem::ParallelBond{.normal_stiffness = 1e9,
                                                .tangential_stiffness = 4e8,
                                                .beta = 1e-6,
                                                .tensile_strength = strength,
                                                .shear_strength = strength}};
  bonds.bond_all_touching(grains, UniformGrid<Dim, Real>{}, {.max_gap = 1e-3});
  return std::pair(std::move(grains), std::move(bonds));
}

template <class P>
class BondsOf : public ::testing::Test {};
using Kinds = AllOrUsual<::testing::Types<dem::Grains<2, double>, dem::Grains<2, float>,
                                          dem::Grains<3, double>, dem::Grains<3, float>>,
                         ::testing::Types<dem::Grains<2>, dem::Grains<3>>>;
TYPED_TEST_SUITE(BondsOf, Kinds);

TYPED_TEST(BondsOf, HaveTheForceAndEnergyOfTheirSpring) {
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  auto grains = chain<dim, Real>(2);
  auto bonds = bonded<dim, Real>(grains, cement);
  ASSERT_EQ(bonds.bonds().size(), 1u);
  evaluate(bonds, grains, 1e-7);
  EXPECT_EQ(grains[force][0].norm(), 0);
  const double e = 1e-5;
  grains[position][1][0] += Real(e);
  evaluate(bonds, grains, 1e-7);
  const double area = dim == 2 ? 2 * 0.8 * R : std::numbers::pi * 0.64 * R * R;
  const double tolerance = std::is_same_v<Real, float> ? 1e-3 : 1e-10;  // difference of two floats
  EXPECT_NEAR(grains[force][0][0] / (1e9 * area * e), 1, tolerance);
  EXPECT_EQ(grains[force][1][0], -grains[force][0][0]);
  EXPECT_NEAR(bonds.elastic_energy(grains) / (1e9 * area * e * e / 2), 1, tolerance);
  EXPECT_EQ(squared_norm(grains[torque][0]), 0);
}

template <class P>
class BlockOf : public ::testing::Test {};
using SomeKinds = AllOrUsual<::testing::Types<dem::Grains<2, float>, dem::Grains<3, double>>,
                             ::testing::Types<dem::Grains<3>>>;
TYPED_TEST_SUITE(BlockOf, SomeKinds);

TYPED_TEST(BlockOf, BondedGrainsIsReproducibleForOneToFourThreadsAndAnyOrderInMemory) {
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  const auto [start, bonds] = block<dim, Real>(dim == 2 ? 33 : 11, 300);
  ASSERT_GT(start.size(), chunk_size);
  const auto run = [&, &bonds = bonds](dem::Grains<dim, Real> grains) {
    Simulation sim{std::move(grains), UniformGrid<dim, Real>{}, bonds, Leapfrog{}};
    for (int k = 0; k < 10; ++k) sim.step(1e-6);
    auto out = sim.snapshot();
    std::vector<Index> order(out.size());
    for (Index i = 0; i < out.size(); ++i) order[i] = out.index_of(i);
    out.reorder(order);
    EXPECT_FALSE(sim.interaction().bonds().empty());
    EXPECT_GT(sim.interaction().broken().in_tension, 0u);
    return state_of(out);
  };
  const Bytes alone = with_threads(1, [&, &start = start] { return run(start); });
  for (const int number : {2, 4}) {
    EXPECT_EQ(with_threads(number, [&, &start = start] { return run(start); }), alone);
  }
  auto turned = start;
  std::vector<Index> order(start.size());
  std::iota(order.rbegin(), order.rend(), Index{0});
  turned.reorder(order);
  EXPECT_EQ(run(turned), alone);
}

// The first grain of the chain is so heavy that it does not move.
template <class P>
void hold_first(P& grains) {
  grains[mass][0] *= 1e12;
  grains[inertia][0] *= 1e12;
}

struct PushLast {
  Vec<2> load;
  template <class P>
  double reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& grains, S&, double) const {
    grains[force][grains.size() - 1] += load;
  }
};

TEST(Cantilever, OfGrainsBendsAsTheChainOfItsSectionsAndNearlyAsABeam) {
  constexpr Index n = 8;  // bonds
  auto grains = chain<2>(n + 1);
  hold_first(grains);
  const auto bonds = bonded<2, double>(grains, cement);
  const double load = 1;  // [N]
  Simulation beam{grains, BruteForce<2>{}, Forces{bonds, PushLast{{0, -load}}},
                  Leapfrog{GlobalDamping{.alpha = 110}}};
  // About critical damping of the slowest mode; single bonds oscillate much faster.
  while (beam.time() < 0.3) beam.step(beam.time_step() * 10);
  const auto section = dem::section_of<2>(cement, R);
  const auto springs = dem::springs_of(cement, section);
  const double L = 2 * R;
  double exact = 0;  // Σ P d²/(k_n I) + P/(k_s A) over the sections, d from the tip
  for (Index k = 0; k < n; ++k) {
    exact += load * squared((double(k) + 0.5) * L) / springs.bending + load / springs.shear;
  }
  const double deflection = -beam.particles()[position][n][1];
  EXPECT_NEAR(deflection / exact, 1, 1e-4) << "linear for this small load";
  // Timoshenko's beam, P ℓ³/(3 E I) + P ℓ/(G A) with E = k̄_n L and G = k̄_s L; the chain is
  // too stiff by 1/(4 n²) of the first term.
  const double length = double(n) * L;
  const double bending = load * length * squared(length) / (3 * springs.bending * L);
  EXPECT_NEAR(exact, bending * (1 - 1 / (4.0 * n * n)) + load * length / (springs.shear * L),
              1e-12 * exact);
  EXPECT_NEAR(deflection / (bending + load * length / (springs.shear * L)), 1, 0.005);
}

// A rigid rotation of a pair in small steps with the spins of the previous half step, as in
// leapfrog.
template <int Dim>
double strain_after_turning(const AngularVec<Dim>& w, double dt, int steps) {
  auto grains = chain<Dim>(2);
  auto bonds = bonded<Dim, double>(grains, soft);
  const double size = std::sqrt(squared_norm(w));
  const auto at = [&](double time) {
    if constexpr (Dim == 2) {
      return Vec<2>(2 * R * std::cos(w * time), 2 * R * std::sin(w * time));
    } else {
      return Vec<3>(Eigen::AngleAxis<double>(size * time, w / size) * Vec<3>(2 * R, 0, 0));
    }
  };
  for (int step = 0; step <= steps; ++step) {
    grains[position][1] = at(step * dt);
    grains[spin][0] = grains[spin][1] = w;
    evaluate(bonds, grains, dt);
  }
  const auto& bond = bonds.bonds()[0];
  return bond.shear.norm() / R + std::sqrt(squared_norm(bond.rotation));
}

TEST(BondedPair, RotatesWithoutStrain) {
  // More than ten revolutions.
  EXPECT_LT(strain_after_turning<2>(50, 1e-3, 2000), 1e-12);
  EXPECT_LT(strain_after_turning<3>({0, 0, 50}, 1e-3, 2000), 1e-12);
  EXPECT_LT(strain_after_turning<3>({70, 0, 0}, 1e-3, 2000), 1e-12) << "about its own line";
  EXPECT_LT(strain_after_turning<3>({30, 20, 35}, 1e-3, 2000), 1e-12);
}

TEST(BondedPair, ResistsTwistingAndBending) {
  auto grains = chain<3>(2);
  auto bonds = bonded<3, double>(grains, soft);
  evaluate(bonds, grains, 1e-3);
  grains[spin][1] = {1, 0, 2};
  evaluate(bonds, grains, 1e-3);
  const auto springs = dem::springs_of(soft, dem::section_of<3>(soft, R));
  // Up to the square of this small angle.
  EXPECT_NEAR(grains[torque][1][0], -springs.twisting * 1e-3, 1e-9 * springs.twisting);
  // A rotation of the second grain about its centre also shears the section at the distance R.
  EXPECT_NEAR(grains[torque][1][2], -(springs.bending + springs.shear * R * R) * 2e-3,
              1e-9 * springs.bending);
  EXPECT_NEAR(grains[force][1][1], springs.shear * R * 2e-3, 1e-9 * springs.shear * R);
}

TEST(Block, OfBondedGrainsConservesMomentumAndAngularMomentumWhileBondsBreak) {
  const auto check = [](auto start) {
    auto& [grains, bonds] = start;
    constexpr int dim = std::remove_reference_t<decltype(grains)>::dimension;
    Simulation sim{grains, BruteForce<dim>{}, bonds, Leapfrog{}};
    const auto p = momentum(sim.particles());
    const Vec<dim> origin = Vec<dim>::Zero();
    const auto before = angular_momentum(sim.particles(), origin);
    const Index held = bonds.bonds().size();
    double scale = 0;
    for (Index i = 0; i < grains.size(); ++i) {
      scale += grains[mass][i] * grains[velocity][i].norm() * 0.1;
    }
    for (int k = 0; k < 500; ++k) sim.step(1e-6);
    using Turn = typename dem::Grains<dim>::AngularVec;
    EXPECT_LT((momentum(sim.particles()) - p).norm(), 1e-12 * scale / 0.1);
    EXPECT_LT(std::sqrt(squared_norm(Turn(angular_momentum(sim.particles(), origin) - before))),
              1e-12 * scale);
    const auto& after = sim.interaction();
    const auto broken = after.broken();
    EXPECT_GT(broken.in_tension + broken.in_shear, 0u);
    EXPECT_GT(broken.energy, 0);
    EXPECT_EQ(after.bonds().size() + broken.in_tension + broken.in_shear, held);
  };
  check(block<2, double>(8));
  check(block<3, double>(4));
}

TEST(Bond, BreaksJustAboveItsStrengthAndNotBelow) {
  const auto holds = [](double stretch, double slide, double bend) {
    auto law = soft;
    law.tensile_strength = 1e-4;  // [Pa]: an elongation of 1e-5 m
    law.shear_strength = 4e-5;    // a shear of 1e-5 m
    auto grains = chain<2>(2);
    auto bonds = bonded<2, double>(grains, law);
    evaluate(bonds, grains, 1);
    grains[position][1][0] += stretch;
    // A common rotation of both grains relative to the line shears the section.
    grains[spin][0] = grains[spin][1] = slide / (2 * R);
    grains[spin][0] += bend / 2;
    grains[spin][1] -= bend / 2;
    evaluate(bonds, grains, 1);
    EXPECT_EQ(bonds.bonds().size() + bonds.broken().in_tension + bonds.broken().in_shear, 1u);
    if (bonds.bonds().empty()) {
      EXPECT_EQ(grains[force][0].norm(), 0);
      EXPECT_GT(bonds.broken().energy, 0);
    }
    return !bonds.bonds().empty();
  };
  EXPECT_TRUE(holds(0.999999e-5, 0, 0));
  EXPECT_FALSE(holds(1.000001e-5, 0, 0));
  EXPECT_TRUE(holds(-5e-5, 0, 0)) << "compression does not break it";
  EXPECT_TRUE(holds(0, 0.999999e-5, 0));
  EXPECT_FALSE(holds(0, 1.000001e-5, 0));
  // At the rim, a rotation by φ gives an elongation of φ R̄.
  EXPECT_TRUE(holds(0, 0, 0.999999e-5 / (0.8 * R)));
  EXPECT_FALSE(holds(0, 0, 1.000001e-5 / (0.8 * R)));
  EXPECT_FALSE(holds(0.5e-5, 0, 0.6e-5 / (0.8 * R))) << "both stresses add up";
}

TEST(Bonds, OscillateWithoutLossAndAreDampedByADashpot) {
  const auto springs = dem::springs_of(cement, dem::section_of<2>(cement, R));
  const double frequency = std::sqrt(2 * springs.normal / chain<2>(1)[mass][0]);
  const auto left = [&](double beta) {
    auto law = cement;
    law.beta = beta;
    auto grains = chain<2>(2);
    grains[velocity][0] = {-0.01, 0};
    grains[velocity][1] = {0.01, 0};
    Simulation sim{grains, BruteForce<2>{}, bonded<2, double>(grains, law), Leapfrog{}};
    const double before = kinetic_energy(sim.particles());
    double least = 1;
    for (int k = 0; k < 1000; ++k) {  // ten periods
      sim.step(2 * std::numbers::pi / frequency / 100);
      const auto now = sim.state();
      const double energy =
          kinetic_energy(now.particles) + now.interaction.elastic_energy(now.particles);
      least = std::min(least, energy / before);
    }
    return least;
  };
  EXPECT_GT(left(0), 0.998);
  // ζ = β ω/2; the energy decays as exp(−2 ζ ω t) over ten periods of 2π/ω.
  const double zeta = 0.01;
  EXPECT_NEAR(std::log(left(2 * zeta / frequency)), -40 * std::numbers::pi * zeta, 0.05);
}

TEST(Bonds, ThrowForAnUnstableStepWithTheGrainInTheMessageAndAreStableBelow) {
  const auto step = [](double share) {
    auto grains = chain<3>(2);
    grains[velocity][1] = {1e-3, 1e-3, 1e-3};
    grains[spin][1] = {0.1, 0.2, 0.3};
    Simulation sim{grains, BruteForce<3>{}, bonded<3, double>(grains, cement), Leapfrog{}};
    const double stable = sim.time_step() * 100 / std::numbers::pi;
    for (int k = 0; k < 2000; ++k) sim.step(share * stable);
    return kinetic_energy(sim.particles());
  };
  EXPECT_TRUE(refuses([&] { step(1.001); }, {"dem::Bonds", "exceeds the stable", "particle 0"}));
  EXPECT_LT(step(0.99), 1e-2);
}

TEST(Bonds, AreRemovedWithTheirGrainsAndActAcrossPeriodicSides) {
  auto grains = chain<2>(5);
  Box<2> box{.lower = {-R, -1}, .upper = {9 * R, 1}, .periodic = {true, false}};
  grains.set_box(box);
  auto bonds = bonded<2, double>(grains, cement);
  EXPECT_EQ(bonds.bonds().size(), 5u) << "a ring";
  EXPECT_TRUE(bonds.is_bonded({4, 0}));
  for (auto& v : grains[velocity]) v = {30, 0};
  Simulation sim{grains, BruteForce<2>{}, bonds, Leapfrog{}};
  for (int k = 0; k < 500; ++k) sim.step(1e-5);  // across the side
  for (const auto& v : sim.particles()[velocity]) EXPECT_NEAR((v - Vec<2>(30, 0)).norm(), 0, 1e-9);
  sim.particles().remove(2);
  sim.step(1e-5);
  EXPECT_EQ(sim.interaction().bonds().size(), 3u);
  EXPECT_FALSE(sim.interaction().is_bonded({1, 2}));
  for (const auto& v : sim.particles()[velocity]) EXPECT_NEAR((v - Vec<2>(30, 0)).norm(), 0, 1e-9);
}

TEST(Bonds, AreUnchangedAfterAFailedStep) {
  auto [grains, bonds] = block<2, double>(8);
  Simulation sim{grains, BruteForce<2>{}, bonds, Leapfrog{}};
  auto other = sim;
  for (int k = 0; k < 60; ++k) {
    sim.step(1e-6);
    EXPECT_THROW(other.step(1), Error);
    // Also fails after the bonds were evaluated.
    const auto v = other.particles()[velocity][3];
    other.particles()[velocity][3][0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(other.step(1e-6), Error);
    other.particles()[velocity][3] = v;
    other.step(1e-6);
    ASSERT_EQ(state_of(other.particles()), state_of(sim.particles())) << k;
  }
  EXPECT_LT(sim.interaction().bonds().size(), bonds.bonds().size());
}

TEST(Bonds, ResumeFromACheckpointBitwise) {
  const auto path = std::filesystem::temp_directory_path() / "silt_bonds_test.silt";
  const auto [grains, bonds] = block<3, double>(4);
  Simulation sim{grains, BruteForce<3>{}, bonds, Leapfrog{}};
  for (int k = 0; k < 50; ++k) sim.step(1e-6);
  write_checkpoint(path, sim);
  for (int k = 0; k < 50; ++k) sim.step(1e-6);
  Simulation again{grains, BruteForce<3>{}, dem::Bonds<3>{bonds.law()}, Leapfrog{}};
  read_checkpoint(path, again);
  for (int k = 0; k < 50; ++k) again.step(1e-6);
  std::filesystem::remove(path);
  EXPECT_EQ(state_of(again.particles()), state_of(sim.particles()));
  EXPECT_EQ(again.interaction().broken().energy, sim.interaction().broken().energy);
}

TEST(Bonds, AreMadeOfPairsOfDifferentSizesWhoseGapIsWithinTheMaximum) {
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, {.radius = 4 * R, .density = 1});
  dem::add_grain(grains, {5 * R, 0}, {.radius = R, .density = 1});
  dem::add_grain(grains, {8 * R, 0}, {.radius = R, .density = 1});
  dem::Bonds<2> bonds{cement};
  EXPECT_EQ(bonds.bond_all_touching(grains, UniformGrid<2>{}, {.max_gap = 0.99 * R}), 1u);
  EXPECT_EQ(bonds.bonds()[0].a, 0u) << "the large one";
  EXPECT_EQ(bonds.bond_all_touching(grains, UniformGrid<2>{}, {.max_gap = 1.01 * R}), 1u);
  EXPECT_EQ(bonds.bonds().size(), 2u);
}

TEST(Bonds, NoticeChangedMasses) {
  auto grains = chain<2>(2);
  grains[velocity][0] = {1e-3, 0};
  Simulation sim{grains, BruteForce<2>{}, bonded<2, double>(grains, cement), Leapfrog{}};
  const double dt = sim.time_step();
  sim.step(dt);
  sim.particles()[mass][0] *= 1e-6;
  sim.particles()[inertia][0] *= 1e-6;
  EXPECT_LT(sim.time_step(), 0.01 * dt);
  EXPECT_TRUE(refuses([&] { sim.step(dt); }, {"dem::Bonds", "exceeds the stable"}));
}

TEST(Bonds, RefuseACheckpointOfAnotherLaw) {
  const auto path = std::filesystem::temp_directory_path() / "silt_bonds_of_other_law.silt";
  const auto grains = chain<2>(3);
  write_checkpoint(path,
                   Simulation{grains, BruteForce<2>{}, bonded<2, double>(grains, soft), Leapfrog{}});
  Simulation other{grains, BruteForce<2>{}, bonded<2, double>(grains, cement), Leapfrog{}};
  EXPECT_TRUE(refuses([&] { read_checkpoint(path, other); }, {"ParallelBond::normal_stiffness"}));
  std::filesystem::remove(path);
}

TEST(Bonds, MayBeLongerThanHalfAPeriodicSide) {
  const auto force_on_last = [](bool is_periodic) {
    auto grains = chain<2>(2);
    grains.set_box({.lower = {-R, -R}, .upper = {9 * R, 9 * R}, .periodic = {is_periodic, false}});
    if (!is_periodic) grains.set_box({});
    grains[velocity][1] = {1, 0.1};
    Simulation sim{grains, BruteForce<2>{}, bonded<2, double>(grains, soft), Leapfrog{}};
    while (sim.time() < 0.07) sim.step(1e-3);
    EXPECT_GT(sim.interaction().bonds()[0].length, 8 * R);
    return sim.interaction().bonds()[0].force;
  };
  EXPECT_LT((force_on_last(true) - force_on_last(false)).norm(), 1e-12);
}

TEST(Bonds, AreNotRotatedByMoreThanTheirLengthInAStep) {
  auto grains = chain<2>(2);
  grains[velocity][1] = {0, 1e5};
  Simulation sim{grains, BruteForce<2>{}, bonded<2, double>(grains, soft), Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(1e-3); },
                      {"dem::Bonds: the bonded grains 0 and 1 move by ", "0.02 m long", "particle 0"}));
  EXPECT_EQ(sim.steps(), 0u);
}

TEST(Bonds, OfRemovedGrainsHaveNoState) {
  auto grains = chain<2>(2);
  const auto bonds = bonded<2, double>(grains, soft);
  grains.remove(0);
  EXPECT_TRUE(refuses([&] { static_cast<void>(bonds.state(grains, bonds.bonds()[0])); },
                      {"dem::Bonds", "0 and 1", "removed"}));
}

TEST(Bonds, ThrowForGrainsThatCoincideOrHaveNoPosition) {
  auto grains = chain<2>(2);
  auto bonds = bonded<2, double>(grains, soft);
  for (const double x : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    grains[position][1] = {x, 0};
    EXPECT_TRUE(refuses([&] { evaluate(bonds, grains, 1e-7); },
                        {"dem::Bonds: the bonded grains ", " coincide or have an invalid position",
                         "particle 0", "id 0"}))
        << x;
  }
}

TEST(Bonds, ThrowForInvalidPairs) {
  auto grains = chain<2>(3);
  dem::Bonds<2> bonds{cement};
  bonds.bond(grains, {1, 0});
  EXPECT_TRUE(refuses([&] { bonds.bond(grains, {0, 1}); }, {"0 and 1", "already bonded"}));
  EXPECT_TRUE(refuses([&] { bonds.bond(grains, {2, 2}); }, {"2 and 2", "two different grains"}));
  EXPECT_TRUE(refuses([&] { bonds.bond(grains, {2, 7}); }, {"2 and 7"}));
  EXPECT_TRUE(refuses([] { dem::Bonds<2>{{}}; }, {"ParallelBond: normal_stiffness", "positive"}));
  EXPECT_TRUE(refuses([] { dem::Bonds<2>{{.normal_stiffness = 1, .shear_strength = -1}}; },
                      {"shear_strength = -1"}));
}

TEST(Bonds, ThrowForAPairAtOnePoint) {
  auto grains = dem::make_grains(std::vector<Vec<2>>{{0, 0}, {0, 0}}, pebble);
  dem::Bonds<2> bonds{dem::ParallelBond{.normal_stiffness = 1e9, .tangential_stiffness = 1e9}};
  EXPECT_TRUE(refuses([&] { bonds.bond(grains, {.one = 0, .other = 1}); },
                      {"dem::Bonds: distance of the grains 0 and 1 = 0"}));
}

}  // namespace
}  // namespace silt::test::bonds_test
