// SPDX-License-Identifier: MIT
// The simulation box: its bounds, its periodic sides, and what happens to particles that leave it.
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
  refuse,  ///< the step throws and is rolled back
  remove,  ///< the particle is removed and counted, see Simulation::particles_lost()
};
/// Whether the value is one of the enumeration's, and not another number, as from a damaged file.
constexpr bool is_enumerator(OnEscape value) {
  return value == OnEscape::refuse || value == OnEscape::remove;
}

/// Axis-aligned box; unbounded by default. Its members are checked when it is given to particles:
/// Particles(box) and set_box(box) throw as check() does. Other functions do not throw.
template <int Dim, class Real = double>
struct Box {
  /// Corner with the smallest coordinates [m]; finite along periodic axes.
  Vec<Dim, Real> lower = Vec<Dim, Real>::Constant(-std::numeric_limits<Real>::infinity());
  /// Opposite corner [m], above `lower` along every axis; finite along periodic axes.
  Vec<Dim, Real> upper = Vec<Dim, Real>::Constant(std::numeric_limits<Real>::infinity());
  /// Whether axis k (0: x, 1: y, 2: z) is periodic. A search throws in its update if a periodic
  /// side is shorter than twice the search radius plus skin. A flow needs an integer number of
  /// spacings.
  std::array<bool, Dim> periodic{};
  OnEscape on_escape = OnEscape::refuse;  ///< for particles beyond a side that is not periodic

  /// Whether an axis is periodic.
  bool any_periodic() const {
    return std::find(periodic.begin(), periodic.end(), true) != periodic.end();
  }

  /// Length along each axis [m]; infinite along an unbounded one.
  Vec<Dim, Real> length() const { return upper - lower; }

  /// Whether x [m] is within the bounds, both included, along every axis that is not periodic.
  bool contains(const Vec<Dim, Real>& x) const {
    bool inside = true;
    for (int k = 0; k < Dim; ++k) {
      if (!periodic[static_cast<std::size_t>(k)]) inside &= lower[k] <= x[k] && x[k] <= upper[k];
    }
    return inside;
  }

  /// Distance from x [m] to the nearest side that is not periodic [m]; negative outside, infinite
  /// without such a side.
  Real clearance(const Vec<Dim, Real>& x) const {
    Real minimum = std::numeric_limits<Real>::infinity();
    for (int k = 0; k < Dim; ++k) {
      if (periodic[static_cast<std::size_t>(k)]) continue;
      minimum = std::min({minimum, x[k] - lower[k], upper[k] - x[k]});
    }
    return minimum;
  }

  /// Volume [m³], in 2D area [m²]; infinite if the box is unbounded.
  double volume() const { return double(length().prod()); }
  /// The box itself; regions of other shapes return their bounding box.
  const Box& bounds() const { return *this; }

  /// The periodic image of x [m] in [lower, upper) along the periodic axes, from any distance.
  /// Coordinates that are not finite are returned unchanged.
  Vec<Dim, Real> wrap(Vec<Dim, Real> x) const {
    for (int k = 0; k < Dim; ++k) {
      if (!periodic[static_cast<std::size_t>(k)]) continue;
      const Real side = upper[k] - lower[k];
      if ((x[k] >= lower[k] && x[k] < upper[k]) || !is_finite(x[k])) continue;
      x[k] -= side * std::floor((x[k] - lower[k]) / side);
      // Rounding may give the upper bound, or, if x is so far away that the period is less than the
      // spacing of floating-point numbers, any value.
      if (!(x[k] >= lower[k] && x[k] < upper[k])) x[k] = lower[k];
    }
    return x;
  }

  /// Writes or reads the box for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("lower", lower);
    archive("upper", upper);
    archive("periodic", periodic);
    archive("on_escape", on_escape);
    if constexpr (Archive::reads) check();
  }

  /// Throws unless lower < upper along every axis, both and the length finite along periodic axes.
  void check() const {
    for (int k = 0; k < Dim; ++k) {
      const std::string axis = "Box: axis " + std::to_string(k);
      if (periodic[static_cast<std::size_t>(k)]) {
        require_finite(axis + ": lower", double(lower[k]));
        require_finite(axis + ": upper", double(upper[k]));
      }
      if (!(lower[k] < upper[k])) {
        fail({axis, ": lower = ", lower[k], " is not below upper = ", upper[k],
              "; give a box with a positive length"});
      }
      if (periodic[static_cast<std::size_t>(k)]) {
        require_finite(axis + ": upper - lower", double(Real(upper[k] - lower[k])));
      }
    }
  }
};

}  // namespace silt
