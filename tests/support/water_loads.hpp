// SPDX-License-Identifier: MIT
// Water and its loads on walls, which momentum knows as well.
#pragma once

#include "support/points.hpp"

#include <silt/core/error.hpp>
#include <silt/core/lattice.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace silt::test {

/// Of these cases, if no other is given.
using WaterScheme = mps::Recommended;

/// Water of 1000 kg/m³ between walls, in 2D.
struct WaterScene {
  double spacing = 0;                  ///< l0 [m]
  std::vector<Box<2>> water = {};      ///< at rest if nothing else is said
  Vec<2> velocity = Vec<2>::Zero();    ///< [m/s]
  std::vector<Face<2>> walls = {};
  std::vector<Box<2>> room = {};       ///< between the walls; for schemes with wall particles
  Vec<2> gravity = {0, -9.81};         ///< [m/s²]
  double speed_scale = 2;              ///< [m/s]
  double jitter = 0;                   ///< [spacings]
  double angle = 0;                    ///< by which all of it is turned about the origin [rad]

  double mass() const { return 1000 * spacing * spacing; }  ///< of a particle [kg/m]

  template <class Scheme = WaterScheme>
  auto simulation() const {
    const auto turn = [c = std::cos(angle), s = std::sin(angle)](const Vec<2>& x) {
      return Vec<2>(c * x[0] - s * x[1], s * x[0] + c * x[1]);
    };
    mps::FlowSettings<2, Scheme> settings{
        .spacing = spacing, .gravity = turn(gravity), .speed_scale = speed_scale};
    mps::Fluid<2> fluid;
    if constexpr (requires { settings.walls.segments; }) {
      settings.walls.segments = walls;
      for (auto& face : settings.walls.segments) {
        for (auto& corner : face.corners) corner = turn(corner);
      }
    } else {
      add_solids([&](const Vec<2>& x, mps::Kind kind) { mps::add_particle(fluid, turn(x), kind); });
    }
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

 private:
  // A layer of wall particles around the room, open above, and dummies behind it.
  template <class Add>
  void add_solids(Add&& add) const {
    if (room.empty()) fail("WaterScene: no room, which a scheme with wall particles needs");
    constexpr int layers = 4;
    Box<2> all = room[0];
    for (const auto& part : room) {
      all.lower = all.lower.cwiseMin(part.lower);
      all.upper = all.upper.cwiseMax(part.upper);
    }
    all.lower.array() -= layers * spacing;
    all.upper[0] += layers * spacing;
    for (const Vec<2>& x : lattice<2>(all, spacing)) {
      double outside = layers * spacing;
      for (const auto& part : room) {
        outside = std::min(outside, (part.lower - x).cwiseMax(x - part.upper).maxCoeff());
      }
      if (outside > 0) add(x, outside < spacing ? mps::Kind::wall : mps::Kind::dummy);
    }
  }
};

/// A vertical piece of a wall.
struct WallPiece {
  double x;                ///< [m]
  double from, to;         ///< heights [m]
  double normal;           ///< 1 or −1, into the water
};

/// Mean pressure on it [Pa]: that of its wall particles, or of a gauge at its middle.
template <class P>
double pressure_on(const P& particles, const WallPiece& wall, double l0) {
  if (mps::count(particles, mps::Kind::wall) == 0) {
    const Vec<2> middle{wall.x, (wall.from + wall.to) / 2};
    return WallGauge<2>{middle, {wall.normal, 0}, l0}.read(particles, mps::pressure);
  }
  double sum = 0, number = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    const auto& x = particles[position][i];
    if (particles[mps::kind][i] != mps::Kind::wall || x[1] < wall.from || x[1] > wall.to) continue;
    const double behind = (wall.x - x[0]) * wall.normal;
    if (behind > 0 && behind < l0) sum += particles[mps::pressure][i], number += 1;
  }
  return number > 0 ? sum / number : 0;
}
/// Force of the pressures on it, against its normal [N/m]: of its wall particles, or of gauges a
/// spacing apart.
template <class P>
double pressure_load_on(const P& particles, const WallPiece& wall, double l0) {
  if (mps::count(particles, mps::Kind::wall) > 0) {
    return (wall.to - wall.from) * pressure_on(particles, wall, l0);
  }
  mps::Fluid<2> near;
  for (Index i = 0; i < particles.size(); ++i) {
    const auto& x = particles[position][i];
    if (std::abs(x[0] - wall.x) > 2.01 * l0) continue;
    const Index k = mps::add_particle(near, x, mps::Kind::fluid);
    near[mps::pressure][k] = particles[mps::pressure][i];
  }
  const double gauges = std::ceil((wall.to - wall.from) / l0 - 0.01);
  const double width = (wall.to - wall.from) / gauges;
  double load = 0;
  for (double k = 0; k < gauges; ++k) {
    const double y = wall.from + k * width;
    load += width * pressure_on(near, {wall.x, y, y + width, wall.normal}, l0);
  }
  return load;
}

/// Horizontal force on it, against its normal [N/m]; not a number without walls of faces.
template <class Sim>
double load_on(const Sim& sim, const WallPiece& wall) {
  if constexpr (requires { sim.interaction().walls().faces(); }) {
    Face<2> face{{Vec<2>(wall.x, wall.from), Vec<2>(wall.x, wall.to)}};
    if (wall.normal > 0) face = reversed(face);
    return -wall.normal * WallLoad<2>{{face}}.read(sim)[0];
  } else {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

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
  constexpr double shortest = 1e-6;  // of a time step [s]; an unstable flow would not end
  LargestRise rise;
  rise.add(sim.interaction().energy_of(sim.particles()).total());
  while (sim.time() < until) {
    sim.step();
    if (sim.last_time_step() < shortest) {
      fail("run_water: the time step is only " + to_text(sim.last_time_step()) + " s",
           {.step = sim.steps(), .time = sim.time()});
    }
    rise.add(sim.interaction().energy().total());
    after_step(sim.particles(), sim.last_time_step());
  }
  return rise.share();
}

}  // namespace silt::test
