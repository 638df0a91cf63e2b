// SPDX-License-Identifier: MIT
// Conditions and results of the conformance checks of a contact law.
#pragma once

#include <silt/core/error.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace silt::dem {

/// Conditions of the checks; choose those for which the law is intended.
struct ConformanceConditions {
  double radius = 0.01;   ///< R of the grains [m]
  double density = 2500;  ///< ρ [kg/m³]
  double overlap = 1e-4;  ///< typical maximum overlap δ [m]

  /// Throws if a number is out of range.
  void check() const {
    require_positive("ConformanceConditions: radius", radius);
    require_positive("ConformanceConditions: density", density);
    require_positive("ConformanceConditions: overlap", overlap);
    require_between("ConformanceConditions: overlap over radius", overlap / radius, {0, 0.5});
  }
};

/// Result of one check.
struct ConformanceCheck {
  int dimension = 0;
  std::string name;         ///< e.g. "action equals reaction"
  double value = 0;         ///< measured [-]
  double limit = 0;         ///< of the value [-]
  std::string explanation;  ///< meaning of the value, and hints if it is too large

  bool passes() const { return value <= limit; }
};

struct ConformanceReport {
  std::vector<ConformanceCheck> checks;

  bool passes() const {
    return std::all_of(checks.begin(), checks.end(),
                       [](const auto& check) { return check.passes(); });
  }
  /// Whether the check with this name passes in every dimension; false if there is no such check.
  bool passes(std::string_view name) const {
    bool found = false;
    for (const ConformanceCheck& check : checks) {
      if (check.name != name) continue;
      if (!check.passes()) return false;
      found = true;
    }
    return found;
  }
  /// One line for each failed check.
  std::string text() const {
    std::string text;
    for (const ConformanceCheck& check : checks) {
      if (check.passes()) continue;
      text += std::to_string(check.dimension) + "D, " + check.name + ": " + to_text(check.value) +
              ", limit " + to_text(check.limit) + ": " + check.explanation + "\n";
    }
    return text;
  }
};

}  // namespace silt::dem
