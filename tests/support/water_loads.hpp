// SPDX-License-Identifier: MIT
// Water and its loads on walls, which momentum knows as well.
#pragma once

#include "support/points.hpp"

#include <silt/geometry/shapes.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace silt::test {

/// Water of 1000 kg/m³ between walls, in 2D.
struct WaterScene {
  double spacing = 0;                  ///< l0 [m]
  std::vector<Box<2>> water = {};      ///< at rest if nothing else is said
  Vec<2> velocity = Vec<2>::Zero();    ///< [m/s]
  std::vector<Face<2>> walls = {};
  Vec<2> gravity = {0, -9.81};         ///< [m/s²]
  double speed_scale = 2;              ///< [m/s]
  double jitter = 0;                   ///< [spacings]
  double angle = 0;                    ///< by which all of it is turned about the origin [rad]

  double mass() const { return 1000 * spacing * spacing; }  ///< of a particle [kg/m]

  template <class Scheme = mps::Recommended>
  auto simulation() const {
    const auto turn = [c = std::cos(angle), s = std::sin(angle)](const Vec<2>& x) {
      return Vec<2>(c * x[0] - s * x[1], s * x[0] + c * x[1]);
    };
    mps::FlowSettings<2, Scheme> settings{
        .spacing = spacing, .gravity = turn(gravity), .speed_scale = speed_scale};
    settings.walls.segments = walls;
    for (auto& face : settings.walls.segments) {
      for (auto& corner : face.corners) corner = turn(corner);
    }
    mps::Fluid<2> fluid;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> move(-jitter * spacing, jitter * spacing);
    for (const auto& box : water) {
      for (Vec<2> x : lattice<2>(box, spacing)) {
        for (double& coordinate : x) coordinate += move(random);
        const Index i = mps::add_particle(fluid, turn(x), mps::Kind::fluid);
        fluid[silt::velocity][i] = turn(velocity);
      }
    }
    return Simulation{std::move(fluid), UniformGrid<2>{}, mps::Flow<Scheme>(settings),
                      SemiImplicit<>{}};
  }
};

/// Σ m u_x [N s/m].
template <class P>
double horizontal_momentum(const P& particles, double mass) {
  double sum = 0;
  for (const auto& u : particles[velocity]) sum += mass * u[0];
  return sum;
}

/// Largest rise of an energy within 100 steps.
class LargestRise {
 public:
  void add(double energy) {
    energies_.push_back(energy);
    const std::size_t first = energies_.size() - std::min<std::size_t>(energies_.size(), 101);
    const auto begin = energies_.begin() + static_cast<std::ptrdiff_t>(first);
    largest_ = std::max(largest_, energy - *std::min_element(begin, energies_.end()));
  }
  /// Over the first energy [-].
  double share() const { return largest_ / energies_.front(); }

 private:
  std::vector<double> energies_;
  double largest_ = 0;
};

/// Runs until a time [s]; after_step(particles, Δt) is called after each step. Returns the largest
/// rise of the energy within 100 steps, over the first energy.
template <class Sim, class F>
double run_water(Sim& sim, double until, F&& after_step) {
  LargestRise rise;
  rise.add(sim.interaction().energy_of(sim.particles()).total());
  while (sim.time() < until) {
    sim.step();
    rise.add(sim.interaction().energy().total());
    after_step(sim.particles(), sim.last_time_step());
  }
  return rise.share();
}

}  // namespace silt::test
