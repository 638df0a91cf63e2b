// SPDX-License-Identifier: MIT
// What a particle adds to its own number density where its fluid is spread over a larger volume.
#pragma once

#include <silt/core/cube_root.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/lattice.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace silt::mps {

/// c(V) = n0 − V Σ w over a lattice in which each particle has the volume V l0^Dim [-], so that
///
///   n_i = Σ_j V_j w_ij + c(V_i)
///
/// is n0 on every such lattice: about w(0) (V − 1), the particle's own share. Without it, sums with
/// few neighbours would be too small.
template <int Dim, class Real>
class OwnDensity {
 public:
  /// None: V = 1.
  OwnDensity() = default;
  /// Of a kernel with a radius re/l0. Throws as lattice_values() does.
  template <class K>
  OwnDensity(double radius, const K& kernel) : radius_(radius) {
    const double n0 = lattice_values<Dim, K>(radius, kernel).n0;
    for (Index k = 0; k <= intervals; ++k) {
      const double size = 1 + (largest_size() - 1) * double(k) / double(intervals);
      const double volume = size * size * (Dim == 3 ? size : 1);
      values_[k] = Real(n0 - volume * lattice_values<Dim, K>(radius / size, kernel).n0);
    }
    values_[0] = 0;
  }

  /// The largest V for which enough neighbours are left [-].
  double largest_volume() const { return largest_volume(radius_); }
  /// The same with a radius re/l0 [-].
  static double largest_volume(double radius) { return std::pow(largest_size(radius), Dim); }
  /// The radius re/l0 that V needs [-].
  static double radius_for(double volume) { return least_radius * std::pow(volume, 1.0 / Dim); }
  /// V is at most largest_volume().
  Real operator()(Real volume) const {
    const Real size = Dim == 2 ? std::sqrt(volume) : cube_root(volume);
    const Real place = (size - 1) / Real(largest_size() - 1) * Real(intervals);
    const Index k = std::min(Index(std::max(place, Real(0))), intervals - 1);
    return values_[k] + (place - Real(k)) * (values_[k + 1] - values_[k]);
  }

 private:
  static constexpr Index intervals = 256;
  // Of a lattice, over its spacing: 8 neighbours in 2D, 18 in 3D.
  static constexpr double least_radius = 1.5;

  double largest_size() const { return largest_size(radius_); }
  static double largest_size(double radius) { return std::max(radius / least_radius, 1 + 1e-9); }

  double radius_ = 0;
  std::array<Real, intervals + 1> values_{};
};

}  // namespace silt::mps
