// SPDX-License-Identifier: MIT
// Whole steps of DEM: dem_step/<search>/<dimension>/<particles> advances a bed that has settled
// under gravity, with friction, on all threads that OpenMP gives.
#include <silt/dem.hpp>

#include <benchmark/benchmark.h>

#include "program.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <string>

namespace {

using namespace silt;

constexpr double R = 0.01;           // [m]
constexpr double gravity = 9.81;     // [m/s²]
constexpr double stiffness = 1e6;    // [N/m]
constexpr int settling_steps = 50;   // the lattice begins with its contacts pressed: few are enough

// A bed 20 (10) grains high, in columns (and rows) that touch one another, between periodic sides.
template <int Dim>
dem::Grains<Dim> make_bed(Index n) {
  const dem::Grain grain{.radius = R, .density = 2500};
  const Index high = Dim == 2 ? 20 : 10;
  const auto wide =
      static_cast<Index>(std::round(std::pow(double(n) / double(high), 1.0 / (Dim - 1))));
  const double spacing = 2 * R * (1 - 1e-4);
  Box<Dim> box;
  Box<Dim> filled;
  for (int k = 0; k + 1 < Dim; ++k) {
    box.lower[k] = filled.lower[k] = 0;
    box.upper[k] = filled.upper[k] = double(wide) * spacing;
    box.periodic[static_cast<std::size_t>(k)] = true;
  }
  filled.lower[Dim - 1] = 0;
  filled.upper[Dim - 1] = double(high) * spacing;
  dem::Grains<Dim> grains(box);
  for (const auto& x : lattice<Dim>(filled, spacing)) dem::add_grain(grains, x, grain);
  return grains;
}

template <class Search, int Dim>
auto settle_bed(Index n) {
  const dem::CundallStrack law{.normal_stiffness = stiffness,
                               .tangential_stiffness = stiffness / 2,
                               .restitution = 0.3,
                               .friction_angle = 0.5};
  const Vec<Dim> g = -gravity * Vec<Dim>::Unit(Dim - 1);
  Simulation bed{make_bed<Dim>(n), Search{},
                 Forces{Gravity<Dim>{g}, dem::Contacts{law, dem::Plane<Dim>{}}},
                 Leapfrog{GlobalDamping{.alpha = 10}}};
  for (int k = 0; k < settling_steps; ++k) bed.step();
  return bed;
}

template <class Search, int Dim>
void step_bed(benchmark::State& state) {
  // Google Benchmark calls this several times for one figure; the bed settles once.
  static std::map<std::int64_t, decltype(settle_bed<Search, Dim>(0))> beds;
  const std::int64_t wanted = state.range(0);
  if (!beds.contains(wanted)) {
    beds.clear();
    beds.emplace(wanted, settle_bed<Search, Dim>(static_cast<Index>(wanted)));
  }
  auto& bed = beds.at(wanted);
  const double dt = bed.time_step();
  for (auto _ : state) bed.step(dt);

  const auto n = double(bed.particles().size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(n));
  state.SetComplexityN(static_cast<std::int64_t>(n));
  const auto& contacts = bed.interaction().template part<1>();
  state.counters["contacts"] = double(contacts.size()) / n;
  state.counters["threads"] = threads();
}

template <class Search, int Dim>
void add(const std::string& search) {
  const std::string name = "dem_step/" + search + "/" + std::to_string(Dim) + "d";
  benchmark::RegisterBenchmark(name.c_str(), step_bed<Search, Dim>)
      ->Arg(1000)->Arg(10000)->Arg(100000)
      ->Complexity(benchmark::oN)->Unit(benchmark::kMicrosecond)->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
  add<UniformGrid<2>, 2>("uniform_grid");
  add<NeighbourList<2>, 2>("neighbour_list");
  add<UniformGrid<3>, 3>("uniform_grid");
  add<NeighbourList<3>, 3>("neighbour_list");
  return bench::run(argc, argv);
}
