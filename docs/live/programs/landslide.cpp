// SPDX-License-Identifier: MIT
// Discs slide down a slope into water and make a wave. Writes landslide.pvd, for ParaView.
#include <silt/coupled.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

// β = ½ μ C Re ε⁻³ [kg/s] per metre of depth. C = (0.93 + 2.4/√Re)² is within 12 % of that of a
// single cylinder (White 1974); cbrt and pow would have other last bits in other C libraries.
struct DiscDrag {
  static constexpr int dimension = 2;
  static double coefficient(const silt::coupled::GrainInFluid& at) {
    const double root = 0.93 * std::sqrt(at.reynolds()) + 2.4;
    const double e = at.fluid_fraction;
    return root * root * at.viscosity / (2 * e * e * e);
  }
};

int main() try {
  using namespace silt;
  constexpr double spacing = 0.025;   // of the particles of water [m]
  constexpr double depth = 0.2;       // of the water [m]
  constexpr double slope = 1;         // rise over run [-]
  constexpr double diameter = 0.016;  // of the discs [m]
  constexpr double density = 2500;    // of the discs [kg/m³]

  const double foot = 0.8, top = slope * foot;  // of the slope
  const std::vector<Vec<2>> basin{{0, top}, {foot, 0}, {2, 0}, {2, top}, {0, top}};
  const auto above_slope = [&](const Vec<2>& x) {
    return (x[1] - slope * (foot - x[0])) / std::sqrt(1 + slope * slope);
  };

  mps::FluidInMixture<2> water;
  for (const auto& x : lattice<2>({{0, 0}, {2, spacing * std::round(depth / spacing)}}, spacing)) {
    if (above_slope(x) < 0.45 * spacing) continue;
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  coupled::GrainsInFluid<2> slide;
  const double highest = std::min(depth + 0.4, top - diameter / 2);
  for (const auto& x : lattice<2>({{0, depth + 0.1}, {foot, highest}}, 1.05 * diameter)) {
    if (above_slope(x) < diameter / 2 || above_slope(x) > 0.1) continue;
    dem::add_grain(slide, x, {.radius = diameter / 2, .density = density});
  }
  const dem::CundallStrack law{.normal_stiffness = 1e6, .tangential_stiffness = 3e5,
                               .restitution = 0.5, .friction_angle = 0.4};
  const mps::Flow<mps::InMixture<>> flow{{.spacing = spacing,
                                          .density = 1000,
                                          .viscosity = 1e-6,
                                          .radius = 4.1,  // in 2D, grains need more neighbours
                                          .laplacian_radius = 4.1,
                                          .speed_scale = std::sqrt(9.81 * depth),
                                          .walls = {.segments = polyline(basin)}}};

  coupled::Coupled both{
      Simulation{slide, NeighbourList<2>{},
                 Forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, dem::Polyline<>{basin}},
                        coupled::FluidForces{DiscDrag{}}},
                 Leapfrog{}},
      Simulation{water, UniformGrid<2>{}, flow, SemiImplicit<>{}}};
  both.run({.until = 2, .output_every = 0.02}, VtkSeries{"landslide"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
