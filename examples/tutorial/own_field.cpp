// SPDX-License-Identifier: MIT
// A drum mixes grains of two colours.
#include <silt/dem.hpp>
#include <silt/io/vtk.hpp>

#include <cstdio>
#include <numbers>

inline constexpr struct colour_t : silt::scalar_field, silt::constant_field {
} colour{};  ///< 0 or 1 [-]

int main() {
  using namespace silt;
  constexpr double R = 0.004;  // radius of a grain [m]

  // A drum half full: colour 0 at its left, colour 1 at its right.
  dem::Grains<2, double, colour_t> grains;
  for (const auto& x : lattice<2>({{-0.1, -0.1}, {0.1, 0}}, 2 * R)) {
    if (x.norm() > 0.1 - R) continue;
    const Index i = dem::add_grain(grains, x, {.radius = R, .density = 2500});
    grains[colour][i] = x[0] < 0 ? 0 : 1;
  }

  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.5};
  const dem::Moving drum{dem::Circle<>{.radius = 0.1},
                         dem::Rotation<2>{.about = {0, 0}, .spin = std::numbers::pi}};
  Simulation mixer{grains, NeighbourList<2>{},
                   Forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, drum}}, Leapfrog{}};

  // The fewer pairs of neighbours have the same colour, the better they are mixed: at best half.
  mixer.run({.until = 3, .output_every = 1}, VtkSeries{"drum"}, [&](const auto& now) {
    double pairs = 0, mixed = 0;
    const auto& all = now.particles();
    for (Index i = 0; i < all.size(); ++i) {
      for (Index j = 0; j < i; ++j) {
        if ((all[position][i] - all[position][j]).norm() > 2.2 * R) continue;
        ++pairs;
        if (all[colour][i] != all[colour][j]) ++mixed;
      }
    }
    std::printf("%.0f s: %2.0f %% of the pairs have two colours\n", now.time(),
                100 * mixed / pairs);
  });
}
