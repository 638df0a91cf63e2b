// SPDX-License-Identifier: MIT
// Definitions for bench.hpp; included by one source file for each dimension.
#pragma once

#include "bench.hpp"

#include <limits>

namespace silt::test {

template <int Dim>
dem::Plane<Dim> wall_of(const BenchSetup<Dim>& setup, std::size_t number) {
  if (number < setup.walls.size()) return setup.walls[number];
  return {.point = -1e6 * Vec<Dim>::Unit(0), .normal = Vec<Dim>::Unit(0)};
}

template <int Dim>
auto simulate(const dem::Grains<Dim>& grains, const BenchSetup<Dim>& setup) {
  const auto contacts = dem::Contacts{setup.law, wall_of(setup, 0), wall_of(setup, 1)}.with(
      {.check_stability = setup.check_stability,
       .max_displacement = std::numeric_limits<double>::infinity()});
  return Simulation{grains, UniformGrid<Dim>{}, Forces{Gravity<Dim>{setup.gravity}, contacts},
                    Leapfrog{GlobalDamping{.alpha = setup.alpha}}};
}

template <int Dim>
struct Bench<Dim>::Simulated {
  decltype(simulate<Dim>(std::declval<Grains>(), std::declval<BenchSetup<Dim>>())) simulation;
  const auto& contacts() const { return simulation.interaction().template part<1>(); }
};

template <int Dim>
Bench<Dim>::Bench(const Grains& grains, const BenchSetup<Dim>& setup)
    : simulated_(new Simulated{simulate(grains, setup)}) {}
template <int Dim>
Bench<Dim>::~Bench() = default;

template <int Dim>
const dem::Grains<Dim>& Bench<Dim>::grains() const {
  return simulated_->simulation.particles();
}
template <int Dim>
dem::Grains<Dim> Bench<Dim>::at_whole_step() const {
  return simulated_->simulation.snapshot();
}
template <int Dim>
double Bench<Dim>::time() const {
  return simulated_->simulation.time();
}
template <int Dim>
double Bench<Dim>::time_step() {
  return simulated_->simulation.time_step();
}
template <int Dim>
void Bench<Dim>::step(double dt) {
  simulated_->simulation.step(dt);
}
template <int Dim>
void Bench<Dim>::run(double until) {
  simulated_->simulation.run({.until = until});
}
template <int Dim>
void Bench<Dim>::run(double until, double dt) {
  simulated_->simulation.run({.until = until, .time_step = dt});
}
template <int Dim>
Index Bench<Dim>::contacts() const {
  return simulated_->contacts().size();
}
template <int Dim>
void Bench<Dim>::for_each_contact(const OnContact& f) const {
  simulated_->contacts().for_each_contact(grains(), f);
}
template <int Dim>
double Bench<Dim>::through_contact(double dt) {
  double max_overlap = 0;
  while (max_overlap == 0 || contacts() > 0) {
    step(dt);
    for_each_contact([&](Index, Index, const auto& contact, const auto&) {
      max_overlap = std::max(max_overlap, contact.overlap);
    });
  }
  return max_overlap;
}

}  // namespace silt::test
