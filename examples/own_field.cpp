// SPDX-License-Identifier: MIT
// A user-defined field: a temperature that is conducted between neighbouring particles, of grains
// and of water. The field is defined in one line, and conduction is a plain loop between two steps;
// neither depends on the kind of particles. Run it in any folder, then open warm_grains.pvd and
// warm_water.pvd in ParaView.
#include <silt/io/vtk.hpp>
#include <silt/silt.hpp>

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <vector>

inline constexpr struct temperature_t : silt::scalar_field {
} temperature{};  ///< T [K]

/// dT_i/dt = rate Σ_j (T_j − T_i) over the neighbours j within the search radius; rate [1/s].
/// Exchanges are equal and opposite, so that the sum of T is conserved. Stable if rate Δt times the
/// number of neighbours is below 1.
template <class Simulation>
void conduct(Simulation& simulation, double rate) {
  auto& particles = simulation.particles();
  const double factor = rate * simulation.last_time_step();
  const auto T = particles[temperature];
  std::vector<double> gained(T.size(), 0.0);
  simulation.search().for_each_pair([&](silt::Index i, silt::Index j, const auto&, auto) {
    j = particles.owner(j);  // j may be a ghost, beyond a periodic side
    const double flow = factor * (T[j] - T[i]);
    gained[i] += flow;
    gained[j] -= flow;
  });
  for (silt::Index i = 0; i < T.size(); ++i) T[i] += gained[i];
}

/// Runs for 0.8 s with conduction after every step, and a frame every 20 ms.
template <class Simulation>
void warm(Simulation& simulation, double rate, silt::VtkSeries frames) {
  while (simulation.time() < 0.8) {
    if (simulation.time() >= 0.02 * double(frames.frames())) frames(simulation);
    simulation.step();
    conduct(simulation, rate);
  }
  frames(simulation);
  const auto T = simulation.particles()[temperature];
  const auto [coldest, hottest] = std::minmax_element(T.begin(), T.end());
  std::printf("%zu particles: %.1f to %.1f K, mean %.6f K\n", T.size(), *coldest, *hottest,
              std::accumulate(T.begin(), T.end(), 0.0) / double(T.size()));
}

void warm_grains() {
  using namespace silt;
  constexpr double R = 0.01;  // [m]
  auto grains = dem::make_grains<temperature_t>(lattice<2>({{-0.1, 0}, {0.1, 0.4}}, 2 * R),
                                                {.radius = R, .density = 2500});
  for (Index i = 0; i < grains.size(); ++i) {
    grains[temperature][i] = grains[position][i][0] < 0 ? 400 : 300;
  }
  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.3,
                               .friction_angle = 0.5};
  const Vec<2> down_a_slope{2.5, -9.5};  // [m/s²]
  Simulation heap{grains, UniformGrid<2>{},
                  Forces{Gravity<2>{down_a_slope}, dem::Contacts{law, dem::Plane<2>{}}},
                  Leapfrog{}};
  warm(heap, 50, VtkSeries{"warm_grains"});
}

void warm_water() {
  using namespace silt;
  constexpr double l0 = 0.02;  // particle spacing [m]
  auto tank = mps::make_tank<2, double, temperature_t>(
      {.column = {0.2, 0.4}, .size = {.length = 0.8, .height = 0.6}, .spacing = l0});
  for (Index i = 0; i < tank.size(); ++i) {
    tank[temperature][i] = tank[mps::kind][i] == mps::Kind::fluid ? 350 : 300;
  }
  const mps::Flow<mps::Case10> water{{.spacing = l0, .speed_scale = 2}};
  Simulation dam{tank, UniformGrid<2>{}, water, SemiImplicit<>{}};
  warm(dam, 5, VtkSeries{"warm_water"});
}

int main() {
  warm_grains();
  warm_water();
}
