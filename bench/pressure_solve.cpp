// SPDX-License-Identifier: MIT
// Pressure solves alone: pressure_solve/<solver>/<tank>/<unknowns>, from zero to a residual of
// 1e-6, on all OpenMP threads. setup_ms and solve_ms are parts of the time (for eigen, solve_ms is
// the total); the assembly is not included.
//
// The tanks are squares (cubes) full of fluid particles displaced from a lattice, with about the
// given number of unknowns:
//   2d, 3d           open at the top
//   baffles_2d, …_3d open at the top, with three vertical walls, three quarters of the height, just
//                    thick enough to separate the fluid on both sides
//   closed_2d, …_3d  with a lid, without a free surface: pressure up to a constant
// The radius is that of mps_step.cpp: 3.1 spacings in 2D, 2.1 in 3D.
#include <silt/mps.hpp>
#include <silt/solve/eigen_conjugate_gradient.hpp>
#include <silt/solve/incomplete_cholesky.hpp>
#ifdef SILT_BENCH_HYPRE
#include <silt/solve/hypre.hpp>
#endif

#include <benchmark/benchmark.h>

#include "program.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace silt;

enum class Shape { open, baffles, closed };

constexpr double l0 = 0.01;  // [m]
constexpr double radius_of(int dim) { return dim == 2 ? 3.1 : 2.1; }

template <int Dim>
LinearSystem equation_of(Shape shape, Index unknowns) {
  const double along = std::round(std::pow(double(unknowns), 1.0 / Dim));
  std::mt19937_64 random(1996);
  std::uniform_real_distribution<double> shift(-0.15 * l0, 0.15 * l0);
  const double thickness = std::ceil(radius_of(Dim));
  mps::Fluid<Dim> fluid;
  std::vector<std::uint8_t> on_top;
  for (auto x : lattice<Dim>({Vec<Dim>(Vec<Dim>::Zero()), Vec<Dim>(Vec<Dim>::Constant(along * l0))}, l0)) {
    const double behind_wall = std::fmod(x[0] / l0, std::round(along / 4));  // or the tank's side
    const bool in_baffle = shape == Shape::baffles && behind_wall < thickness &&
                           x[0] > thickness * l0 && x[Dim - 1] < 0.75 * along * l0;
    const bool is_top = x[Dim - 1] > (along - 1) * l0;
    for (int k = 0; k < Dim; ++k) x[k] += shift(random);
    mps::add_particle(fluid, x, in_baffle ? mps::Kind::dummy : mps::Kind::fluid);
    on_top.push_back(is_top && shape != Shape::closed);
  }
  for (Index i = 0; i < fluid.size(); ++i) fluid[mps::surface][i] = on_top[i];
  const mps::Stencil<Dim, double, mps::CubicKernel> stencil(
      {.spacing = l0, .radius = radius_of(Dim)});
  UniformGrid<Dim> search({.radius = stencil.re});
  search.update(fluid);
  fluid.reorder(search.order());
  search.update(fluid);
  mps::PressureEquation equation;
  equation.assemble(fluid, search, stencil,
                    [](Index i) { return -1e4 - 2e3 * std::sin(double(i)); });
  return equation.system();
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A preconditioner that measures its setup time [s].
template <class M>
struct Timed : M {
  double setup = 0;
  void prepare(const LinearSystem& system) {
    const double begin = now();
    M::prepare(system);
    setup += now() - begin;
  }
};

template <class Solver, int Dim>
void solve(benchmark::State& state, Shape shape) {
  const LinearSystem system = equation_of<Dim>(shape, static_cast<Index>(state.range(0)));
  Solver solver({.tolerance = 1e-6});
  const auto setup_so_far = [&solver] {
    if constexpr (requires { solver.preconditioner().setup; }) return solver.preconditioner().setup;
    return 0.0;  // unknown: included in the solve
  };
  std::vector<double> x(system.size(), 0);
  SolveReport report = solver.solve(system, x);  // the first solve allocates memory
  const double cold = setup_so_far();
  const double begin = now();
  for (auto _ : state) {
    x.assign(system.size(), 0);
    report = solver.solve(system, x);
  }
  const double solves = double(state.iterations());
  const double setup = (setup_so_far() - cold) / solves;
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(system.size()));
  state.SetComplexityN(static_cast<std::int64_t>(system.size()));
  state.counters["unknowns"] = double(system.size());
  state.counters["iterations"] = report.iterations;
  state.counters["setup_ms"] = 1e3 * setup;
  state.counters["solve_ms"] = 1e3 * ((now() - begin) / solves - setup);
  state.counters["threads"] = threads();
  if (report.reason != SolveReport::Reason::converged) state.SkipWithError("did not converge");
}

template <class Solver, int Dim>
void add(const std::string& solver, const std::string& tank, Shape shape, std::int64_t max_size) {
  const std::string name = "pressure_solve/" + solver + "/" + tank + std::to_string(Dim) + "d";
  auto* benchmark = benchmark::RegisterBenchmark(name.c_str(), solve<Solver, Dim>, shape);
  for (const std::int64_t n : {1000, 3000, 10000, 30000, 100000, 300000, 1000000}) {
    if (n <= max_size) benchmark->Arg(n);
  }
  benchmark->Unit(benchmark::kMillisecond)->UseRealTime();
}

template <class M>
using With = ConjugateGradient<Timed<M>>;

template <class Solver>
void add_open(const std::string& solver, std::int64_t max_size) {
  add<Solver, 2>(solver, "", Shape::open, max_size);
  add<Solver, 3>(solver, "", Shape::open, max_size);
}

template <int Dim>
void add_multigrid() {
  for (const auto& [tank, shape] : {std::pair{"", Shape::open}, std::pair{"baffles_", Shape::baffles},
                                    std::pair{"closed_", Shape::closed}}) {
    add<With<CellMultigrid<Dim>>, Dim>("multigrid", tank, shape, 1000000);
  }
}

#ifdef SILT_BENCH_HYPRE
// The best threshold found by trial: in these stencils, all neighbours have similar weights.
struct Hypre : BoomerAmg {
  Hypre() : BoomerAmg({.strong_threshold = 0.1}) {}
};
#endif

}  // namespace

int main(int argc, char** argv) {
  add_multigrid<2>();
  add_multigrid<3>();
  add_open<With<Jacobi>>("jacobi", 300000);
  add_open<With<IncompleteCholesky>>("ic", 300000);
  add_open<EigenConjugateGradient>("eigen", 300000);
#ifdef SILT_BENCH_HYPRE
  MPI_Init(&argc, &argv);
  add_open<With<Hypre>>("hypre", 300000);
  const int failed = bench::run(argc, argv);
  MPI_Finalize();
  return failed;
#else
  return bench::run(argc, argv);
#endif
}
