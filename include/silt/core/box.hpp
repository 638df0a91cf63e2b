// SPDX-License-Identifier: MIT
// The box particles live in: which sides are periodic, and what happens to a particle that leaves
// through one that is not.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace silt {

/// What the simulation does with a particle found outside a box at the end of a step.
enum class OnEscape {
  refuse,  ///< the step throws, and is undone
  remove,  ///< the particle is removed and counted: `Simulation::particles_lost()`
};

/// Axis-parallel box. Without numbers it is all of space.
template <int Dim, class Real = double>
struct Box {
  Vec<Dim, Real> lower = Vec<Dim, Real>::Constant(-std::numeric_limits<Real>::infinity());  ///< [m]
  Vec<Dim, Real> upper = Vec<Dim, Real>::Constant(std::numeric_limits<Real>::infinity());   ///< [m]
  std::array<bool, Dim> periodic{};    ///< the two sides across axis k are one
  OnEscape on_escape = OnEscape::refuse;

  bool any_periodic() const {
    for (const bool side : periodic) {
      if (side) return true;
    }
    return false;
  }

  Vec<Dim, Real> length() const { return upper - lower; }

  /// Inside every side that is not periodic.
  bool contains(const Vec<Dim, Real>& x) const {
    bool inside = true;
    for (int k = 0; k < Dim; ++k) {
      if (!periodic[static_cast<std::size_t>(k)]) inside &= lower[k] <= x[k] && x[k] <= upper[k];
    }
    return inside;
  }

  /// How far x is inside of every side that is not periodic [m]; below 0: outside.
  Real clearance(const Vec<Dim, Real>& x) const {
    Real least = std::numeric_limits<Real>::infinity();
    for (int k = 0; k < Dim; ++k) {
      if (periodic[static_cast<std::size_t>(k)]) continue;
      least = std::min({least, x[k] - lower[k], upper[k] - x[k]});
    }
    return least;
  }

  /// [m³], in 2D [m²].
  double volume() const { return double(length().prod()); }
  /// Itself: among regions of other shapes, the box around it.
  const Box& bounds() const { return *this; }

  /// The image of x in [lower, upper) along the periodic axes, in closed form. What is not finite
  /// stays as it is.
  Vec<Dim, Real> wrap(Vec<Dim, Real> x) const {
    for (int k = 0; k < Dim; ++k) {
      if (!periodic[static_cast<std::size_t>(k)]) continue;
      const Real side = upper[k] - lower[k];
      if ((x[k] >= lower[k] && x[k] < upper[k]) || !is_finite(x[k])) continue;
      x[k] -= side * std::floor((x[k] - lower[k]) / side);
      // Rounding may leave it on the upper side; from very far, where a period is less than the
      // spacing of numbers, anywhere.
      if (!(x[k] >= lower[k] && x[k] < upper[k])) x[k] = lower[k];
    }
    return x;
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("lower", lower);
    archive("upper", upper);
    archive("periodic", periodic);
    archive("on_escape", on_escape);
  }

  /// Throws unless lower < upper along every axis, with finite sides where periodic.
  void check() const {
    for (int k = 0; k < Dim; ++k) {
      const std::string axis = "Box: axis " + std::to_string(k);
      if (periodic[static_cast<std::size_t>(k)]) {
        require_finite(axis + ": lower", double(lower[k]));
        require_finite(axis + ": upper", double(upper[k]));
      }
      if (!(lower[k] < upper[k])) {
        fail(axis + ": lower = " + to_text(double(lower[k])) + " is not below upper = " +
             to_text(double(upper[k])) + "; give a box with a positive length");
      }
    }
  }
};

}  // namespace silt
