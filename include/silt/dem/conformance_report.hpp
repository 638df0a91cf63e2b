// SPDX-License-Identifier: MIT
// What a contact law is tried on, and what was found.
#pragma once

#include <silt/core/error.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace silt::dem {

/// What a law is tried on: give what it is meant for.
struct ConformanceConditions {
  double radius = 0.01;    ///< R of the grains [m]
  double density = 2500;   ///< ρ [kg/m³]
  double overlap = 1e-4;   ///< δ that contacts of this law reach [m]

  /// Throws if a number is out of range.
  void check() const {
    require_positive("ConformanceConditions: radius", radius);
    require_positive("ConformanceConditions: density", density);
    require_positive("ConformanceConditions: overlap", overlap);
    require_between("ConformanceConditions: overlap over radius", overlap / radius, {0, 0.5});
  }
};

/// One thing that a sound law holds to, as it was measured.
struct ConformanceCheck {
  int dimension = 0;
  std::string name;      ///< as in "action equals reaction"
  double value = 0;      ///< measured [-]
  double allowed = 0;    ///< of the value [-]
  std::string sentence;  ///< what the value is, and what to look at if it is too large

  bool holds() const { return value <= allowed; }
};

struct ConformanceReport {
  std::vector<ConformanceCheck> findings;

  bool holds() const {
    return std::all_of(findings.begin(), findings.end(), [](const auto& f) { return f.holds(); });
  }
  /// Whether the finding of that name holds in every dimension; false if there is none.
  bool holds(std::string_view name) const {
    bool found = false;
    for (const ConformanceCheck& finding : findings) {
      if (finding.name != name) continue;
      if (!finding.holds()) return false;
      found = true;
    }
    return found;
  }
  /// A line for each finding that does not hold.
  std::string text() const {
    std::string text;
    for (const ConformanceCheck& f : findings) {
      if (f.holds()) continue;
      text += std::to_string(f.dimension) + "D, " + f.name + ": " + to_text(f.value) +
              ", but at most " + to_text(f.allowed) + " is sound: " + f.sentence + "\n";
    }
    return text;
  }
};

}  // namespace silt::dem
