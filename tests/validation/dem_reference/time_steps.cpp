// SPDX-License-Identifier: MIT
// Stability limit of leapfrog, and time steps rejected by Contacts.
#include "bench.hpp"
#include "items.hpp"

#include <cmath>

namespace silt::test {
namespace {

constexpr double k = 1e6;

// The time step at which holds(dt) changes from true to false, by bisection [s].
template <class F>
double turning_point(F&& holds) {
  double low = 1e-7, high = 1;
  while (high / low > 1 + 1e-5) {
    const double dt = std::sqrt(low * high);
    (holds(dt) ? low : high) = dt;
  }
  return low;
}

double refused_from(const dem::Grains<3>& grains, const std::vector<dem::Plane<3>>& walls) {
  return turning_point([&](double dt) {
    Bench<3> bench(grains, {.law = {.normal_stiffness = k}, .walls = walls});
    try {
      bench.step(dt);
      return true;
    } catch (const Error&) {
      return false;
    }
  });
}

// Two spheres compressed between a floor and a lid, so strongly that no contact ends during the
// test: ω² = 3 k/m.
double unstable_from() {
  const double R = pebble.radius;
  dem::Grains<3> grains;
  dem::add_grain(grains, {0, 0, 0.6 * R}, pebble);
  dem::add_grain(grains, {0, 0, 2.2 * R + 1e-9}, pebble);
  return turning_point([&](double dt) {
    Bench<3> bench(grains,
                   {.law = {.normal_stiffness = k},
                    .walls = {dem::Plane<3>{}, {.point = {0, 0, 2.8 * R}, .normal = {0, 0, -1}}},
                    .check_stability = false});
    for (int step = 0; step < 2000; ++step) {
      bench.step(dt);
      if (std::abs(bench.grains()[position][0][2] - 0.6 * R) > 1e-5) return false;
    }
    return true;
  });
}

}  // namespace

void time_steps(ReferenceTable& table) {
  const double unit = std::sqrt(one_grain<3>({0, 0, 0}, {0, 0, 0})[mass][0] / k);
  const auto on_floor = one_grain<3>({0, 0, 0.99 * pebble.radius}, {0, 0, 0});
  const std::string name = "2 stable time step";
  table.add({name, "two spheres between walls are unstable from [√(m/k)]", 2 / std::sqrt(3.0),
             unstable_from() / unit, 0.005});
  // The limit is exact for one contact, apart from the 3 % of the bound.
  table.add({name, "a pair is rejected from [√(m/k)]", std::sqrt(2.0),
             refused_from(two_grains<3>(-1e-5, Vec<3>(0, 0, 0)), {}) / unit, 0.03});
  table.add({name, "a sphere on a floor is rejected from [√(m/k)]", 2,
             refused_from(on_floor, {dem::Plane<3>{}}) / unit, 0.03});
  table.add({name, "2 √(m/k), (34) [√(m/k)]", 2,
             dem::sah_choi_critical_time_step({.mass = unit * unit * k, .stiffness = k}) / unit,
             1e-14});
}

}  // namespace silt::test
