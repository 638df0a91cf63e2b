// SPDX-License-Identifier: MIT
// DEM steps with polydisperse grains: size_ratio/<search>/<ratio>, with the ratio of the largest to
// the smallest radius, and the same mass in each tenth of that range. The time per contact should
// hardly depend on the ratio.
//
// Grains are scattered in a periodic cube, then enlarged until each has a few contacts, with small
// random velocities.
#include "program.hpp"

#include <silt/dem.hpp>
#include <silt/dem/setup/packing.hpp>

#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace silt;

constexpr Index number = 20000;
constexpr double max_radius = 1;
constexpr double solid_fraction = 0.28;

dem::SieveSizes sizes_of(double ratio) {
  constexpr int parts = 10;
  std::vector<dem::SieveSizes::Fraction> fractions;
  const double smallest = max_radius / ratio;
  const double width = (max_radius - smallest) / parts;
  for (int k = 0; k < parts; ++k) {
    fractions.push_back({.min_radius = smallest + k * width,
                         .max_radius = smallest + (k + 1) * width,
                         .mass = 1});
  }
  return dem::SieveSizes(fractions);
}

dem::Grains<3> grains_of(double ratio) {
  const dem::Blend<dem::SieveSizes> blend{.sizes = sizes_of(ratio), .density = 1};
  double volume = 0;
  for (Id id = 0; id < number; ++id) {
    Random random{.id = id};
    volume += dem::volume_of<3>(blend.sizes.radius(random));
  }
  Box<3> box;
  box.lower.setZero();
  box.upper.setConstant(std::cbrt(volume / solid_fraction));
  box.periodic.fill(true);
  dem::Grains<3> grains(box);
  dem::scatter(grains, blend, box, {.number = number});
  for (Index i = 0; i < number; ++i) {
    grains[radius][i] *= 1.2;
    Random random{.seed = 1, .id = grains.id(i)};
    for (int k = 0; k < 3; ++k) grains[velocity][i][k] = 0.01 * random.normal();
  }
  return grains;
}

template <class S>
void step(benchmark::State& state) {
  static std::map<std::int64_t, dem::Grains<3>> all;
  const std::int64_t ratio = state.range(0);
  if (!all.contains(ratio)) all.emplace(ratio, grains_of(double(ratio)));
  const dem::CundallStrack law{
      .normal_stiffness = 1, .tangential_stiffness = 0.5, .restitution = 0.5, .friction_angle = 0.4};
  // A fifth of the sum of two radii may be more than half of the smaller one.
  const dem::ContactSettings settings{.max_overlap = std::numeric_limits<double>::infinity()};
  Simulation heap{all.at(ratio), S{}, dem::Contacts{law}.with(settings), Leapfrog{}};
  const double dt = heap.time_step();
  for (int k = 0; k < 30; ++k) heap.step(dt);
  for (auto _ : state) heap.step(dt);
  const auto contacts = double(heap.interaction().size());
  state.counters["contacts"] = 2 * contacts / double(number);
  state.counters["per_contact"] = benchmark::Counter(
      contacts * double(state.iterations()),
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["per_grain"] = benchmark::Counter(
      double(number) * double(state.iterations()),
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class S>
void add(const std::string& search) {
  for (const std::int64_t ratio : {1, 3, 10, 20}) {
    benchmark::RegisterBenchmark(("size_ratio/" + search).c_str(), step<S>)
        ->Arg(ratio)->Iterations(50)->Unit(benchmark::kMillisecond);
  }
}

}  // namespace

int main(int argc, char** argv) {
  add<NeighbourList<3>>("neighbour_list");
  add<NeighbourList<3, double, LevelGrid<3>>>("list_over_levels");
  add<LevelGrid<3>>("level_grid");
  return bench::run(argc, argv);
}
