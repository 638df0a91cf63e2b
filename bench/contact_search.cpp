// SPDX-License-Identifier: MIT
// Contact search: contact_search/<search>/<dimension>/<precision>/<particles>. An iteration is what
// a step of DEM asks for: the positions are new, and every pair within the reach is met once.
//
// The particles do not move, so that neighbour_list builds its list but once: what is measured is a
// step between two rebuilds, and how many those are depends on the flow.
#include <silt/core/parallel.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/neighbour_list.hpp>
#include <silt/search/uniform_grid.hpp>

#include <benchmark/benchmark.h>

#include "points.hpp"
#include "program.hpp"

#include <string>

namespace {

using namespace silt;

template <class Search, int Dim, class Real>
void search_contacts(benchmark::State& state) {
  const auto n = static_cast<Index>(state.range(0));
  auto particles = bench::particles<Dim, Real>(n);
  Search search;
  search.set_radius(static_cast<Real>(bench::reach));
  Index pairs = 0;
  for (auto _ : state) {
    pairs = 0;
    search.update(particles);
    search.for_each_pair([&pairs](Index, Index, const auto&, Real) { ++pairs; });
    benchmark::DoNotOptimize(pairs);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
  state.counters["neighbours"] = 2 * double(pairs) / double(n);
}

struct Sizes {
  std::int64_t largest;
  benchmark::BigO complexity;
};

template <class Search, int Dim, class Real>
void add(const std::string& search, const std::string& precision, const Sizes& sizes) {
  const std::string name =
      "contact_search/" + search + "/" + std::to_string(Dim) + "d/" + precision;
  auto* const family =
      benchmark::RegisterBenchmark(name.c_str(), search_contacts<Search, Dim, Real>);
  for (const std::int64_t n : {100, 316, 1000, 3162, 10000, 31623, 100000, 316228, 1000000}) {
    if (n <= sizes.largest) family->Arg(n);
  }
  family->Complexity(sizes.complexity)->Unit(benchmark::kMicrosecond);
}

template <int Dim, class Real>
void add_all(const std::string& precision) {
  constexpr Sizes all{1000000, benchmark::oN};
  add<UniformGrid<Dim, Real>, Dim, Real>("uniform_grid", precision, all);
  add<NeighbourList<Dim, Real>, Dim, Real>("neighbour_list", precision, all);
  add<BruteForce<Dim, Real>, Dim, Real>("brute_force", precision,
                                        {31623, benchmark::oNSquared});
}

}  // namespace

int main(int argc, char** argv) {
  use_threads(1);  // pairs are met one after the other
  add_all<2, double>("double");
  add_all<2, float>("float");
  add_all<3, double>("double");
  add_all<3, float>("float");
  return bench::run(argc, argv);
}
