// SPDX-License-Identifier: MIT
// Normal components against exact impacts, and the composition of laws.
#include <silt/dem/law/adhesion.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/cundall_strack.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/rolling_resistance.hpp>
#include <silt/dem/law/walton_braun.hpp>
#include <silt/io/csv.hpp>

#include "support/check.hpp"
#include "support/single_contact.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace silt::test::laws_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double phases[] = {0.05, 0.3, 0.55, 0.8, 0.95};

// A law need not mention what it has not.
TEST(LoadComponents, AreZeroIfALawDoesNotGiveThem) {
  const Vec<3> normal = Vec<3>::Unit(0);
  EXPECT_EQ((dem::LoadComponents<3, double>{}.force(normal)), (Vec<3>(0, 0, 0)));
  EXPECT_EQ((dem::LoadComponents<3, double>{}.couple()), (Vec<3>(0, 0, 0)));
}

// --- linear spring and dashpot -------------------------------------------------------------------

template <int Dim, class Real>
void expect_the_table() {
  const CsvTable table = read_csv(SILT_TESTS_DIR "/reference/linear_spring_dashpot_exact.csv");
  const double k = 1e6, omega = 1e3;  // m* = 1 kg
  for (Index row = 0; row < table.rows(); ++row) {
    const double e = table["e_nominal"][row];
    for (const bool limited : {false, true}) {
      const dem::Law law{dem::LinearSpringDashpot{
          .normal_stiffness = k, .restitution = e, .limit_damping = limited}};
      for (const double phase : phases) {
        const auto impact = collide<Dim, Real>(law, {.time_step = pi / omega / 50, .phase = phase});
        const double expected = limited ? table["e_if_clipped"][row] : e;
        EXPECT_NEAR(impact.restitution / expected, 1, 0.005) << e << " limited " << limited;
        EXPECT_NEAR(impact.max_overlap * omega / table["delta_max_omega0_over_v0"][row], 1, 0.01) << e;
      }
    }
  }
}

TEST(LinearSpringDashpotComponent, HasTheRestitutionAndOverlapOfTheTable) {
  expect_the_table<2, double>();
  expect_the_table<3, float>();
}

TEST(Law, OfLinearComponentsIsBitwiseThatOfCundallAndStrack) {
  const double k = 1e5;
  const dem::CundallStrack whole{.normal_stiffness = k,
                                 .tangential_stiffness = 0.8 * k,
                                 .restitution = 0.6,
                                 .friction_angle = 0.3,
                                 .cohesion = 0.1};
  const dem::Law composed{
      dem::LinearFriction{.tangential_stiffness = 0.8 * k, .friction_angle = 0.3, .cohesion = 0.1},
      dem::LinearSpringDashpot{.normal_stiffness = k, .restitution = 0.6}};
  dem::Contact<3, double> contact;
  contact.effective_mass = 0.01;
  contact.effective_radius = 0.01;
  contact.time_step = 1e-5;
  dem::CundallStrack::History<3, double> of_whole;
  decltype(composed)::History<3, double> of_composed;
  double lost = 0;
  for (int step = 0; step < 2000; ++step) {
    const double t = step * contact.time_step;
    contact.normal = Vec<3>(std::cos(20 * t), std::sin(20 * t), 0.1).normalized();
    contact.overlap = 1e-4 * (1.1 + std::sin(900 * t));
    contact.relative_velocity = Vec<3>(0.1 * std::sin(300 * t), 0.2, 0.3 * std::cos(500 * t));
    const auto a = whole.components(contact, of_whole);
    const auto b = composed.components(contact, of_composed);
    ASSERT_EQ(a.force(contact.normal), b.force(contact.normal));
    ASSERT_EQ(a.friction, b.friction);
    ASSERT_EQ(whole.elastic_energy(contact, of_whole),
              composed.elastic_energy(contact, of_composed));
    lost += b.friction;
  }
  EXPECT_GT(lost, 0) << "the contact also slides";
  EXPECT_EQ(whole.stiffness(contact).beta, composed.stiffness(contact).beta);
}

// --- Walton and Braun ----------------------------------------------------------------------------

template <int Dim, class Real>
void expect_walton_braun() {
  const double K_1 = 1e6;
  for (const double e : {1.0, 0.9, 0.6, 0.3}) {
    const dem::Law law{dem::WaltonBraun{.loading_stiffness = K_1, .restitution = e}};
    const double lasts = pi / 2 * std::sqrt(1 / K_1) * (1 + e);
    for (const double phase : phases) {
      const auto impact = collide<Dim, Real>(law, {.time_step = lasts / 50, .phase = phase});
      EXPECT_NEAR(impact.restitution / e, 1, 0.002) << e;
      EXPECT_NEAR(impact.max_overlap * std::sqrt(K_1), 1, 0.002) << e;
      EXPECT_NEAR(impact.duration / lasts, 1, 0.03) << e << ": to about a step";
      EXPECT_NEAR(impact.plastic, (1 - e * e) / 2, 0.002) << e << ": of ½ J";
    }
  }
}

TEST(WaltonBraun, HasTheGivenRestitutionAndDissipatesTheRestByYielding) {
  expect_walton_braun<2, double>();
  expect_walton_braun<3, float>();
}

TEST(WaltonBraun, RestitutionIsSecondOrderInTheTimeStep) {
  const dem::Law law{dem::WaltonBraun{.loading_stiffness = 1e6, .restitution = 0.6}};
  const auto worst = [&](double dt) {
    double error = 0;
    for (int k = 0; k < 64; ++k) {
      const double phase = (k + 0.5) / 64;
      const double e = collide<2, double>(law, {.time_step = dt, .phase = phase}).restitution;
      error = std::max(error, std::abs(e / 0.6 - 1));
    }
    return error;
  };
  // Four times the steps: 1/16 of the error. 1/10 leaves a margin for the phases.
  EXPECT_LT(worst(2e-5), worst(8e-5) / 10);
}

TEST(WaltonBraun, UnloadsAndReloadsAlongTheSteeperLine) {
  const double K_1 = 100, e = 0.8, K_2 = K_1 / (e * e);
  const dem::Law law{dem::WaltonBraun{.loading_stiffness = K_1, .restitution = e}};
  decltype(law)::History<2, double> history;
  dem::Contact<2, double> contact;
  const auto at = [&](double overlap) {
    contact.overlap = overlap;
    return law.components(contact, history).normal_spring;
  };
  EXPECT_DOUBLE_EQ(at(0.1), K_1 * 0.1);
  EXPECT_DOUBLE_EQ(at(0.2), K_1 * 0.2);
  const double delta_0 = (1 - e * e) * 0.2;
  EXPECT_DOUBLE_EQ(at(0.15), K_2 * (0.15 - delta_0));
  EXPECT_DOUBLE_EQ(law.elastic_energy(contact, history), K_2 * squared(0.15 - delta_0) / 2);
  EXPECT_DOUBLE_EQ(at(0.18), K_2 * (0.18 - delta_0));
  EXPECT_EQ(at(0.5 * delta_0), 0) << "it is never attractive";
  EXPECT_DOUBLE_EQ(at(0.2), K_1 * 0.2);
  EXPECT_DOUBLE_EQ(at(0.3), K_1 * 0.3);
  EXPECT_DOUBLE_EQ(law.stiffness(contact).normal, K_2);
}

// --- Hertz ---------------------------------------------------------------------------------------

// The cast iron of Chung and Ooi, Granular Matter 13 (2011) 643, test 3, on a rigid wall. Their
// other cases are in the table of exact results, validation/dem_reference.
TEST(Hertz, HasTheGivenRestitutionAtAnySpeed) {
  const dem::Elastic iron{.young_modulus = 1e11, .poisson_ratio = 0.25};
  const dem::Hertz rigid{.elastic = {.young_modulus = 1e30}};
  const double R = 0.0025, lasts = 12.972e-6;
  for (const double e : {1.0, 0.9, 0.8, 0.6, 0.4, 0.2}) {
    const dem::Law law{dem::Hertz::mix({.elastic = iron, .restitution = e}, rigid)};
    for (const double slower : {1.0, 10.0, 1000.0}) {
      for (const double phase : phases) {
        const HeadOn bodies{.mass = 7000 * 4 / 3 * pi * R * R * R,
                            .radius = R,
                            .speed = 3.9 / slower,
                            .time_step = lasts / 50 * std::pow(slower, 0.2),
                            .phase = phase};
        EXPECT_NEAR((collide<3, double>(law, bodies).restitution / e), 1, 0.01) << e;
      }
    }
  }
}

TEST(Elastic, OfTwoMaterialsHasTheModuliOfTheirContact) {
  const dem::Elastic steel{.young_modulus = 2.1e11, .poisson_ratio = 0.3};
  const dem::Elastic rubber{.young_modulus = 5e6, .poisson_ratio = 0.49};
  const auto compliance = [](const dem::Elastic& a) {
    return (1 - squared(a.poisson_ratio)) / a.young_modulus;
  };
  const auto shear_compliance = [](const dem::Elastic& a) {
    return (2 - a.poisson_ratio) * 2 * (1 + a.poisson_ratio) / a.young_modulus;
  };
  const auto mixed = dem::Elastic::mix(steel, rubber);
  EXPECT_NEAR(mixed.contact_modulus() * (compliance(steel) + compliance(rubber)), 1, 1e-14);
  EXPECT_NEAR(mixed.contact_shear_modulus() * (shear_compliance(steel) + shear_compliance(rubber)),
              1, 1e-14);
  const auto same = dem::Elastic::mix(steel, steel);
  EXPECT_NEAR(same.young_modulus / steel.young_modulus, 1, 1e-13);
  EXPECT_NEAR(same.poisson_ratio, steel.poisson_ratio, 1e-13);
}

// --- adhesion ------------------------------------------------------------------------------------

TEST(DmtAdhesion, HasThePullOffForceAndIsInEquilibriumWithHertz) {
  const double R = 0.5e-3, gamma = 0.05;
  const dem::Law law{dem::Hertz{.elastic = {.young_modulus = 1e9, .poisson_ratio = 0.25}},
                     dem::DmtAdhesion{.surface_energy = gamma}};
  dem::Contact<3, double> contact;
  contact.normal = {0, 0, 1};
  contact.effective_radius = R;
  contact.effective_mass = 1e-6;
  const auto force = [&](double overlap) {
    decltype(law)::History<3, double> history;
    contact.overlap = overlap;
    return law.components(contact, history).force(contact.normal)[2];
  };
  const double pull_off = 4 * pi * gamma * R;
  EXPECT_NEAR(force(1e-18) / -pull_off, 1, 1e-6);
  const double E = 1e9 / (2 * (1 - 0.0625));
  const double rests = std::pow(pull_off / (4.0 / 3 * E * std::sqrt(R)), 2.0 / 3);
  EXPECT_NEAR(force(rests) / pull_off, 0, 1e-12);
  EXPECT_GT(force(1.01 * rests), 0);
}

TEST(DmtAdhesion, ConservesEnergy) {
  // Strong enough to cause half of the maximum overlap.
  const dem::Law law{dem::LinearSpringDashpot{.normal_stiffness = 1e6},
                     dem::ConstantCohesion{.pull = 1000}};
  for (const double phase : phases) {
    const auto impact = collide<3, double>(law, {.time_step = pi / 1e3 / 50, .phase = phase});
    EXPECT_NEAR(impact.restitution, 1, 0.01);
    EXPECT_NEAR(impact.max_overlap * 1e3, 1 + std::sqrt(2), 0.01);
  }
}

TEST(DmtAdhesion, CapturesASlowGrainWithDamping) {
  const dem::Law sticky{dem::LinearSpringDashpot{.normal_stiffness = 1e6, .restitution = 0.5},
                        dem::ConstantCohesion{.pull = 1000}};
  EXPECT_EQ(sticky.adhesion.pull, 1000);
  const auto caught = collide<3, double>(sticky, {.speed = 0.1, .time_step = 1e-5});
  EXPECT_NEAR(caught.restitution, 0, 1e-6) << "still in contact after 1e6 steps";
  EXPECT_GT((collide<3, double>(sticky, {.speed = 10, .time_step = 1e-5}).restitution), 0.4);
}

// --- composition ---------------------------------------------------------------------------------

// User-defined components.
struct Cubic {
  double stiffness_over_depth = 0;  ///< [N/m²]

  template <class C>
  dem::NormalForce<C> normal_force(const C& c) const {
    const auto S = typename C::Real(stiffness_over_depth) * c.overlap;
    return {.spring = S * c.overlap / 2, .stiffness = S};
  }
};
struct Drag {
  double coefficient = 0;  ///< [N s/m]

  template <class C>
  dem::TangentialForce<C> tangential_force(const C& c, const dem::NormalForce<C>&) const {
    return {.dashpot = -typename C::Real(coefficient) * c.tangential_velocity()};
  }
};

template <class Law>
constexpr bool runs_in_lanes = dem::LawInLanes<Law, 2, float> && dem::LawInLanes<Law, 2, double> &&
                               dem::LawInLanes<Law, 3, float> && dem::LawInLanes<Law, 3, double>;

using Linear = dem::Law<dem::LinearSpringDashpot, dem::LinearFriction>;
using Full = dem::Law<dem::Hertz, dem::Mindlin, dem::RollingResistance, dem::DmtAdhesion>;
static_assert(runs_in_lanes<dem::Law<dem::WaltonBraun>> && runs_in_lanes<Linear> &&
              runs_in_lanes<Full> && runs_in_lanes<dem::CundallStrack> &&
              runs_in_lanes<dem::CundallStrackIncremental> &&
              runs_in_lanes<dem::Law<dem::WaltonBraun, dem::LinearFriction, dem::RollingResistance,
                                     dem::ConstantCohesion>>);
static_assert(dem::GivesCouple<Full, 3, double> && !dem::GivesCouple<Linear, 3, double>);
static_assert(sizeof(Full::History<3, double>) == (4 + 4 + 2) * sizeof(double));

TEST(Law, AcceptsComponentsInAnyOrderAndUserDefinedOnes) {
  const dem::Law law{dem::ConstantCohesion{.pull = 1}, Drag{.coefficient = 2},
                     Cubic{.stiffness_over_depth = 200}};
  using Own = std::remove_const_t<decltype(law)>;
  static_assert(
      std::is_same_v<Own, dem::Law<Cubic, Drag, dem::NoComponent, dem::ConstantCohesion>>);
  static_assert(dem::LawWithoutHistory<Own, 3, float> && !dem::LawWithHistory<Own, 3, float>);
  static_assert(runs_in_lanes<Own>);
  dem::Contact<2, double> contact;
  contact.normal = {0, 1};
  contact.overlap = 0.5;
  contact.relative_velocity = {3, 0};
  EXPECT_EQ(law.components(contact).force(contact.normal), Vec<2>(-6, 24));
  EXPECT_EQ(law.elastic_energy(contact, dem::NoHistory{}), -0.5)
      << "of components with elastic_energy()";
}

TEST(Law, MixesComponentByComponent) {
  const Full a{dem::Hertz{.elastic = {1e9, 0.3}, .restitution = 0.9},
               dem::Mindlin{.elastic = {1e9, 0.3}, .friction_angle = 0.2},
               dem::RollingResistance{.rolling_friction = 0.1, .twisting_friction = 0.03},
               dem::DmtAdhesion{.surface_energy = 0.04}};
  const Full b{dem::Hertz{.elastic = {5e7, 0.4}, .restitution = 0.5},
               dem::Mindlin{.elastic = {5e7, 0.4}, .friction_angle = 0.5},
               dem::RollingResistance{.rolling_friction = 0.2, .twisting_friction = 0.02},
               dem::DmtAdhesion{.surface_energy = 0.09}};
  const dem::Materials<Full> materials{a, b};
  for (const auto& mixed : {materials.between(0, 1), materials.between(1, 0)}) {
    EXPECT_NEAR(1 / mixed.normal.elastic.contact_modulus(), 0.91 / 1e9 + 0.84 / 5e7, 1e-20);
    EXPECT_EQ(mixed.normal.restitution.value, 0.5);
    EXPECT_EQ(mixed.tangential.friction_angle.value, 0.2);
    EXPECT_EQ(mixed.rolling.rolling_friction, 0.1);
    EXPECT_EQ(mixed.rolling.twisting_friction, 0.02);
    EXPECT_DOUBLE_EQ(mixed.adhesion.surface_energy, 0.06);
  }
}

TEST(Law, HasNoCohesionUnlessItIsGiven) {
  EXPECT_EQ(dem::ConstantCohesion{}.pull, 0);
  EXPECT_EQ(dem::CundallStrack{}.cohesion, 0);
}

TEST(Law, ThrowsForAComponentOutOfRange) {
  using dem::Law, dem::Materials;
  const auto build = [](const auto& component) { Materials{Law{component}}; };
  EXPECT_TRUE(refuses([&] { build(dem::LinearSpringDashpot{}); },
                      {"LinearSpringDashpot: normal_stiffness = 0"}));
  EXPECT_TRUE(refuses([&] { build(dem::WaltonBraun{.loading_stiffness = 1, .restitution = 1.1}); },
                      {"WaltonBraun: restitution = 1.1", "0 to 1"}));
  EXPECT_TRUE(
      refuses([&] { build(dem::Hertz{.elastic = {1e9, 0.6}}); }, {"Hertz: poisson_ratio = 0.6"}));
  EXPECT_TRUE(refuses(
      [&] { Materials{Law{Cubic{}, dem::Mindlin{.elastic = {1e9, 0.3}, .friction_angle = 2}}}; },
      {"Mindlin: friction_angle = 2"}));
  EXPECT_TRUE(
      refuses([&] { Materials{Law{Cubic{}, dem::RollingResistance{.rolling_friction = -1}}}; },
              {"RollingResistance: rolling_friction = -1"}));
  EXPECT_TRUE(refuses([&] { Materials{Law{Cubic{}, dem::DmtAdhesion{.surface_energy = -1}}}; },
                      {"DmtAdhesion: surface_energy = -1"}));
}

TEST(Materials, HaveTheGivenLawsOfPairs) {
  const auto spring = [](double k) { return dem::CundallStrack{.normal_stiffness = k}; };
  const dem::Materials mixed{spring(1), spring(3)};
  EXPECT_EQ(mixed.between(0, 1).normal_stiffness, 1.5);
  const auto given = mixed.with_pair(0, 1, spring(7));
  EXPECT_EQ(given.between(0, 1).normal_stiffness, 7);
  EXPECT_EQ(given.between(1, 0).normal_stiffness, 7);
  EXPECT_EQ(given.between(1, 1).normal_stiffness, 3);
  // A law without mix().
  struct Spring {
    double k = 0;
    Vec<2> force(const dem::Contact<2, double>& c) const { return k * c.overlap * c.normal; }
  };
  const auto three = dem::Materials<Spring>::of_pairs({{{1}, {2}, {3}}, {{4}, {5}}, {{6}}});
  const double expected[3][3] = {{1, 2, 3}, {2, 4, 5}, {3, 5, 6}};
  for (std::uint32_t a = 0; a < 3; ++a) {
    for (std::uint32_t b = 0; b < 3; ++b) EXPECT_EQ(three.between(a, b).k, expected[a][b]);
  }
}

TEST(Materials, RejectTablesThatAreNotOfPairs) {
  const dem::CundallStrack a{.normal_stiffness = 1};
  using Materials = dem::Materials<dem::CundallStrack>;
  EXPECT_TRUE(refuses([&] { Materials::of_pairs({}); }, {"of_pairs: there is no row"}));
  EXPECT_TRUE(refuses([&] { Materials::of_pairs({{a, a}, {a, a}}); },
                      {"row 1 has 2 laws, but there are 2 rows; it needs 1, of material 1"}));
  EXPECT_TRUE(refuses([&] { Materials::of_pairs({{a}, {a}}); }, {"row 0 has 1 laws"}));
  EXPECT_TRUE(refuses([&] { Materials::of_pairs({{a, {}}, {a}}); }, {"normal_stiffness = 0"}));
  EXPECT_TRUE(refuses([&] { Materials({a}).with_pair(0, 1, a); },
                      {"with_pair: material 1 does not exist: there are only 1"}));
  EXPECT_TRUE(refuses([&] { Materials({a}).with_pair(0, 0, {}); }, {"normal_stiffness = 0"}));
}

TEST(Materials, RejectDashpotsThatCannotBeMixed) {
  const dem::CundallStrack by_restitution{.normal_stiffness = 1e5, .restitution = 0.5};
  const dem::CundallStrack by_beta{.normal_stiffness = 1e5, .beta = 1e-5};
  EXPECT_TRUE(refuses([&] { dem::Materials{by_restitution, by_beta}; },
                      {"CundallStrack: one material has restitution = 0.5, the other beta"}));
}

}  // namespace
}  // namespace silt::test::laws_test
