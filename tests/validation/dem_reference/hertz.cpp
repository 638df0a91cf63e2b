// SPDX-License-Identifier: MIT
// Normal impacts of elastic spheres: tests 1 to 3 of Chung and Ooi (2011).
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/io/csv.hpp>

#include "items.hpp"
#include "support/grains.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace silt::test {
namespace {

struct Impact {
  double restitution = 0;
  double force = 0;        // peak [N]
  double max_overlap = 0;  // [m]
  double duration = 0;     // [s]
};

struct Case {
  std::string name;
  bool wall;
  double E, nu, R, density, v, lasts;
};

Impact collide(const Case& c, double e) {
  const dem::Law ball{
      dem::Hertz{.elastic = {.young_modulus = c.E, .poisson_ratio = c.nu}, .restitution = e}};
  const dem::Law rigid{dem::Hertz{.elastic = {.young_modulus = 1e30, .poisson_ratio = 0}}};
  const dem::Grain sphere{.radius = c.R, .density = c.density};
  const double dt = c.lasts / 200;
  const double gap = 1.4 * c.v * dt;
  const Vec<3> v(-c.v, 0, 0);
  const auto grains =
      c.wall ? one_grain<3>({c.R + gap, 0, 0}, v, sphere) : two_grains<3>(gap, v, sphere);
  const dem::Plane<3> plane{.point = {c.wall ? 0 : -1e3, 0, 0}, .normal = {1, 0, 0}, .material = 1};
  Simulation sim{grains, UniformGrid<3>{}, dem::Contacts{dem::Materials{ball, rigid}, plane},
                 Leapfrog{}};
  Impact impact;
  double last_touch = 0;
  while (last_touch == 0 || sim.interaction().size() > 0) {
    sim.step(dt);
    sim.interaction().for_each_contact(
        sim.particles(), [&](Index, Index, const auto& contact, const Vec<3>& force) {
          last_touch = sim.time() - dt;  // contacts belong to the beginning of a step
          impact.force = std::max(impact.force, force.norm());
          impact.max_overlap = std::max(impact.max_overlap, contact.overlap);
        });
  }
  impact.duration = last_touch + dt / 2 - gap / c.v;
  const auto out = sim.particles()[velocity];
  impact.restitution = (c.wall ? out[0][0] : out[1][0] - out[0][0]) / c.v;
  return impact;
}

}  // namespace

void hertz(ReferenceTable& table) {
  const CsvTable exact = read_csv(SILT_TESTS_DIR "/reference/chung_ooi_2011_tests_1_2_3.csv");
  const std::string materials[] = {"glass",           "limestone",       "aluminium alloy",
                                   "magnesium alloy", "aluminium oxide", "cast iron"};
  for (Index row = 0; row < exact.rows(); ++row) {
    const auto of = [&](const char* column) { return exact[column][row]; };
    const int test = int(of("test"));
    Case c{"14 Chung and Ooi's test " + std::to_string(test) + ", " + materials[row],
           of("wall") != 0,
           of("E_Pa"),
           of("nu"),
           of("R_m"),
           of("rho_kg_m3"),
           of("v_rel_m_s"),
           of("t_contact_us") * 1e-6};
    const Impact elastic = collide(c, 1);
    table.add({c.name, "peak force [N]", of("F_max_N"), elastic.force, 0.01});
    table.add(
        {c.name, "maximum overlap [µm]", of("delta_max_um"), elastic.max_overlap * 1e6, 0.01});
    table.add({c.name, "duration [µs]", of("t_contact_us"), elastic.duration * 1e6, 0.01});
    if (test != 3) continue;
    for (const double e : {0.2, 0.4, 0.6, 0.8, 1.0}) {
      table.add({c.name, "e [-] for the given " + to_text(e), e, collide(c, e).restitution, 0.01});
    }
  }
}

}  // namespace silt::test
