// SPDX-License-Identifier: MIT
// Smooth spheres on a vibrating floor, as in examples/vibrating_floor.cpp, but fewer and softer:
// exact results and trends. The slow test compares with the kinetic theory of
// examples/support/kinetic_theory.py.
// Only with --all: a comparison of whole beds.
#include <silt/dem.hpp>
#include <silt/measure/block_sums.hpp>
#include <silt/measure/profiles.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace silt::test::vibrating_floor_test {
namespace {

constexpr double g = 9.81;
constexpr double d = 0.1;
constexpr double frequency = 50;
constexpr double pi = std::numbers::pi;

struct Bed {
  int spheres = 0;
  double width = 0;      // of the cell, in diameters
  double warm_up = 0;    // [s]
  double until = 0;      // [s]

  double mass_holdup() const { return spheres * pi / 6 / squared(width); }
};

struct Steady {
  Estimate floor_force;          // over the weight
  Estimate max_solid_fraction;
  double holdup = 0;             // integral of the solid fraction over height, in diameters
  double temperature = 0;        // mass average, over g d
  // Components of the temperature in the lowest two diameters, over g d.
  std::vector<double> vertical = {};
  std::vector<double> horizontal = {};
};

// V_b = 2: an acceleration of 90 g at 50 Hz.
Steady vibrate(const Bed& bed) {
  const double amplitude = 2 * std::sqrt(2 * g * d) / (2 * pi * frequency);
  Box<3> box;
  for (const int k : {0, 1}) {
    box.lower[k] = 0;
    box.upper[k] = bed.width * d;
    box.periodic[Index(k)] = true;
  }
  dem::Grains<3> grains(box);
  const Box<3> filled{.lower = {0, 0, d}, .upper = {bed.width * d, bed.width * d, 10}};
  const auto points = lattice(filled, d);
  for (Index i = 0; i < Index(bed.spheres); ++i) {
    dem::add_grain(grains, points[i], {.radius = d / 2, .density = 1200});
    // Arbitrary, but different directions.
    const double turn = 2.4 * double(i);
    grains[velocity][i] = {std::cos(turn), std::sin(turn), std::cos(3.7 * turn)};
  }
  const dem::Law law{dem::WaltonBraun{.loading_stiffness = 1e6, .restitution = 0.9}};
  const dem::Moving floor{
      dem::Plane<3>{},
      dem::Vibration<3>{.amplitude = {0, 0, amplitude}, .frequency = frequency}};
  Simulation sim{grains, NeighbourList<3>{},
                 Forces{Gravity<3>{{0, 0, -g}}, dem::Contacts{law, floor}}, Leapfrog{}};

  constexpr double sample_every = 1 / frequency / 8;
  const double dt = sample_every / std::ceil(sample_every / sim.time_step());
  sim.run({.until = bed.warm_up, .time_step = dt});
  Profiles<3> profiles(
      {.lower = -d, .upper = 200 * d, .count = 201, .cross_section = squared(bed.width * d)});
  BlockSums loads(1);
  double impulse = 0;
  const double weight = double(bed.spheres) * grains[mass][0] * g;
  const auto steps = static_cast<int>(std::lround(sample_every / dt));
  while (sim.time() < bed.until) {
    for (int k = 0; k < steps; ++k) {
      sim.step(dt);
      const auto& contacts = sim.interaction().part<1>();
      impulse -= contacts.load_on(sim.particles(), 0).force[2] * dt;
    }
    loads.add(std::array{impulse / sample_every / weight});
    impulse = 0;
    profiles.add(sim.particles());
  }

  Steady steady{.floor_force = loads.mean(0),
                .max_solid_fraction = profiles.of_solid_fractions(
                    [](auto fractions) { return *std::ranges::max_element(fractions); })};
  for (const auto& row : profiles.rows()) {
    if (!(row.solid_fraction.value > 0)) continue;
    steady.holdup += row.solid_fraction.value;
    steady.temperature +=
        row.solid_fraction.value * row.temperature.value / (g * d) / bed.mass_holdup();
    if (row.height < 0 || row.height > 2 * d) continue;
    steady.vertical.push_back(row.component[2].value / (g * d));
    steady.horizontal.push_back((row.component[0].value + row.component[1].value) / 2 / (g * d));
  }
  return steady;
}

TEST(VibratingFloor, SupportsTheWeightAndHeatsAThinBedMore) {
  const Steady thin = vibrate({.spheres = 16, .width = 4, .warm_up = 1.5, .until = 7});
  const Steady thick = vibrate({.spheres = 48, .width = 4, .warm_up = 1, .until = 6});
  for (const auto* bed : {&thin, &thick}) {
    EXPECT_NEAR(bed->floor_force.value, 1, std::min(0.05, 4 * bed->floor_force.standard_error));
    for (Index k = 0; k < 2; ++k) EXPECT_GT(bed->vertical[k], bed->horizontal[k]);
    EXPECT_GT(bed->vertical[0], bed->vertical[1]);
  }
  EXPECT_NEAR(thin.holdup, 16 * pi / 6 / 16, 1e-9);
  EXPECT_NEAR(thick.holdup, 48 * pi / 6 / 16, 1e-9);
  EXPECT_GT(thin.temperature, 1.5 * thick.temperature);
  EXPECT_LT(thin.max_solid_fraction.value + 3 * thin.max_solid_fraction.standard_error,
            thick.max_solid_fraction.value);
}

// Kinetic theory: mean temperature 1.733 g d for m_t = 2.503, V_b = 2.
TEST(VibratingFloor, HasTheTemperatureOfKineticTheorySlow) {
  const Bed bed{.spheres = 306, .width = 8, .warm_up = 4, .until = 24};
  const Steady steady = vibrate(bed);
  EXPECT_NEAR(steady.floor_force.value, 1, 0.01);
  EXPECT_NEAR(steady.holdup, bed.mass_holdup(), 1e-9);
  EXPECT_NEAR(steady.temperature, 1.733, 0.1 * 1.733);
}

}  // namespace
}  // namespace silt::test::vibrating_floor_test
