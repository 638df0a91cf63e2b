// SPDX-License-Identifier: MIT
// One impact against the exact solution of the linear spring and dashpot.
#include "support/check.hpp"
#include "support/grains.hpp"

#include <silt/io/csv.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace silt::test {
namespace {

struct Impact {
  double restitution;
  double deepest;   // overlap over v0/ω0 [-]
  double duration;  // time in contact times ω0 [-]
};

// The head-on impact of two grains, or of one on a wall, at v0 with `steps` per contact; `phase`
// says where within a step the contact begins.
template <int Dim>
struct Case {
  bool wall;
  double steps = 50;
  double phase = 0.5;

  double effective_mass() const {
    dem::Grains<Dim> grains;
    dem::add_grain(grains, Vec<Dim>(Vec<Dim>::Zero()), pebble);
    return grains[mass][0] / (wall ? 1 : 2);
  }
  double frequency(double stiffness) const { return std::sqrt(stiffness / effective_mass()); }

  template <class Law>
  Impact operator()(const Law& law) const {
    const double v0 = 0.1;
    const double omega = frequency(law.normal_stiffness);
    const double dt = std::numbers::pi / omega / steps;
    const double gap = v0 * dt * (1 + phase);
    const auto measure = [&](auto sim) {
      const double deepest = through_contact(sim, dt);
      const auto v = sim.particles()[velocity];
      const double leaving = wall ? v[0][0] : v[1][0] - v[0][0];
      return Impact{leaving / v0, deepest * omega / v0, double(sim.steps()) * dt * omega};
    };
    if (wall) {
      const dem::Plane<Dim> plane{.normal = Vec<Dim>::Unit(0)};
      return measure(Simulation{
          one_grain<Dim>((pebble.radius + gap) * Vec<Dim>::Unit(0), -v0 * Vec<Dim>::Unit(0)),
          UniformGrid<Dim>{}, dem::Contacts{law, plane}, Leapfrog{}});
    }
    return measure(Simulation{two_grains<Dim>(gap, -v0 * Vec<Dim>::Unit(0)), UniformGrid<Dim>{},
                              dem::Contacts{law}, Leapfrog{}});
  }
};

CsvTable exact() { return read_csv(SILT_TESTS_DIR "/reference/linear_spring_dashpot_exact.csv"); }

template <int Dim>
void expect_the_table(bool wall) {
  const CsvTable table = exact();
  for (Index row = 0; row < table.rows(); ++row) {
    const double e = table["e_nominal"][row];
    const double zeta = table["zeta"][row];
    const double deepest = table["delta_max_omega0_over_v0"][row];
    const double e_clipped = table["e_if_clipped"][row];
    for (const bool tension : {true, false}) {
      for (const double phase : {0.05, 0.3, 0.55, 0.8, 0.95}) {
        const Case<Dim> impact{.wall = wall, .phase = phase};
        const double wanted = tension ? e : e_clipped;
        const auto by_e = impact(
            dem::CundallStrack{.normal_stiffness = 1e6, .restitution = e, .tension = tension});
        EXPECT_NEAR(by_e.restitution / wanted, 1, 0.005) << e << " tension " << tension;
        EXPECT_NEAR(by_e.deepest / deepest, 1, 0.01) << e << " tension " << tension;
        // The same dashpot, given as β: ζ = (β/2) ω0.
        const auto by_beta = impact(dem::CundallStrack{
            .normal_stiffness = 1e6, .beta = 2 * zeta / impact.frequency(1e6), .tension = tension});
        EXPECT_NEAR(by_beta.restitution / wanted, 1, 0.005) << e << " tension " << tension;
        EXPECT_NEAR(by_beta.deepest / deepest, 1, 0.01) << e << " tension " << tension;
      }
    }
  }
}

TEST(LinearSpringDashpot, HeadOnCollisionOfDiscsReturnsTheGivenRestitution) {
  expect_the_table<2>(false);
}
TEST(LinearSpringDashpot, DiscReturnsFromAWallWithTheGivenRestitution) { expect_the_table<2>(true); }
TEST(LinearSpringDashpot, HeadOnCollisionOfSpheresReturnsTheGivenRestitution) {
  expect_the_table<3>(false);
}
TEST(LinearSpringDashpot, SphereReturnsFromAWallWithTheGivenRestitution) {
  expect_the_table<3>(true);
}

TEST(LinearSpringDashpot, ContactLastsAsLongAsTheTableSays) {
  const CsvTable table = exact();
  for (Index row = 0; row < table.rows(); ++row) {
    const double e = table["e_nominal"][row];
    const Case<2> impact{.wall = false, .steps = 500};
    const auto measured = impact(dem::CundallStrack{.normal_stiffness = 1e6, .restitution = e});
    // Steps on the way there, and one more to see that it is over: within a percent.
    EXPECT_NEAR(measured.duration / table["tc_omega0"][row], 1, 0.012) << e;
  }
}

struct Error {
  double worst = 0;
  double mean = 0;
};

// Error of restitution over the phases of the first step.
template <class Law>
Error error_of(double e, double steps) {
  Error error;
  for (int k = 0; k < 32; ++k) {
    const Case<2> impact{.wall = false, .steps = steps, .phase = (k + 0.5) / 32};
    const double of_phase =
        impact(Law{.normal_stiffness = 1e6, .restitution = e}).restitution / e - 1;
    error.worst = std::max(error.worst, std::abs(of_phase));
    error.mean += of_phase / 32;
  }
  return error;
}

TEST(LinearSpringDashpot, OverlapFormIsOfSecondOrderInTheTimeStep) {
  using Overlap = dem::CundallStrack;
  for (const double e : {0.7, 0.5}) {
    // Four times the steps: a sixteenth of the error. The tenth leaves room for the phases.
    EXPECT_LT(error_of<Overlap>(e, 200).worst, error_of<Overlap>(e, 50).worst / 10);
  }
}

TEST(LinearSpringDashpot, IncrementalFormTendsToTheSameRestitutionInFirstOrder) {
  using Incremental = dem::CundallStrackIncremental;
  const Error coarse = error_of<Incremental>(0.7, 100);
  const Error fine = error_of<Incremental>(0.7, 400);
  const Error finest = error_of<Incremental>(0.7, 1600);
  EXPECT_NEAR(coarse.mean / fine.mean, 4, 1);
  EXPECT_NEAR(fine.mean / finest.mean, 4, 1);
  EXPECT_LT(finest.worst, 0.002);
}

TEST(LinearSpringDashpot, ElasticImpactExchangesVelocitiesWhateverTheStiffness) {
  for (const double stiffness : {1e2, 1e5, 1e9}) {
    const double e = Case<3>{.wall = false}(dem::CundallStrack{.normal_stiffness = stiffness}).restitution;
    EXPECT_NEAR(e, 1, 1e-4);
  }
}

TEST(LinearSpringDashpot, OverlapStaysWithinTheGateWithTheDefaultTimeStep) {
  Simulation sim{two_grains<2>(1e-5, Vec<2>(-0.1, 0)), UniformGrid<2>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e6, .restitution = 0.6}},
                 Leapfrog{}};
  through_contact(sim, sim.time_step());
  EXPECT_NEAR((sim.particles()[velocity][1][0] - sim.particles()[velocity][0][0]) / 0.1, 0.6, 0.003);
}

TEST(LinearSpringDashpot, WithoutTensionNeverPulls) {
  const dem::CundallStrack law{.normal_stiffness = 1e6, .restitution = 0.3, .tension = false};
  Simulation sim{two_grains<2>(1e-6, Vec<2>(-0.1, 0)), UniformGrid<2>{}, dem::Contacts{law},
                 Leapfrog{}};
  double least = 1;
  for (int k = 0; k < 200; ++k) {
    sim.step(sim.time_step());
    sim.interaction().for_each_contact(sim.particles(),
                                       [&](Index, Index, const auto& contact, const Vec<2>& f) {
                                         least = std::min(least, f.dot(contact.normal));
                                       });
  }
  EXPECT_EQ(least, 0);
}

}  // namespace
}  // namespace silt::test
