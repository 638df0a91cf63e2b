// SPDX-License-Identifier: MIT
// Piles of discs and of clumps of three discs on a plate, poured until they flow over its edges.
// Clumps interlock, so that their pile is steeper. Writes frames of both, discs.pvd and clumps.pvd.
#include <silt/dem.hpp>
#include <silt/dem/clump/clump_blend.hpp>
#include <silt/dem/clump/clump_leapfrog.hpp>
#include <silt/io/vtk_clumps.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

using namespace silt;

constexpr double disc_radius = 0.004, half_width = 0.15, solid_density = 2500;  // [m], [m], [kg/m³]

// Slope of the surface [rad]: of a line through the highest points in each piece of the plate.
template <class Grains>
double slope_of(const Grains& grains) {
  constexpr int pieces = 12;
  std::vector<double> top(pieces, 0.0);
  for (Index i = 0; i < grains.size(); ++i) {
    const Vec<2> x = grains[position][i];
    const auto piece = std::size_t(pieces * std::abs(x[0]) / half_width);
    if (piece < pieces) top[piece] = std::max(top[piece], x[1] + grains[radius][i]);
  }
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int k = 1; k + 1 < pieces; ++k) {
    const double x = (k + 0.5) * half_width / pieces, y = top[std::size_t(k)];
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return -std::atan((n * sxy - sx * sy) / (n * sxx - sx * sx));
}

// Pours clumps of this shape, until the pile flows over, and lets it come to rest.
double pile_of(const dem::ClumpShape<2>& shape, const char* name) {
  const dem::CundallStrack law{.normal_stiffness = 5e5,
                               .tangential_stiffness = 2.5e5,
                               .restitution = 0.3,
                               .friction_angle = std::atan(0.5)};
  // Rough, so that discs do not roll away.
  std::vector<Vec<2>> teeth;
  for (double x = -half_width; x < half_width; x += 2 * disc_radius) {
    teeth.push_back({x, 0});
    teeth.push_back({x + disc_radius, -disc_radius});
  }
  const Box<2> funnel{{-0.02, 0.16}, {0.02, 0.26}};
  const int number = int(2.2 * half_width * half_width * 0.5 / shape.volume());
  dem::Inflow pour(funnel, dem::ClumpBlend<2>({shape}),
                   {.number = Index(number), .velocity = {0, -0.5}, .every = 1e-3});
  dem::Outflow below(Box<2>{{-10, -10}, {10, -0.05}}, {.every = 1e-2});
  Simulation pile{dem::ClumpGrains<2>{}, NeighbourList<2>{},
                  Forces{dem::Contacts{law, dem::Polyline<>{teeth}}, Gravity<2>{{0, -9.81}}},
                  dem::ClumpLeapfrog{dem::Clumps<2>{}, GlobalDamping{.alpha = 0.5}}};
  pile.run({.until = 6, .output_every = 0.1}, pour, below, VtkClumps{name});
  const double slope = slope_of(pile.particles()) * 180 / std::numbers::pi;
  std::printf("%s: %zu of %d on the plate, slope %.1f degrees\n", name,
              pile.integrator().clumps().size(), number, slope);
  return slope;
}

int main() try {
  const double single = std::sqrt(2.2) * disc_radius;  // of about the same area as a clump
  const double discs = pile_of({{{{0, 0}, single}}, solid_density}, "discs");
  const double clumps = pile_of({{{{-disc_radius, 0}, disc_radius},
                                  {{disc_radius, 0}, disc_radius},
                                  {{0, 1.2 * disc_radius}, 0.8 * disc_radius}},
                                 solid_density},
                                "clumps");
  return clumps > discs + 3 ? 0 : 1;
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
