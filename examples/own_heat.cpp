// SPDX-License-Identifier: MIT
// A user-defined law of heat conduction through the contacts of grains, and the field that it
// changes. A column of steel balls is squeezed between two plates at 400 K and 300 K; the heat that
// flows through it when it is steady is compared with that of resistances in series.
#include <silt/dem.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

inline constexpr struct temperature_t : silt::scalar_field {
} temperature{};  ///< T [K]

/// Through a contact of the radius a flows 2 k a (T_j − T_i) (Batchelor and O'Brien 1977, in
/// vacuum). Walls have temperatures of their own, and half of their resistance.
struct Conduction {
  double conductivity = 0;      ///< k [W/(m K)]
  double heat_capacity = 0;     ///< c [J/(kg K)]
  std::vector<double> walls{};  ///< temperatures by the number of the wall [K]
  double into_last = 0;         ///< heat that the last wall has received in the last step [J]

  /// Conducts for the last time step.
  template <class Simulation, class Contacts>
  void operator()(Simulation& simulation, const Contacts& contacts) {
    auto& grains = simulation.particles();
    const auto T = grains[temperature];
    std::vector<double> heat(T.size(), 0.0);
    const auto flow = [&](double contact_radius, double difference) {
      return 2 * conductivity * contact_radius * difference * simulation.last_time_step();
    };
    contacts.for_each_contact(
        grains, [&](silt::Index i, silt::Index j, const auto& c, const auto&) {
          if (j == silt::no_index) return;
          const double Q =
              flow(std::sqrt(c.effective_radius * std::max(0.0, c.overlap)), T[j] - T[i]);
          heat[i] += Q;
          heat[j] -= Q;
        });
    contacts.for_each_wall_contact(grains, [&](const auto& touch) {
      const double R = grains[silt::radius][touch.grain];
      const double overlap = R - (grains[silt::position][touch.grain] - touch.point).norm();
      const double Q = flow(std::sqrt(R * overlap), walls[touch.wall] - T[touch.grain]);
      heat[touch.grain] += Q;
      if (touch.wall + 1 == walls.size()) into_last = -Q;
    });
    for (silt::Index i = 0; i < T.size(); ++i) {
      T[i] += heat[i] / (grains[silt::mass][i] * heat_capacity);
    }
  }
};

int main() {
  using namespace silt;
  constexpr double R = 1e-3, overlap = 1e-5;  // [m]
  constexpr int balls = 6;
  const dem::Elastic steel{.young_modulus = 2e8, .poisson_ratio = 0.3};  // softened
  const dem::Law law{dem::Hertz{.elastic = steel, .restitution = 0.5}};
  dem::Grains<3, double, temperature_t> column;
  for (int k = 0; k < balls; ++k) {
    dem::add_grain(column, {0, 0, R - overlap + k * (2 * R - overlap)},
                   {.radius = R, .density = 7800});
    column[temperature][Index(k)] = 300;
  }
  const double height = 2 * R * balls - overlap * (balls + 1);
  const dem::Plane<3> hot{}, cold{.point = {0, 0, height}, .normal = {0, 0, -1}};
  Simulation simulation{column, UniformGrid<3>{}, dem::Contacts{law, hot, cold},
                        Leapfrog{GlobalDamping{.alpha = 1e4}}};
  // A heat capacity so low that the temperatures are soon steady.
  Conduction conduct{.conductivity = 50, .heat_capacity = 0.02, .walls = {400, 300}};
  while (simulation.time() < 0.02) {
    simulation.step();
    conduct(simulation, simulation.interaction());
  }
  const double measured = conduct.into_last / simulation.last_time_step();
  // The force is the same everywhere: F = 4/3 E* √R* δ^{3/2} with R* = R/2 or, at a plate, R.
  double resistance = 0, shortened = 0;
  const auto contacts = [&](double effective_radius, int number) {
    const double delta = std::cbrt(1 / effective_radius);  // times F^{2/3} (4/3 E*)^{−2/3}
    shortened += number * delta;
    return delta;
  };
  const double between = contacts(R / 2, balls - 1), at_plates = contacts(R, 2);
  const double scale = overlap * (balls + 1) / shortened;
  resistance += (balls - 1) / (100 * std::sqrt(R / 2 * scale * between));
  resistance += 2 / (100 * std::sqrt(R * scale * at_plates));
  const double expected = 100 / resistance;
  std::printf("heat flow %.5f W, of resistances in series %.5f W\n", measured, expected);
  for (const double T : simulation.particles()[temperature]) std::printf("%.2f K\n", T);
  return std::abs(measured / expected - 1) < 1e-3 ? 0 : 1;
}
