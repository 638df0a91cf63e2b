// SPDX-License-Identifier: MIT
// Contacts that exist at time 0, and those of a step that is not as long as the one before: springs
// are deflected by the motion since the last evaluation.
#include "support/any_law.hpp"
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace silt::test::first_step_test {
namespace {

constexpr double R = pebble.radius;

// Energy of all springs that are deflected by slip or rotation.
struct Deflection {
  double tangential = 0;
  double rolling = 0;
};
template <class C, class P>
Deflection deflection(const C& contacts, const P& grains) {
  Deflection all;
  contacts.for_each_evaluated_contact(grains, [&](const auto& each) {
    all.tangential += each.elastic.tangential;
    all.rolling += each.elastic.rolling;
  });
  return all;
}

// Two grains on a floor, all in contact, of which one approaches the others, slides and rolls.
template <int Dim>
dem::Grains<Dim> sliding_pair() {
  auto grains =
      two_grains<Dim>(-0.02 * R, Vec<Dim>(-0.1 * (Vec<Dim>::Unit(0) + Vec<Dim>::Unit(1))));
  component(grains[spin][1], 0) = 20;
  return grains;
}
template <int Dim>
auto floor_under_pair() {
  return dem::Plane<Dim>{.point = -0.99 * R * Vec<Dim>::Unit(1), .normal = Vec<Dim>::Unit(1)};
}

template <int Dim>
void expect_unwound_springs() {
  for (const auto& [name, law] : all_laws<Dim>()) {
    SCOPED_TRACE(name);
    Simulation sim{sliding_pair<Dim>(), UniformGrid<Dim>{},
                   dem::Contacts{law, floor_under_pair<Dim>()}, Leapfrog{}};
    const auto start = sim.state();
    EXPECT_EQ(start.interaction.size(), 3u);
    const auto expect_none = [](const Deflection& left) {
      EXPECT_EQ(left.tangential, 0);
      EXPECT_EQ(left.rolling, 0);
    };
    expect_none(deflection(start.interaction, start.particles));
    const auto before = sim.particles();
    const double dt = 1e-6;
    sim.step(dt);
    expect_none(deflection(sim.interaction(), before));
    sim.step(dt);
    const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
    const Deflection next = deflection(sim.interaction(), sim.particles());
    EXPECT_EQ(next.tangential > 0, has("riction") || has("indlin") || has("Cundall"));
    EXPECT_EQ(next.rolling > 0, has("rolling"));
  }
}

TEST(FirstStep, BeginsWithUnwoundSprings) {
  expect_unwound_springs<2>();
  expect_unwound_springs<3>();
}

// A grain that sticks to a floor and is pressed into it at time 0. Its surface oscillates:
// u'' = −k_s (1/m + R²/I) u.
struct StickingGrain {
  static constexpr double k = 1e5;
  static constexpr double v0 = 1e-3;
  double omega;  // [1/s]

  auto simulation() const {
    const dem::Law law{dem::LinearSpringDashpot{.normal_stiffness = k},
                       dem::LinearFriction{.tangential_stiffness = k, .friction_angle = 1.5}};
    auto grain = one_grain<3>({0, 0, 0.99 * R}, {v0, 0, 0});
    const auto contacts =
        dem::Contacts{law, dem::Plane<3>{}}.with({.lever_arm = dem::LeverArm::radius});
    return Simulation{grain, UniformGrid<3>{}, contacts, Leapfrog{}};
  }
  // Velocity of the surface [m/s].
  static double slip_velocity(const auto& sim) {
    const auto now = sim.snapshot();
    return now[velocity][0][0] - R * now[spin][0][1];
  }
  double exact(double time) const { return v0 * std::cos(omega * time); }
};

StickingGrain sticking_grain() {
  const double m = one_grain<3>({0, 0, 0}, {0, 0, 0})[mass][0];
  return {.omega = std::sqrt(3.5 * StickingGrain::k / m)};
}

// After a quarter of the period of the tangential spring; the normal one is slower.
TEST(FirstStep, IsOfSecondOrderIfThePairOverlapsAtTime0) {
  const auto grain = sticking_grain();
  const auto deviation = [&](int steps) {
    auto sim = grain.simulation();
    const double dt = std::numbers::pi / 2 / grain.omega / steps;
    for (int step = 0; step < steps; ++step) sim.step(dt);
    EXPECT_EQ(sim.interaction().size(), 1u);
    return std::abs(grain.slip_velocity(sim) - grain.exact(sim.time())) / grain.v0;
  };
  const double coarse = deviation(40);
  const double fine = deviation(80);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

// The dashpot of a contact that slides is inactive; otherwise it would take 0.6 % of the speed.
TEST(FirstStep, DoesNotDampAContactThatSlides) {
  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 8e5,
                               .restitution = 0.5,
                               .friction_angle = 0.3};
  const double overlap = 1e-3 * R;
  const double v0 = 10;
  Simulation sim{one_grain<3>({0, 0, R - overlap}, {v0, 0, 0}), UniformGrid<3>{},
                 dem::Contacts{law, dem::Plane<3>{}}, Leapfrog{}};
  const double dt = sim.time_step();
  sim.step(dt);
  const double friction = std::tan(0.3) * 1e6 * overlap / sim.particles()[mass][0];
  EXPECT_LE(v0 - sim.particles()[velocity][0][0], friction * dt);
}

// An integrator of the user that evaluates the forces several times in a step.
struct Substeps {
  int number = 1;

  template <class P, class S, class I>
  void step(P& particles, S& search, I& interaction, double time_step) {
    for (int k = 0; k < number; ++k) {
      search.update(particles);
      clear(particles);
      interaction.accelerate(particles, search, time_step / number);
      kick(particles, NoDamping{}, time_step / number);
      drift(particles, time_step / number);
    }
  }
};

TEST(ContactSprings, AreDeflectedByEachOfSeveralEvaluationsInAStep) {
  const auto force_after = [](int steps, int substeps) {
    const auto grain = sticking_grain().simulation();
    Simulation sim{grain.particles(), UniformGrid<3>{}, grain.interaction(),
                   Substeps{.number = substeps}};
    for (int step = 0; step < steps; ++step) sim.step(2e-6 * substeps);
    return sim.particles()[force][0][0];
  };
  EXPECT_LT(force_after(8, 1), 0);
  EXPECT_DOUBLE_EQ(force_after(4, 2), force_after(8, 1));
  EXPECT_DOUBLE_EQ(force_after(2, 4), force_after(8, 1));
}

TEST(ContactSprings, AreOfSecondOrderIfTheTimeStepChanges) {
  const auto grain = sticking_grain();
  const double quarter = std::numbers::pi / 2 / grain.omega;
  const auto deviation = [&](int steps) {
    auto sim = grain.simulation();
    while (sim.time() < quarter) {
      sim.step(quarter / steps * (sim.time() < quarter / 3 ? 0.5 : 1));
    }
    return std::abs(grain.slip_velocity(sim) - grain.exact(sim.time())) / grain.v0;
  };
  EXPECT_GT(std::log2(deviation(40) / deviation(80)), 1.7);
}

}  // namespace
}  // namespace silt::test::first_step_test
