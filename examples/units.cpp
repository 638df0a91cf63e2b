// SPDX-License-Identifier: MIT
// A simulation whose input has units, which the compiler checks: quantities of Boost.Units. A stack
// of discs settles on a floor.
#include "support/units.hpp"

#include <silt/dem.hpp>

#include <algorithm>
#include <cstdio>

int main() try {
  using namespace silt;
  namespace si = units::si;
  const auto millimetre = si::milli * si::metre;
  const auto degree = boost::units::degree::degree;

  const units::Grain disc{.radius = units::Length(20.0 * millimetre),
                          .density = 2500.0 * si::kilogrammes_per_cubic_metre};
  const units::CundallStrack law{.normal_stiffness = 1e6 * si::newtons / si::metre,
                                 .tangential_stiffness = 5e5 * si::newtons / si::metre,
                                 .restitution = 0.5,
                                 .friction_angle = units::Angle(25.0 * degree)};
  const units::Acceleration g = 9.81 * si::metres_per_second_squared;
  const units::Run run{.until = 0.5 * si::second, .output_every = 0.1 * si::second};

  const double R = units::number(disc.radius);
  const auto discs = dem::make_grains(lattice<2>({{0, 0}, {0.2, 0.4}}, 2 * R), disc);
  Simulation stack{discs, NeighbourList<2>{},
                   Forces{Gravity<2>{{0, -units::number(g)}},
                          dem::Contacts{dem::CundallStrack(law), dem::Plane<2>{}}},
                   Leapfrog{}};
  stack.run(run, [](const auto& simulation) {
    const auto grains = simulation.snapshot();
    double highest = 0;
    for (const auto& x : grains[position]) highest = std::max(highest, x[1]);
    std::printf("%.1f s: the highest disc is at %.3f m\n", simulation.time(), highest);
  });
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
