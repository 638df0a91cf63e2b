// SPDX-License-Identifier: MIT
// The effect of each choice of mps::Recommended: the scheme with one policy replaced at a time, in
// a still tank, a dam break, the Taylor–Green vortex and the rotating square. Prints one table.
//
//   flow_policies
//   flow_policies --only recommended --only "gradient (18)"
#include <silt/measure/front.hpp>
#include <silt/measure/probe.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>

#include "support/command_line.hpp"
#include "support/fluid_cases/all.hpp"
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace silt;
using namespace silt::mps;

constexpr double g = 9.81;        // [m/s²]
constexpr double l0 = 0.01;       // [m]
constexpr double density = 1000;  // [kg/m³]

struct Options {
  std::vector<std::string> only = {};
};

template <class Scheme>
auto in_tank(const Tank<2>& tank) {
  const auto made = make_tank<Scheme, 2>(tank);
  return Simulation{made.particles, UniformGrid<2>{},
                    Flow<Scheme>{{.spacing = l0,
                                  .speed_scale = std::sqrt(g * tank.column[1]),
                                  .walls = made.walls}},
                    SemiImplicit<>{}};
}

// The pressure at a point of a wall: at a face, or of the wall particles there [Pa].
template <class Scheme, class P>
double pressure_at_wall(const P& water, const Vec<2>& point, const Vec<2>& normal) {
  if constexpr (std::derived_from<WallsOf<Scheme>, ImageWalls>) {
    return WallGauge<2>{point, normal, l0}.read(water, pressure);
  } else {
    const auto is_wall = [&](Index i) { return water[kind][i] == Kind::wall; };
    return Probe<2>{.point = point, .spacing = l0}.read(water, pressure, is_wall).value_or(0);
  }
}

// Error of the floor's mean pressure from 0.5 s to 2 s, and its standard deviation, over ρ g h [%].
template <class Scheme>
void still_tank() {
  constexpr double depth = 0.4;
  auto tank = in_tank<Scheme>({.column = {depth, depth},
                               .size = {.length = depth, .height = 0.6},
                               .spacing = l0,
                               .on_escape = OnEscape::remove});
  double seconds = 0, sum = 0, squares = 0;
  while (tank.time() < 2) {
    tank.step();
    if (tank.time() < 0.5) continue;
    const double p = pressure_at_wall<Scheme>(tank.particles(), {depth / 2, 0}, {0, 1}) /
                     (density * g * depth);
    const double dt = tank.last_time_step();
    seconds += dt, sum += dt * p, squares += dt * p * p;
  }
  const double mean = sum / seconds;
  std::printf("%+.2f | %.2f |", 100 * (mean - 1),
              100 * std::sqrt(std::max(0.0, squares / seconds - mean * mean)));
}

// Leading edge of the potential flow, x_front/a over t √(2g/a); the whole curve is in
// tests/reference.
struct Edge {
  double T, Z;
};
constexpr Edge exact_edge[] = {{0.6, 1.241}, {0.8, 1.388}, {1.0, 1.559}, {1.2, 1.749},
                               {1.4, 1.959}, {1.6, 2.186}, {1.8, 2.427}, {2.0, 2.682},
                               {2.2, 2.950}, {2.4, 3.231}, {2.6, 3.522}};

// Rms error of the edge [%]; roughness of P2 from 0.4 s on, relative to its mean over 0.02 s [kPa];
// energy after 1 s and its maximum rise, over the initial energy [%]; particles lost.
template <class Scheme>
void dam_break() {
  constexpr double width = 0.4;
  auto dam = in_tank<Scheme>({.column = {width, 2 * width},
                              .size = {.length = 4 * width, .height = 4 * width},
                              .spacing = l0,
                              .on_escape = OnEscape::remove});
  std::vector<double> t, p, edge;
  double lowest = 1e300, rise = 0;
  while (dam.time() < 1) {
    dam.step();
    const auto& water = dam.particles();
    const auto is_fluid = [&](Index i) { return water[kind][i] == Kind::fluid; };
    t.push_back(dam.time());
    p.push_back(pressure_at_wall<Scheme>(water, {4 * width, 0.02}, {-1, 0}));
    edge.push_back(find_front(water, dam.search(), {.spacing = l0}, is_fluid).x / width);
    const double energy = dam.interaction().energy().total();
    lowest = std::min(lowest, energy);
    rise = std::max(rise, energy - lowest);
  }
  double errors = 0;
  for (const Edge& exact : exact_edge) {
    const double time = exact.T / std::sqrt(2 * g / width);
    const auto after = static_cast<std::size_t>(
        std::lower_bound(t.begin() + 1, t.end() - 1, time) - t.begin());
    const double weight = (time - t[after - 1]) / (t[after] - t[after - 1]);
    const double Z = edge[after - 1] + weight * (edge[after] - edge[after - 1]);
    errors += squared(Z / exact.Z - 1);
  }
  double rough = 0;
  int samples = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    if (t[k] < 0.4) continue;
    double sum = 0;
    int number = 0;
    for (std::size_t i = k; i-- > 0 && t[i] > t[k] - 0.01;) sum += p[i], ++number;
    for (std::size_t i = k; i < t.size() && t[i] < t[k] + 0.01; ++i) sum += p[i], ++number;
    rough += squared(p[k] - sum / number);
    ++samples;
  }
  const FlowEnergy& energy = dam.interaction().energy();
  std::printf(" %.1f | %.2f | %.1f | %.2f | %llu |",
              100 * std::sqrt(errors / double(std::size(exact_edge))),
              std::sqrt(rough / samples) / 1000, 100 * energy.total() / energy.initial,
              100 * rise / energy.initial, static_cast<unsigned long long>(dam.particles_lost()));
}

// Errors of the results of a case with a known solution [%].
template <class Scheme>
std::vector<double> errors_of(const std::string& name) {
  const auto flow = fluid_cases::make({.name = name, .spacing = 0.04});
  auto simulation = fluid_cases::simulation_of<Scheme>(flow, {});
  fluid_cases::Notes notes(flow);
  // An unstable flow takes smaller and smaller steps.
  notes(simulation);
  while (simulation.time() < flow.until) {
    simulation.step();
    if (simulation.steps() > 20000) fail("flow_policies: " + name + " does not end");
    notes.after_step(simulation, Run{});
  }
  std::vector<double> errors;
  for (const auto& finding : flow.findings(notes.history())) {
    errors.push_back(finding.reference != 0 ? 100 * (finding.measured / finding.reference - 1)
                                            : 100 * finding.measured);
  }
  return errors;
}

// Prints "fails" in the columns of a test that throws, and continues the table.
template <class F>
void or_fails(int columns, F&& f) {
  try {
    f();
  } catch (const Error&) {
    for (int k = 0; k < columns; ++k) std::printf(" fails |");
  }
  std::fflush(stdout);
}

template <class Scheme>
void row(const Options& o, const std::string& name) {
  if (!o.only.empty() && std::find(o.only.begin(), o.only.end(), name) == o.only.end()) return;
  std::printf("| %s | ", name.c_str());
  or_fails(2, [] { still_tank<Scheme>(); });
  or_fails(5, [] { dam_break<Scheme>(); });
  or_fails(1, [] { std::printf(" %+.0f |", errors_of<Scheme>("taylor_green")[0]); });
  or_fails(1, [] { std::printf(" %+.1f |", errors_of<Scheme>("rotating_square")[1]); });
  std::printf("\n");
}

// The recommended scheme with one policy replaced.
struct WithSource16 : Recommended {
  DivergenceSource source{};
};
struct WithSourceHS : Recommended {
  HigherOrderSource source{};
};
struct WithSourceECS : Recommended {
  ErrorCompensatingSource source{};
};
struct WithCollision : Recommended {
  Collision collision{.distance = 1.0, .restitution = 0.2};
};
struct WithEqualDistances : Recommended {
  KeepApart collision{};
};
struct WithStabilisation : Recommended {
  DynamicStabilisation collision{};
};
struct WithKernel3c : Recommended {
  CubicKernel kernel{};
};
struct WithSurface13And17 : Recommended {
  OuterSurface<BothConditions> surface{.criterion = {.first = {.beta = 0.97}, .second = {}}};
};
struct WithCones : Recommended {
  OuterSurface<ConeSurface> surface{};
};
// Only with the outer surface may particles come closer to walls than to each other.
struct WithSurfaceAtCentres : Recommended {
  KeepApart collision{};
  BothConditions surface{.first = {.beta = 0.9}, .second = {}};
};
struct WithGradient4 : Recommended {
  MinimumGradient gradient{};
};
struct WithGradient18 : Recommended {
  ConservingGradient gradient{};
};
struct WithGrainyWalls : RecommendedForWallParticles {
  GrainyWalls walls{};
};
struct WithoutFriction : Recommended {
  NoFriction friction{};
};
struct WithoutShifting : Recommended {
  NoShifting shifting{};
};
struct WithHigherOrderLaplacian : Recommended {
  HigherOrderLaplacian laplacian{};
};

void table(const Options& o) {
  std::printf("| scheme | tank: error of the mean [%%] | deviation [%%] | dam break: edge [%%] | "
              "roughness of P2 [kPa] | energy left [%%] | largest rise [%%] | lost | "
              "Taylor–Green: decay rate [%%] | square: angular momentum [%%] |\n"
              "|---|---|---|---|---|---|---|---|---|---|\n");
  row<Recommended>(o, "recommended");
  row<WithSource16>(o, "source (16)");
  row<WithSourceHS>(o, "source HS");
  row<WithSourceECS>(o, "source HS with ECS");
  row<WithCollision>(o, "collision (1.0, 0.2)");
  row<WithEqualDistances>(o, "distance to images 0.9");
  row<WithStabilisation>(o, "dynamic stabilisation");
  row<WithKernel3c>(o, "kernel (3c)");
  row<WithSurface13And17>(o, "surface (13) and (17), β = 0.97");
  row<WithCones>(o, "surface by empty cones");
  row<WithSurfaceAtCentres>(o, "surface at centres, distance to images 0.9");
  row<WithGradient4>(o, "gradient (4)");
  row<WithGradient18>(o, "gradient (18)");
  row<WithoutShifting>(o, "no shifting");
  row<WithoutFriction>(o, "no friction");
  row<WithHigherOrderLaplacian>(o, "higher-order Laplacian");
  row<RecommendedForWallParticles>(o, "recommended for wall particles");
  row<WithGrainyWalls>(o, "the same with grainy walls");
  row<Case10>(o, "case 10, PNU-MPS");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Effect of each choice of the recommended scheme", "flow_policies");
  app.add_option("--only", options.only, "print this row only; may be repeated");
  return support::run(app, argc, argv, [&] { table(options); });
}
