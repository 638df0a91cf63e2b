// SPDX-License-Identifier: MIT
// Impacts with a linear spring and dashpot: order of convergence and limits. The exact values are
// in validation/dem_reference.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace silt::test::impact_test {
namespace {

// Restitution of a head-on impact of two discs at v0 with `steps` per contact; `phase` is the
// fraction of a step at which the contact begins.
struct Case {
  double steps = 50;
  double phase = 0.5;

  template <class Law>
  double operator()(const Law& law) const {
    const double v0 = 0.1;
    auto grains = two_grains<2>(0, Vec<2>(-v0, 0));
    const double omega = std::sqrt(2 * law.normal_stiffness / grains[mass][0]);
    const double dt = std::numbers::pi / omega / steps;
    grains[position][1][0] += v0 * dt * (1 + phase);
    Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law}.with(without_limits), Leapfrog{}};
    through_contact(sim, dt);
    const auto v = sim.particles()[velocity];
    return (v[1][0] - v[0][0]) / v0;
  }
};

struct Error {
  double worst = 0;
  double mean = 0;
};

// Error of the restitution over all phases of the first step.
template <class Law>
Error error_of(double e, double steps) {
  Error error;
  for (int k = 0; k < 32; ++k) {
    const Case impact{.steps = steps, .phase = (k + 0.5) / 32};
    const double of_phase = impact(Law{.normal_stiffness = 1e6, .restitution = e}) / e - 1;
    error.worst = std::max(error.worst, std::abs(of_phase));
    error.mean += of_phase / 32;
  }
  return error;
}

TEST(LinearSpringDashpot, OverlapFormIsSecondOrderInTheTimeStep) {
  using Overlap = dem::CundallStrack;
  for (const double e : {0.7, 0.5}) {
    // Four times the steps: 1/16 of the error. 1/10 leaves a margin for the phases.
    EXPECT_LT(error_of<Overlap>(e, 200).worst, error_of<Overlap>(e, 50).worst / 10);
  }
}

TEST(LinearSpringDashpot, IncrementalFormConvergesToTheSameRestitutionInFirstOrder) {
  using Incremental = dem::CundallStrackIncremental;
  const Error coarse = error_of<Incremental>(0.7, 100);
  const Error fine = error_of<Incremental>(0.7, 400);
  const Error finest = error_of<Incremental>(0.7, 1600);
  EXPECT_NEAR(coarse.mean / fine.mean, 4, 1);
  EXPECT_NEAR(fine.mean / finest.mean, 4, 1);
  EXPECT_LT(finest.worst, 0.002);
}

TEST(LinearSpringDashpot, ElasticImpactExchangesVelocitiesForAnyStiffness) {
  for (const double stiffness : {1e2, 1e5, 1e9}) {
    EXPECT_NEAR(Case{}(dem::CundallStrack{.normal_stiffness = stiffness}), 1, 1e-4);
  }
}

TEST(LinearSpringDashpot, OverlapStaysBelowTheLimitWithTheDefaultTimeStep) {
  Simulation sim{two_grains<2>(1e-5, Vec<2>(-0.1, 0)), UniformGrid<2>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e6, .restitution = 0.6}},
                 Leapfrog{}};
  through_contact(sim, sim.time_step());
  EXPECT_NEAR((sim.particles()[velocity][1][0] - sim.particles()[velocity][0][0]) / 0.1, 0.6,
              0.003);
}

TEST(LinearSpringDashpot, WithLimitedDampingIsNeverAttractive) {
  const dem::CundallStrack law{.normal_stiffness = 1e6, .restitution = 0.3, .limit_damping = true};
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
}  // namespace silt::test::impact_test
