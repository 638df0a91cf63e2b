// SPDX-License-Identifier: MIT
// The dam break of [HwangLeePark2010] section 4, in 2D: a column of water 0.4 m wide and 0.8 m high
// at the left of a tank 1.6 m long, and the quantities measured in it.
#pragma once

#include <silt/io/csv.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace silt::test {

inline constexpr double g = 9.81;                // [m/s²]
inline constexpr double column_width = 0.4;      // a [m]
inline constexpr double column_height = 0.8;     // [m]
inline constexpr double tank_length = 1.6;       // [m]

/// Another column than that of the paper.
struct Column {
  double width = column_width;    // [m]
  double height = column_height;  // [m]
  double tank = tank_length;      // [m]
};

/// T = t √(2g/a), the dimensionless time of Martin and Moyce (1952).
inline double scaled_time(double seconds) { return seconds * std::sqrt(2 * g / column_width); }

/// One row per step.
struct DamBreak {
  std::vector<double> time;      // [s]
  std::vector<double> front;     // leading edge over the width of the column, Z [-]
  std::vector<double> height;    // of the column at the left wall, over its initial height, H [-]
  std::vector<double> pressure;  // P2: right wall, 0.02 m above the floor [Pa]
  std::vector<double> energy;    // kinetic and potential, per density [m⁴/s²]
  double first_energy = 0;
  std::uint64_t lost = 0;
  bool broke = false;  // the run ended because a step threw
};

/// Kinetic and potential energy per density [m⁴/s²].
template <class P>
double fluid_energy(const P& particles, double l0) {
  double sum = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] != mps::Kind::fluid) continue;
    sum += particles[velocity][i].squaredNorm() / 2 + g * particles[position][i][1];
  }
  return sum * l0 * l0;
}

/// Pressure on the right wall at y = 0.02 m: the mean of the two wall particles nearest to it, or
/// that of the fluid before a wall of faces.
template <class P>
double pressure_at_p2(const P& particles, double l0) {
  if (mps::count(particles, mps::Kind::wall) == 0) {
    return WallGauge<2>{{tank_length, 0.02}, {-1, 0}, l0}.read(particles, mps::pressure);
  }
  double sum = 0;
  int number = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] != mps::Kind::wall) continue;
    const auto& x = particles[position][i];
    if (x[0] > tank_length && std::abs(x[1] - 0.02) < 0.75 * l0) {
      sum += particles[mps::pressure][i];
      ++number;
    }
  }
  return sum / number;
}

template <class Scheme>
auto dam_break_simulation(double l0, const Column& column = {}) {
  auto tank = mps::make_tank<Scheme, 2>({.column = {column.width, column.height},
                                         .size = {.length = column.tank, .height = 1.6},
                                         .spacing = l0,
                                         .on_escape = OnEscape::remove});
  return Simulation{std::move(tank.particles), UniformGrid<2>{},
                    mps::Flow<Scheme>(
                        {.spacing = l0, .max_time_step = 1e-3, .walls = tank.walls}),
                    SemiImplicit{}};
}

/// Runs until a time [s], or until a step throws, which may happen with the original method.
template <class Scheme>
DamBreak run_dam_break(double l0, double until, const Column& column = {}) {
  auto sim = dam_break_simulation<Scheme>(l0, column);
  DamBreak record;
  record.first_energy = fluid_energy(sim.particles(), l0);
  while (sim.time() < until) {
    try {
      sim.step();
    } catch (const Error&) {
      record.broke = true;
      break;
    }
    record.time.push_back(sim.time());
    const auto kinds = sim.particles()[mps::kind];
    const Front front = find_front(sim.particles(), sim.search(), {.spacing = l0},
                                   [&](Index i) { return kinds[i] == mps::Kind::fluid; });
    record.front.push_back(front.x / column.width);
    record.height.push_back(front.height / column.height);
    record.pressure.push_back(pressure_at_p2(sim.particles(), l0));
    record.energy.push_back(fluid_energy(sim.particles(), l0));
  }
  record.lost = sim.particles_lost();
  return record;
}

/// Value at a time between the rows, by linear interpolation.
inline double at_time(const std::vector<double>& time, const std::vector<double>& value, double t) {
  const auto after = std::lower_bound(time.begin(), time.end(), t);
  if (after == time.begin() || after == time.end()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto k = static_cast<Index>(after - time.begin());
  const double fraction = (t - time[k - 1]) / (time[k] - time[k - 1]);
  return value[k - 1] + fraction * (value[k] - value[k - 1]);
}

/// Relative rms deviation of the front from the table of Martin and Moyce, for T from 1.19 to 3.3.
/// The instant of release was not measured, so times are shifted such that Z = 1.44 at T = 1.19.
inline double front_deviation(const DamBreak& record) {
  const double T0 = 1.19;
  const double Z0 = 1.44;
  Index k = 0;
  while (k < record.front.size() && record.front[k] < Z0) ++k;
  if (k == 0 || k == record.front.size()) return std::numeric_limits<double>::quiet_NaN();
  const double fraction = (Z0 - record.front[k - 1]) / (record.front[k] - record.front[k - 1]);
  const double t0 = record.time[k - 1] + fraction * (record.time[k] - record.time[k - 1]);
  double sum = 0;
  int number = 0;
  const CsvTable measured =
      read_csv(SILT_TESTS_DIR "/reference/martin_moyce_1952_n2eq2_front_table2.csv");
  for (Index row = 0; row < measured.rows(); ++row) {
    const double T = measured["T"][row];
    if (T < T0 || T > 3.3) continue;
    const double t = t0 + (T - T0) / scaled_time(1);
    sum += std::pow(at_time(record.time, record.front, t) / measured["Z"][row] - 1, 2);
    ++number;
  }
  return std::sqrt(sum / number);
}

/// Relative rms deviations of edge and height from the exact potential flow for T = t √(g h)/a from
/// 0.5 to 2.75, or to the end of its table.
struct Deviations {
  double edge = 0;
  double height = 0;
};
inline Deviations from_potential_flow(const DamBreak& record, const std::string& table = "",
                               const Column& column = {}) {
  const CsvTable exact =
      read_csv(SILT_TESTS_DIR "/reference/potential_flow_front" + table + ".csv");
  Deviations sums;
  int rows = 0;
  for (Index row = 0; row < exact.rows(); ++row) {
    const double T = exact["T"][row];
    if (T < 0.5 || T > 2.75) continue;
    const double t = T * column.width / std::sqrt(g * column.height);
    sums.edge += squared(at_time(record.time, record.front, t) / exact["Z"][row] - 1);
    sums.height += squared(at_time(record.time, record.height, t) / exact["H"][row] - 1);
    ++rows;
  }
  return {std::sqrt(sums.edge / rows), std::sqrt(sums.height / rows)};
}

/// Rms of P2 minus its moving average over 0.02 s, between two times [Pa].
inline double roughness(const DamBreak& record, double from, double to) {
  double sum = 0;
  double weight = 0;
  const double half = 0.01;
  for (Index k = 1; k < record.time.size(); ++k) {
    if (record.time[k] < from || record.time[k] > to) continue;
    double mean = 0;
    double span = 0;
    for (Index m = 1; m < record.time.size(); ++m) {
      if (std::abs(record.time[m] - record.time[k]) > half) continue;
      const double dt = record.time[m] - record.time[m - 1];
      mean += dt * record.pressure[m];
      span += dt;
    }
    const double dt = record.time[k] - record.time[k - 1];
    sum += dt * std::pow(record.pressure[k] - mean / span, 2);
    weight += dt;
  }
  return std::sqrt(sum / weight);
}

/// Maximum rise of the energy above an earlier value, over the initial energy.
inline double energy_growth(const DamBreak& record) {
  double lowest = record.first_energy;
  double growth = 0;
  for (const double energy : record.energy) {
    growth = std::max(growth, energy - lowest);
    lowest = std::min(lowest, energy);
  }
  return growth / record.first_energy;
}

}  // namespace silt::test
