// SPDX-License-Identifier: MIT
// The front of a dam break, and the one that Martin and Moyce (1952) measured.
#include <silt/io/csv.hpp>
#include <silt/measure/front.hpp>
#include <silt/mps.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

int main() {
  using namespace silt;
  constexpr double a = 0.2, g = 9.81;  // width of the column [m], gravity [m/s²]
  constexpr double l0 = a / 20;        // particle spacing [m]

  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {a, 2 * a}, .size = {.length = 5 * a, .height = 3 * a}, .spacing = l0});
  const mps::Flow<mps::Recommended> water{{.spacing = l0, .speed_scale = 2, .walls = tank.walls}};
  Simulation dam{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};

  // Measure the front in every output, in units without dimension: T = t √(2g/a), Z = x/a.
  std::vector<double> T, Z;
  CsvFile table{"front.csv", {"T", "Z"}};
  dam.run({.until = 0.4, .output_every = 0.005}, [&](const auto& now) {
    if (now.steps() == 0) return;
    const auto is_fluid = [](Index) { return true; };
    const Front front = find_front(now.particles(), now.search(), {.spacing = l0}, is_fluid);
    T.push_back(now.time() * std::sqrt(2 * g / a));
    Z.push_back(front.x / a);
    table.row({T.back(), Z.back()});
  });

  // The experiment does not tell when the water was released: times are those since Z = 1.44.
  const auto time_at = [&](double z) {
    std::size_t k = 1;
    while (k + 1 < Z.size() && Z[k] < z) ++k;
    return T[k - 1] + (T[k] - T[k - 1]) * (z - Z[k - 1]) / (Z[k] - Z[k - 1]);
  };
  constexpr double measured[][2] = {{0.24, 1.67}, {0.64, 2.11}, {1.01, 2.56},
                                    {1.32, 3.00}, {1.64, 3.44}, {1.92, 3.89}};  // their Table 2
  std::printf("front at  time measured  computed\n");
  for (const auto& [time, z] : measured) {
    std::printf("%.2f a %14.2f %9.2f\n", z, time, time_at(z) - time_at(1.44));
  }
}
