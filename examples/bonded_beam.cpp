// SPDX-License-Identifier: MIT
// A cantilever beam of bonded grains with a load at its free end. The deflection is compared with
// Timoshenko's theory. Then the load is increased until a bond breaks, which should be the one at
// the root, at the load given by the strength. The bent beam is written to beam.pvd in the current
// folder.
#include <silt/dem.hpp>
#include <silt/io/vtk.hpp>

#include <cmath>
#include <cstdio>

struct Weight {  // acts on one grain
  silt::Id grain = 0;
  double load = 0;  ///< [N]

  template <class P>
  double reach(const P&) const { return 0; }
  template <class P, class S>
  void accelerate(P& grains, const S&, double) const { silt::accelerate_each(*this, grains); }
  template <class P>
  void add_forces(P& grains, silt::Index i) const {
    if (grains.id(i) == grain) grains[silt::force][i][1] -= load;
  }
};

constexpr double R = 0.01;                    // radius of a grain [m]
constexpr silt::Index sections = 10;          // bonds along the beam
constexpr double length = sections * 2 * R;   // [m]
const silt::dem::ParallelBond cement{.normal_stiffness = 1e9,
                                     .tangential_stiffness = 4e8,
                                     .tensile_strength = 1e5};

// The beam under a load, at rest or broken.
auto beam_under(double load) {
  using namespace silt;
  dem::Grains<2> grains;
  for (Index i = 0; i <= sections; ++i) {
    dem::add_grain(grains, {2 * R * double(i), 0}, {.radius = R, .density = 2500});
  }
  grains[mass][0] *= 1e12;  // so heavy that it is fixed
  grains[inertia][0] *= 1e12;
  dem::Bonds<2> bonds{cement};
  bonds.bond_all_touching(grains, UniformGrid<2>{});
  Simulation beam{grains, UniformGrid<2>{}, Forces{bonds, Weight{sections, load}},
                  Leapfrog{GlobalDamping{.alpha = 100}}};
  // All modes of the beam are slower than the single bond that determines time_step().
  const double dt = 5 * beam.time_step();
  while (beam.time() < 0.3 && beam.interaction().part<0>().bonds().size() == sections) {
    beam.step(dt);
  }
  return beam;
}

int main() try {
  using namespace silt;
  const auto section = dem::section_of<2>(cement, R);
  const double E = cement.normal_stiffness * 2 * R, G = cement.tangential_stiffness * 2 * R;
  const double load = 10;
  const auto beam = beam_under(load);
  const double beam_theory = load * length * length * length / (3 * E * section.bending) +
                             load * length / (G * section.area);
  VtkSeries{"beam"}(beam);
  const auto& grains = beam.particles();
  std::printf("under %g N the tip deflects by %.3f mm; a Timoshenko beam by %.3f mm\n", load,
              -1e3 * grains[position][grains.index_of(sections)][1], 1e3 * beam_theory);

  // M R̄/I at the first section, half a grain's diameter from the wall.
  const double strength =
      cement.tensile_strength * section.bending / section.radius / (length - R);
  double breaking_load = 0;
  for (double trial = 0.9 * strength; breaking_load == 0; trial += 0.02 * strength) {
    const auto loaded = beam_under(trial);
    const auto& bonds = loaded.interaction().part<0>();
    if (bonds.bonds().size() == sections) continue;
    breaking_load = trial;
    std::printf("under %.0f N it breaks %s; the strength of its first section is %.0f N\n", trial,
                bonds.is_bonded({0, 1}) ? "away from the root" : "at the root", strength);
  }
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
