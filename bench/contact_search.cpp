// SPDX-License-Identifier: MIT
// Contact search: contact_search/<search>/<dimension>/<precision>/<radius>/<what>/<particles>.
//
//   dense   density of a packing, radius of 1.05 diameters, as in DEM
//   mps     a jittered lattice, radius of 3.1 spacings, about 118 neighbours in 3D, as in MPS
//
//   full    sort the particles into cells, and list the neighbours of every particle
//   half    the same with each pair once, as for contacts
//   random  like half, for particles in random order, which are sorted first
//   kept    a step between two rebuilds of a list with skin: check it, and traverse it
//   pairs   all pairs within the radius, each once
//
//   sizes   spheres of one diameter, and the same volume of spheres ten times as large, with one
//           grid, and with a grid for each size; half: list each pair once
//
// Particles are in cell order, as in a simulation. The number of threads is OMP_NUM_THREADS;
// brute_force and nanoflann (build the tree, query it for every particle) have one.
#include <silt/core/parallel.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/level_grid.hpp>
#include <silt/search/neighbour_list.hpp>
#include <silt/search/uniform_grid.hpp>

#include <benchmark/benchmark.h>

#include "points.hpp"
#include "program.hpp"

#ifdef SILT_BENCH_NANOFLANN
#include <nanoflann.hpp>
#endif

#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

using namespace silt;
using bench::Density;

// Neighbours per particle, and the time per particle by the number of particles.
void report(benchmark::State& state, double neighbours) {
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
  state.counters["neighbours"] = neighbours / double(state.range(0));
}

template <int Dim, class Real>
Particles<Dim, Real> in_cell_order(const benchmark::State& state, Density density) {
  auto particles = bench::particles<Dim, Real>(static_cast<Index>(state.range(0)), density);
  UniformGrid<Dim, Real> grid({.radius = static_cast<Real>(bench::reach(density))});
  grid.update(particles);
  particles.reorder(grid.order());
  return particles;
}

template <int Dim, class Real>
void grid_lists(benchmark::State& state, Density density, Pairs pairs) {
  auto particles = in_cell_order<Dim, Real>(state, density);
  UniformGrid<Dim, Real> grid({.radius = static_cast<Real>(bench::reach(density))});
  NeighbourRows rows;
  const auto step = [&] {
    grid.sort(particles);
    grid.update(particles);
    grid.build_rows(rows, pairs);
    benchmark::ClobberMemory();
  };
  step();  // allocates memory
  for (auto _ : state) step();
  report(state, double(rows.entries()) * (pairs == Pairs::once ? 2 : 1));
}

template <int Dim, class Real>
void grid_lists_from_random_order(benchmark::State& state, Density density) {
  const auto start = bench::particles<Dim, Real>(static_cast<Index>(state.range(0)), density);
  auto particles = start;
  UniformGrid<Dim, Real> grid({.radius = static_cast<Real>(bench::reach(density))});
  NeighbourRows rows;
  for (auto _ : state) {
    state.PauseTiming();
    particles = start;
    state.ResumeTiming();
    grid.sort(particles);
    grid.update(particles);
    grid.build_rows(rows, Pairs::once);
    benchmark::ClobberMemory();
  }
  report(state, 2 * double(rows.entries()));
}

template <int Dim, class Real>
void keep_list(benchmark::State& state, Density density) {
  auto particles = in_cell_order<Dim, Real>(state, density);
  NeighbourList<Dim, Real> list(
      {.radius = static_cast<Real>(bench::reach(density)), .skin_fraction = Real(0.1)});
  const auto step = [&] {
    list.sort(particles);
    list.update(particles);
    std::vector<Index> candidates(chunk_count(particles.size()));
    for_each_chunk(particles.size(), [&](Chunk chunk) {
      Index count = 0;
      for (Index i = chunk.first; i < chunk.last; ++i) {
        list.for_each_candidate(i, [&count, i](Index j) { count += i ^ j ? 1 : 0; });
      }
      candidates[chunk.number] = count;
    });
    benchmark::DoNotOptimize(candidates.data());
  };
  step();
  step();
  for (auto _ : state) step();
  double pairs = 0;
  list.for_each_pair([&](Index, Index, const auto&, Real) { ++pairs; });
  report(state, 2 * pairs);
}

// Radii ½ and 5; overlaps are ignored.
template <class Search>
void lists_of_two_sizes(benchmark::State& state) {
  const auto n = static_cast<Index>(state.range(0));
  Particles<3, double, radius_t> spheres;
  std::mt19937_64 random(20040101);
  std::uniform_real_distribution<double> along(0, std::cbrt(2 * double(n)));
  for (Index i = 0; i < n; ++i) {
    const double x = along(random);
    const double y = along(random);
    spheres.add({x, y, along(random)});
    spheres[radius][i] = i % 1000 == 0 ? 5 : 0.5;
  }
  UniformGrid<3> order({.radius = 1});
  order.update(spheres);
  spheres.reorder(order.order());
  Search search({.radius = 10});
  NeighbourRows rows;
  const auto step = [&] {
    search.update(spheres);
    search.build_rows(rows, Pairs::once);
    benchmark::ClobberMemory();
  };
  step();  // allocates memory
  for (auto _ : state) step();
  report(state, 2 * double(rows.entries()));
}

template <int Dim, class Real>
void brute_force(benchmark::State& state, Density density) {
  auto particles = in_cell_order<Dim, Real>(state, density);
  BruteForce<Dim, Real> search({.radius = static_cast<Real>(bench::reach(density))});
  Index pairs = 0;
  for (auto _ : state) {
    pairs = 0;
    search.update(particles);
    search.for_each_pair([&pairs](Index, Index, const auto&, Real) { ++pairs; });
    benchmark::DoNotOptimize(pairs);
  }
  report(state, 2 * double(pairs));
}

#ifdef SILT_BENCH_NANOFLANN
template <int Dim, class Real>
struct Cloud {
  std::span<const Vec<Dim, Real>> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  Real kdtree_get_pt(std::size_t i, std::size_t k) const { return points[i][static_cast<int>(k)]; }
  template <class Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};

template <int Dim, class Real>
void nanoflann_lists(benchmark::State& state, Density density) {
  auto particles = in_cell_order<Dim, Real>(state, density);
  const Cloud<Dim, Real> cloud{particles[position]};
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<Real, Cloud<Dim, Real>>,
                                                   Cloud<Dim, Real>, Dim, std::uint32_t>;
  const auto reach = static_cast<Real>(bench::reach(density));
  std::vector<std::uint32_t> neighbours;
  std::vector<Index> first;
  std::vector<std::pair<std::uint32_t, Real>> found;
  for (auto _ : state) {
    Tree tree(Dim, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    neighbours.clear();
    first.assign(1, 0);
    for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
      tree.radiusSearch(cloud.points[i].data(), reach * reach, found,
                        nanoflann::SearchParams(32, 0, false));
      for (const auto& [j, r2] : found) {
        if (j != i) neighbours.push_back(j);
      }
      first.push_back(neighbours.size());
    }
    benchmark::ClobberMemory();
  }
  report(state, double(neighbours.size()));
}
#endif

template <class F>
void add(const std::string& name, std::int64_t max_size, benchmark::BigO complexity, F&& run) {
  auto* const family = benchmark::RegisterBenchmark(("contact_search/" + name).c_str(), run);
  for (const std::int64_t n : {1000, 10000, 100000, 1000000, 4000000}) {
    if (n <= max_size) family->Arg(n);
  }
  family->Complexity(complexity)->Unit(benchmark::kMillisecond)->UseRealTime();
}

template <int Dim, class Real>
void add_all(const std::string& precision) {
  constexpr std::int64_t million = 1000000;
  using benchmark::oN;
  for (const Density density : {Density::dense, Density::mps}) {
    const std::string kind = "/" + std::to_string(Dim) + "d/" + precision +
                             (density == Density::dense ? "/dense" : "/mps");
    for (const Pairs pairs : {Pairs::twice, Pairs::once}) {
      add("uniform_grid" + kind + (pairs == Pairs::once ? "/half" : "/full"), 4 * million, oN,
          [=](benchmark::State& state) { grid_lists<Dim, Real>(state, density, pairs); });
    }
#ifdef SILT_BENCH_NANOFLANN
    if (std::is_same_v<Real, double>) {
      add("nanoflann" + kind + "/full", million, benchmark::oNLogN,
          [=](benchmark::State& state) { nanoflann_lists<Dim, Real>(state, density); });
    }
#endif
    if (density != Density::dense) continue;
    add("uniform_grid" + kind + "/random", million, oN,
        [=](benchmark::State& state) { grid_lists_from_random_order<Dim, Real>(state, density); });
    add("neighbour_list" + kind + "/kept", million, oN,
        [=](benchmark::State& state) { keep_list<Dim, Real>(state, density); });
    add("brute_force" + kind + "/pairs", million / 10, benchmark::oNSquared,
        [=](benchmark::State& state) { brute_force<Dim, Real>(state, density); });
  }
}

}  // namespace

int main(int argc, char** argv) {
  add_all<3, double>("double");
  add_all<3, float>("float");
  add_all<2, double>("double");
  add_all<2, float>("float");
  add("uniform_grid/3d/double/sizes/half", 100000, benchmark::oN, lists_of_two_sizes<UniformGrid<3>>);
  add("level_grid/3d/double/sizes/half", 1000000, benchmark::oN, lists_of_two_sizes<LevelGrid<3>>);
  return bench::run(argc, argv);
}
