// SPDX-License-Identifier: MIT
// A grain that falls and bounces, and two grains compressed between a floor and a lid.
#include <silt/io/csv.hpp>

#include "bench.hpp"
#include "items.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace silt::test {
namespace {

constexpr double g = 9.81;

// Garg et al. (2012): a sphere of R = 0.1 m, ρ = 2600 kg/m³ falls from 0.5 m.
void falling_sphere(ReferenceTable& table) {
  const double R = 0.1;
  const double e = 0.8;
  const dem::Grain sphere{.radius = R, .density = 2600};
  const auto start = one_grain<3>({0, 0, 0.5}, {0, 0, 0}, sphere);
  const double k = 5e7;
  const double m = start[mass][0];
  Bench<3> bench(start, {.law = {.normal_stiffness = k, .restitution = e},
                         .gravity = {0, 0, -g},
                         .walls = {dem::Plane<3>{}}});
  const double dt = bench.time_step();
  const double v1 = std::sqrt(2 * g * (0.5 - R));
  struct Apex {
    double height;
    double time;
  };
  std::vector<Apex> apexes;
  double contact_begin = 0, speed = 0, lowest_z = 1, v_before = 0, z_before = 0.5;
  while (apexes.size() < 3) {
    bench.step(dt);
    const double v = bench.grains()[velocity][0][2];
    const double z = bench.grains()[position][0][2];
    if (contact_begin == 0 && z < R) {
      contact_begin = bench.time() - dt * (R - z) / (z_before - z);
      // v_before is the velocity one and a half steps ago.
      speed = -v_before + g * (contact_begin - bench.time() + 1.5 * dt);
    }
    if (apexes.empty()) lowest_z = std::min(lowest_z, z);
    if (v_before > 0 && v <= 0) apexes.push_back({std::max(z, z_before), bench.time() - dt});
    v_before = v;
    z_before = z;
  }
  const std::string name = "3 sphere dropped by 0.4 m, e = 0.8";
  table.add({name, "contact begins at [s]", std::sqrt(2 * 0.4 / g), contact_begin, 1e-4});
  table.add({name, "speed at contact [m/s]", v1, speed, 1e-4});
  // y − R = exp(−ζ ω0 s) (C1 cos ωd s + C2 sin ωd s) − g/ω0², y(0) = R, y'(0) = −v1.
  const double w0 = std::sqrt(k / m);
  const double zeta = dem::Restitution(e).damping_ratio;
  const double wd = w0 * std::sqrt(1 - zeta * zeta);
  const double C1 = g / (w0 * w0);
  const double C2 = (-v1 + zeta * w0 * C1) / wd;
  double lowest = 0;
  for (int i = 0; i <= 100000; ++i) {
    const double s = i * 4 / w0 / 100000;
    lowest = std::min(
        lowest, std::exp(-zeta * w0 * s) * (C1 * std::cos(wd * s) + C2 * std::sin(wd * s)) - C1);
  }
  table.add({name, "maximum overlap [m]", -lowest, R - lowest_z, 0.01});
  double time = v1 / g;
  for (int n = 1; n <= 3; ++n) {
    const double rise = std::pow(e, n) * v1 / g;
    time += rise;
    // For a hard sphere: its contacts have no duration; here each lasts 1.5 ms.
    table.add({name, "apex " + std::to_string(n) + " above the floor's touch [m]",
               0.4 * std::pow(e, 2.0 * n), apexes[std::size_t(n) - 1].height - R, 0.01});
    table.add({name, "apex " + std::to_string(n) + " at [s]", time, apexes[std::size_t(n) - 1].time,
               0.01});
    time += rise;
  }
}

void stacked(ReferenceTable& table) {
  const CsvTable exact = read_csv(SILT_TESTS_DIR "/reference/stacked_particles_compressed.csv");
  const double d = 1e-3;
  for (const double e : {1.0, 0.9, 0.7, 0.5}) {
    dem::Grains<3> grains;
    dem::add_grain(grains, {0, 0, 0.45 * d}, {.radius = d / 2, .density = 20000});
    dem::add_grain(grains, {0, 0, 1.35 * d}, {.radius = d / 2, .density = 10000});
    Bench<3> bench(grains,
                   {.law = {.normal_stiffness = 1000, .restitution = e},
                    .gravity = {0, 0, -g},
                    .walls = {dem::Plane<3>{}, {.point = {0, 0, 1.8 * d}, .normal = {0, 0, -1}}}});
    double farthest[2] = {0, 0};
    for (Index row = 0; row < exact.rows(); ++row) {
      if (exact["e"][row] != e) continue;
      bench.run(exact["t_s"][row], 2e-7);
      const double y[2] = {exact["y1_mm"][row], exact["y2_mm"][row]};
      for (Index i = 0; i < 2; ++i) {
        const double off = bench.grains()[position][i][2] / d - y[i];
        if (std::abs(off) > std::abs(farthest[i])) farthest[i] = off;
      }
    }
    for (const int i : {0, 1}) {
      table.add({"4 two spheres pressed between walls, e = " + to_text(e),
                 "maximum deviation of y" + std::to_string(i + 1) + " from the exact motion [d]", 0,
                 farthest[i], 3e-4, 1});
    }
  }
}

}  // namespace

void bounces(ReferenceTable& table) {
  falling_sphere(table);
  stacked(table);
}

}  // namespace silt::test
