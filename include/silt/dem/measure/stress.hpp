// SPDX-License-Identifier: MIT
// Stress in a region: momentum carried by grains and transmitted by contacts. After [Weber1966];
// contacts across the boundary of the region count in part, as in [Goldhirsch2010] with a weight
// that is constant in the region:
//
//   σ = 1/V ( Σ_i m_i v_i' ⊗ v_i' + Σ_c F_c ⊗ l_c s_c ),  v' = v − ⟨v⟩,
//
// where F is the force on grain i, l the vector from the centre of the partner (at a wall from the
// contact) to that of i, and s the fraction of l inside the region. Compression is positive.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/eigen.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace silt::dem {

/// What stress() returns: the momentum that grains carry, and the forces that contacts transmit;
/// compression is positive.
template <int Dim>
struct Stress {
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  Matrix kinetic = Matrix::Zero();  ///< [Pa]; in 2D [N/m]
  Matrix contact = Matrix::Zero();  ///< [Pa]; in 2D [N/m]

  /// σ [Pa]; in 2D [N/m].
  Matrix sum() const { return kinetic + contact; }
  /// A third of the trace [Pa]; in 2D half of it [N/m].
  double pressure() const { return sum().trace() / Dim; }
};

namespace detail {
// Fraction of the line from a to b that lies inside the box.
template <int Dim>
double share_within(const Box<Dim, double>& box, const Vec<Dim>& a, const Vec<Dim>& b) {
  double first = 0;
  double last = 1;
  for (int k = 0; k < Dim; ++k) {
    const double length = b[k] - a[k];
    if (length == 0) {
      if (a[k] < box.lower[k] || a[k] >= box.upper[k]) return 0;
      continue;
    }
    const double to_lower = (box.lower[k] - a[k]) / length;
    const double to_upper = (box.upper[k] - a[k]) / length;
    first = std::max(first, std::min(to_lower, to_upper));
    last = std::min(last, std::max(to_lower, to_upper));
  }
  return std::max(0.0, last - first);
}
}  // namespace detail

/// Stress in a region of finite size inside the grains' box, after [Weber1966]; contacts across its
/// boundary count in part, as in [Goldhirsch2010]. Positions, velocities and contacts must belong
/// to the same time, as in a simulation's state(). Of grains that processes share, all call it.
/// Throws if the volume of the region is zero or infinite.
template <class P, class C>
Stress<P::dimension> stress(const P& grains, const C& contacts,
                            const Box<P::dimension, double>& region) {
  static_assert(
      !move_in_bodies<P>,
      "silt::dem::stress: it does not know the forces within clumps, which bear a part of the "
      "stress");
  constexpr int dimension = P::dimension;
  using Vector = Vec<dimension>;
  region.check();
  require_finite("dem::stress: lower side of the region", region.lower);
  require_finite("dem::stress: upper side of the region", region.upper);
  const auto x = grains[position];
  const auto v = grains[velocity];
  const auto for_each_within = [&](auto&& f) {
    for (Index i = 0; i < grains.size(); ++i) {
      const Vector at = in_double(x[i]);
      if ((at.array() >= region.lower.array()).all() && (at.array() < region.upper.array()).all()) {
        f(double(grains[mass][i]), in_double(v[i]));
      }
    }
  };
  double mass_of_own = 0;
  Vector momentum_of_own = Vector::Zero();
  for_each_within([&](double m, const Vector& u) {
    mass_of_own += m;
    momentum_of_own += m * u;
  });
  const double mass_within = silt::detail::sum_of_all(grains, mass_of_own);
  const Vector momentum = silt::detail::sum_of_all(grains, momentum_of_own);
  Stress<dimension> stress;
  for_each_within([&](double m, const Vector& u) {
    const Vector off = u - momentum / mass_within;
    stress.kinetic += m * off * off.transpose();
  });
  contacts.for_each_contact(grains, [&](Index i, Index j, const auto& contact, const auto& force) {
    double length = double(grains[radius][i]) - double(contact.overlap);
    if (j != no_index) length += double(grains.with_halo(radius)[j]);
    const Vector l = length * in_double(contact.normal);
    double share = 0;
    constexpr double any_distance = std::numeric_limits<double>::infinity();
    for_each_image(grains.box(), in_double(x[i]), any_distance, [&](const Vector& to) {
      share += detail::share_within<dimension>(region, to - l, to);
    });
    stress.contact += share * in_double(force) * l.transpose();
  });
  for (auto* const each : {&stress.kinetic, &stress.contact}) {
    silt::detail::replace_by_sums(grains, {each->data(), std::size_t(dimension * dimension)});
  }
  const double volume = region.length().prod();
  stress.kinetic /= volume;
  stress.contact /= volume;
  return stress;
}

}  // namespace silt::dem
