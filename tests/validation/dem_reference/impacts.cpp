// SPDX-License-Identifier: MIT
// Head-on impacts on a linear spring and dashpot, and Newton's cradle.
#include "bench.hpp"
#include "items.hpp"

#include <silt/io/csv.hpp>

#include <cmath>
#include <numbers>

namespace silt::test {
namespace {

constexpr double k = 1e6;
constexpr double v0 = 0.1;

struct Impact {
  double restitution;
  double deepest;   // overlap over v0/ω0 [-]
  double duration;  // over 1/ω0 [-]
};

// Two grains, or one on a wall; the contact begins at `phase` of a step.
template <int Dim>
struct HeadOn {
  bool wall;
  double steps;  // per contact
  double phase;

  double frequency() const {
    const Vec<Dim> zero = Vec<Dim>::Zero();
    return std::sqrt(k / one_grain<Dim>(zero, zero)[mass][0] * (wall ? 1 : 2));
  }
  Impact operator()(const dem::CundallStrack& law) const {
    const double omega = frequency();
    const double dt = std::numbers::pi / omega / steps;
    const double gap = v0 * dt * (1 + phase);
    const Vec<Dim> n = Vec<Dim>::Unit(0);
    const auto grains = wall ? one_grain<Dim>((pebble.radius + gap) * n, -v0 * n)
                             : two_grains<Dim>(gap, -v0 * n);
    BenchSetup<Dim> setup{.law = law};
    if (wall) setup.walls = {{.normal = n}};
    Bench<Dim> bench(grains, setup);
    const double deepest = bench.through_contact(dt);
    const auto v = bench.grains()[velocity];
    const double leaving = wall ? v[0][0] : v[1][0] - v[0][0];
    // It began within the step `phase` of the way, and ended within the one before the last.
    const double duration = bench.time() - (1.5 + 1 + phase) * dt;
    return {leaving / v0, deepest * omega / v0, duration * omega};
  }
};

// The value farthest from `reference` among all that are shown to it.
struct Farthest {
  double reference;
  double value = reference;
  void see(double other) {
    if (!(std::abs(other - reference) <= std::abs(value - reference))) value = other;
  }
};

template <int Dim>
void try_all(const dem::CundallStrack& by_e, double zeta, Farthest& restitution,
             Farthest& deepest) {
  for (const bool wall : {false, true}) {
    for (const double phase : {0.05, 0.3, 0.55, 0.8, 0.95}) {
      const HeadOn<Dim> impact{wall, 50, phase};
      auto by_beta = by_e;  // the same dashpot: ζ = (β/2) ω0
      by_beta.restitution = 1;
      by_beta.beta = 2 * zeta / impact.frequency();
      for (const auto& law : {by_e, by_beta}) {
        const Impact measured = impact(law);
        restitution.see(measured.restitution);
        deepest.see(measured.deepest);
      }
    }
  }
}

}  // namespace

void impacts(ReferenceTable& table) {
  const CsvTable exact = read_csv(SILT_TESTS_DIR "/reference/linear_spring_dashpot_exact.csv");
  for (Index row = 0; row < exact.rows(); ++row) {
    const double e = exact["e_nominal"][row];
    const std::string name = "1 linear spring and dashpot, e = " + to_text(e);
    for (const bool limited : {false, true}) {
      const dem::CundallStrack law{.normal_stiffness = k, .restitution = e, .limit_damping = limited};
      Farthest restitution{limited ? exact["e_if_clipped"][row] : e};
      Farthest deepest{exact["delta_max_omega0_over_v0"][row]};
      try_all<2>(law, exact["zeta"][row], restitution, deepest);
      try_all<3>(law, exact["zeta"][row], restitution, deepest);
      const std::string kind = limited ? ", dashpot without pull" : "";
      table.add({name + kind, "e [-], worst of 40 impacts", restitution.reference,
                 restitution.value, 0.005});
      table.add({name + kind, "δ_max ω0/v0 [-], worst of 40 impacts", deepest.reference,
                 deepest.value, 0.01});
    }
    const double lasts =
        HeadOn<2>{false, 500, 0.5}({.normal_stiffness = k, .restitution = e}).duration;
    // To half a step of a five-hundredth.
    table.add({name, "t_c ω0 [-]", exact["tc_omega0"][row], lasts, 0.002});
  }

  Bench<3> exchange(two_grains<3>(1e-4, Vec<3>(-2, 0, 0)), {.law = {.normal_stiffness = k}});
  exchange.through_contact(exchange.time_step());
  table.add({"9 elastic head-on impact of equal spheres", "velocity passed on [m/s]", -2,
             exchange.grains()[velocity][0][0], 5e-4});
  for (const int n : {3, 5}) {
    dem::Grains<2> grains;
    const double d = 2 * pebble.radius;
    for (int i = 0; i < n; ++i) dem::add_grain(grains, {i * d * 1.001, 0}, pebble);
    grains[velocity][0] = {0.1, 0};
    Bench<2> cradle(grains, {.law = {.normal_stiffness = 1e8}});
    const Index last = Index(n) - 1;
    const double dt = cradle.time_step();
    while (cradle.grains()[velocity][last][0] < 0.09) cradle.step(dt);
    cradle.run(cradle.time() + 1e-3, dt);
    table.add({"9 Newton's cradle of " + std::to_string(n), "speed of the last disc [m/s]", 0.1,
               cradle.grains()[velocity][last][0], 1e-3});
  }
}

}  // namespace silt::test
