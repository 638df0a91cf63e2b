// SPDX-License-Identifier: MIT
// The curves published for oblique impacts, tests 4 to 6 and 8 of Chung and Ooi (2011), the exact
// results for contacts that slide throughout, and measurements.
#pragma once

#include <silt/io/csv.hpp>

#include "support/oblique_impacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace silt::test {

/// `number` is that of the test, `material` the column `case` of the file.
inline ObliqueBodies bodies_of_test(int number, int material) {
  const ObliqueBody plane{.elastic = {.young_modulus = 1e30, .poisson_ratio = 0}};
  const dem::Elastic alloy{.young_modulus = 70e9, .poisson_ratio = 0.33};
  const bool is_first = material == 0;
  if (number == 4) {
    if (is_first) return {"aluminium alloy", {2.5e-3, 2700, alloy}, plane, 0.98, 0.092};
    return {"aluminium oxide", {2.5e-3, 4000, {380e9, 0.23}}, plane, 0.98, 0.092};
  }
  if (number == 5) {
    const Inferred shearing{.shearing_plane = true};
    if (is_first) return {"steel", {1e-5, 7850, {208e9, 0.3}}, plane, 1, 0.3, shearing};
    return {"polyethylene", {1e-5, 1400, {1e9, 0.4}}, plane, 1, 0.3, shearing};
  }
  // Then k_t/k_n is a tenth higher.
  const double nu = 0.2;
  if (number == 6) {
    if (!is_first) return {"nylon", {0.1, 1000, {2.5e9, 0.4}}, plane, 0.5, 0.4};
    return {"aluminium alloy",
            {0.1, 2700, alloy},
            plane,
            0.5,
            0.4,
            {.limited_sum = true, .poisson_ratio = nu}};
  }
  const dem::Elastic stiff{.young_modulus = 1000 * alloy.young_modulus, .poisson_ratio = 0.33};
  return {is_first ? "A, large sphere stiffer" : "B, equally stiff spheres",
          {0.1, 2700, alloy},
          {0.5, 2.7e6, is_first ? stiff : alloy},
          0.5,
          0.4,
          {.limited_sum = is_first, .poisson_ratio = nu}};
}

/// Largest deviations along a curve, see ObliqueCurve::relative().
struct ImpactDeviations {
  double sliding = 0;   ///< from the exact results
  double sticking = 0;  ///< from the published curve, where there is no exact result
};

/// A published curve.
struct ObliqueCurve {
  struct Point {
    double x;
    double published;
  };

  int number;    ///< of the test
  int material;  ///< column `case` of the file
  int quantity;  ///< as in the file
  std::vector<Point> points = {};

  ObliqueBodies bodies() const { return bodies_of_test(number, material); }
  std::string name() const {
    const char* const quantities[] = {"β_t", "ω", "ψ_2", "R ω/(µ v_n)", "β"};
    return "test " + std::to_string(number) + ", " + bodies().name + ", " + quantities[quantity];
  }

  /// A deviation from a value, relative to it, or to a tenth of the largest published value if the
  /// value is smaller: most curves cross zero.
  double relative(double deviation, double value) const {
    double most = 0;
    for (const Point& point : points) most = std::max(most, std::abs(point.published));
    return deviation / std::max(std::abs(value), most / 10);
  }

  /// The exact result, if the contact slides throughout at x.
  std::optional<double> sliding(double x) const {
    const ObliqueBodies both = bodies();
    const double impulse = both.friction * (1 + both.restitution);  // over m v_n
    const double angle = x * std::numbers::pi / 180;
    if (quantity <= 1) {
      if (std::tan(angle) < 3.5 * impulse) return {};
      return quantity == 0 ? 1 - impulse / std::tan(angle)
                           : -2.5 * impulse * speed_of_test_4 * std::cos(angle) / both.sphere.R;
    }
    if (quantity == 4) return x < 1 ? std::optional(x - 1) : std::nullopt;
    if (x < 7) return {};
    return quantity == 2 ? x - 7 : -5;
  }

  /// Measured at x.
  double measured(double x, ImpactForm form) const {
    const ObliqueBodies both = bodies();
    const double R = both.sphere.R;
    if (quantity <= 1) {
      const double angle = x * std::numbers::pi / 180;
      const double v = speed_of_test_4 * std::sin(angle);
      const auto after =
          bounce(both, {.v = v, .v_n = speed_of_test_4 * std::cos(angle), .spin = 0}, form);
      return quantity == 0 ? after.v / v : -after.spin;
    }
    if (quantity == 4) {
      const double v_n = 0.2;
      const double surface = 3.5 * both.friction * (1 + both.restitution) * v_n / x;
      const auto after = bounce(both, {.v = 0, .v_n = v_n, .spin = -surface / R}, form);
      return -(after.v - R * after.spin) / surface;
    }
    const double v_n = 5;
    const auto after = bounce(both, {.v = x * both.friction * v_n, .v_n = v_n, .spin = 0}, form);
    return quantity == 2 ? (after.v - R * after.spin) / (both.friction * after.v_n)
                         : -R * after.spin / (both.friction * v_n);
  }

  ImpactDeviations deviations(ImpactForm form) const {
    ImpactDeviations most;
    for (const Point& point : points) {
      const auto exact = sliding(point.x);
      const double reference = exact.value_or(point.published);
      double& largest = exact ? most.sliding : most.sticking;
      largest =
          std::max(largest, std::abs(relative(measured(point.x, form) - reference, reference)));
    }
    return most;
  }

 private:
  static constexpr double speed_of_test_4 = 3.9;  // [m/s]
};

inline std::vector<ObliqueCurve> oblique_curves() {
  const CsvTable table = read_csv(SILT_TESTS_DIR "/reference/chung_ooi_2011_tests_4_to_8.csv");
  std::vector<ObliqueCurve> curves;
  for (Index row = 0; row < table.rows(); ++row) {
    const auto of = [&](const char* column) { return int(table[column][row]); };
    const ObliqueCurve next{of("test"), of("case"), of("quantity")};
    if (curves.empty() || curves.back().number != next.number ||
        curves.back().material != next.material || curves.back().quantity != next.quantity) {
      curves.push_back(next);
    }
    curves.back().points.push_back({table["x"][row], table["published"][row]});
  }
  return curves;
}

}  // namespace silt::test
