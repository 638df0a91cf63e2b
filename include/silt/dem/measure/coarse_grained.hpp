// SPDX-License-Identifier: MIT
// Continuous fields of grains on a grid: density, momentum and stress, which satisfy the balances
// of mass and momentum exactly at every point and for any width [Goldhirsch2010]. With the weight
// φ,
//
//   ρ = Σ_i m_i φ(r − x_i),   ρ u = Σ_i m_i v_i φ(r − x_i),
//   σ = Σ_i m_i v_i' ⊗ v_i' φ(r − x_i) + Σ_c F_c ⊗ l_c ∫_0^1 φ(r − x_c − s l_c) ds,  v' = v − u(r),
//   t = −Σ_c φ(r − x_c) F_c at walls [WeinhartThorntonLudingBokhove2012],
//
//   ∂ρ/∂t = −∇·(ρ u),   ∂(ρ u)/∂t = −∇·(ρ u ⊗ u + σ) − t + Σ_i F_i φ(r − x_i),
//
// where F_c acts on grain i, l_c is the vector from the centre x_c of the partner, at a wall from
// the contact x_c, to that of i, t the force per volume on walls, and F_i are the other forces.
// Compression is positive.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/eigen.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace silt::dem {

/// A regular grid of points, and the width of the weight.
template <int Dim>
struct CoarseGrid {
  Box<Dim, double> region;  ///< of finite size; the first and the last points are on its sides [m]
  double spacing = 0;       ///< of the points, at most: a whole number of them fits [m]
  /// c [m]: φ = φ_0 (1 − r²/c²)³ for r < c. About three mean radii show single grains, six a
  /// continuum.
  double width = 0;

  /// Throws if a member is out of range, or if there are more than 10⁸ points.
  void check() const {
    region.check();
    require_finite("dem::CoarseGrid: lower side of the region", region.lower);
    require_finite("dem::CoarseGrid: upper side of the region", region.upper);
    require_positive("dem::CoarseGrid: spacing", spacing);
    require_positive("dem::CoarseGrid: width", width);
    double points = 1;
    for (int k = 0; k < Dim; ++k) points *= std::ceil(region.length()[k] / spacing) + 1;
    if (points <= 1e8) return;
    fail({"dem::CoarseGrid: spacing = ", spacing, " m gives ", points,
          " points, more than 1e8; give a larger one"});
  }
};

/// What coarse_grained() returns: fields at the points of a grid, numbered with the first
/// coordinate fastest.
template <int Dim>
class CoarseGrained {
  using Vector = Vec<Dim>;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  // Places of the fields among the numbers of a point.
  static constexpr int density_at = 0;
  static constexpr int momentum_at = 1;
  static constexpr int flux_at = momentum_at + Dim;
  static constexpr int contact_at = flux_at + Dim * Dim;
  static constexpr int wall_at = contact_at + Dim * Dim;
  static constexpr int density_rate_at = wall_at + Dim;
  static constexpr int of_flux_at = density_rate_at + 1;
  static constexpr int of_contact_at = of_flux_at + Dim;
  static constexpr int words = of_contact_at + Dim;

 public:
  /// All fields are 0. Throws as CoarseGrid::check() does.
  explicit CoarseGrained(const CoarseGrid<Dim>& grid) : grid_(grid) {
    grid.check();
    Index size = 1;
    for (int k = 0; k < Dim; ++k) {
      const double length = grid.region.length()[k];
      const auto intervals = std::max<Index>(1, Index(std::ceil(length / grid.spacing)));
      counts_[std::size_t(k)] = intervals + 1;
      steps_[k] = length / double(intervals);
      size *= intervals + 1;
    }
    numbers_.assign(size * words, 0.0);
  }

  /// Number of points.
  Index size() const { return numbers_.size() / words; }
  /// Number of points along each axis.
  const std::array<Index, Dim>& counts() const { return counts_; }
  /// Of a point [m].
  Vector position_of(Index point) const {
    Vector x;
    for (int k = 0; k < Dim; ++k) {
      const Index count = counts_[std::size_t(k)];
      x[k] = grid_.region.lower[k] + double(point % count) * steps_[k];
      point /= count;
    }
    return x;
  }

  /// ρ [kg/m³]; in 2D [kg/m²].
  double density(Index point) const { return at(point)[density_at]; }
  /// ρ u [kg/(m² s)]; in 2D [kg/(m s)].
  Vector momentum(Index point) const { return vector(point, momentum_at); }
  /// u [m/s]; 0 where there are no grains.
  Vector velocity(Index point) const {
    const double rho = density(point);
    return rho > 0 ? Vector(momentum(point) / rho) : Vector(Vector::Zero());
  }
  /// The part of σ that grains carry [Pa]; in 2D [N/m].
  Matrix kinetic_stress(Index point) const {
    return matrix(point, flux_at) - momentum(point) * velocity(point).transpose();
  }
  /// The part of σ that contacts transmit [Pa]; in 2D [N/m]. Row k is the force along axis k.
  Matrix contact_stress(Index point) const { return matrix(point, contact_at); }
  /// σ [Pa]; in 2D [N/m].
  Matrix stress(Index point) const { return kinetic_stress(point) + contact_stress(point); }
  /// Granular temperature, the mean square of v' along an axis [m²/s²].
  double temperature(Index point) const {
    const double rho = density(point);
    return rho > 0 ? kinetic_stress(point).trace() / (Dim * rho) : 0;
  }
  /// t, the force of grains on walls per volume [N/m³]; in 2D [N/m²].
  Vector wall_force(Index point) const { return vector(point, wall_at); }
  /// ∂ρ/∂t = −∇·(ρ u), exact [kg/(m³ s)].
  double density_rate(Index point) const { return at(point)[density_rate_at]; }
  /// ∇·(ρ u ⊗ u + kinetic stress), exact [N/m³].
  Vector momentum_flux_divergence(Index point) const { return vector(point, of_flux_at); }
  /// ∇·(contact stress), exact [N/m³].
  Vector contact_stress_divergence(Index point) const { return vector(point, of_contact_at); }

  /// Adds a grain with this mass [kg], velocity [m/s] and position [m].
  void add_grain(double m, const Vector& v, const Vector& x) {
    for_each_near(x, x, [&](double* to, const Vector& r) {
      const double phi = weight(r - x);
      const double flow = v.dot(gradient(r - x));
      to[density_at] += m * phi;
      to[density_rate_at] -= m * flow;
      for (int a = 0; a < Dim; ++a) {
        to[momentum_at + a] += m * phi * v[a];
        to[of_flux_at + a] += m * flow * v[a];
        for (int b = 0; b < Dim; ++b) to[flux_at + a + b * Dim] += m * phi * v[a] * v[b];
      }
    });
  }
  /// Adds a contact with this force [N] on the grain at `to`; `from` is the centre of its partner,
  /// or the contact point at a wall [m].
  void add_contact(const Vector& force, const Vector& from, const Vector& to, bool at_wall) {
    const Vector l = to - from;
    for_each_near(from, to, [&](double* fields, const Vector& r) {
      const double line = line_weight(r, from, l);
      const double at_from = weight(r - from);
      const double difference = at_from - weight(r - to);
      for (int a = 0; a < Dim; ++a) {
        fields[of_contact_at + a] += force[a] * difference;
        if (at_wall) fields[wall_at + a] -= force[a] * at_from;
        for (int b = 0; b < Dim; ++b) fields[contact_at + a + b * Dim] += force[a] * l[b] * line;
      }
    });
  }
  /// The numbers of all points, for sums over processes.
  Buffer<double>& numbers() { return numbers_; }

 private:
  const double* at(Index point) const { return numbers_.data() + point * words; }
  Vector vector(Index point, int first) const {
    return Eigen::Map<const Vector>(at(point) + first);
  }
  Matrix matrix(Index point, int first) const {
    return Eigen::Map<const Matrix>(at(point) + first);
  }

  // φ [1/m³], in 2D [1/m²].
  double weight(const Vector& r) const {
    const double left = 1 - r.squaredNorm() / squared(grid_.width);
    return left > 0 ? largest_weight() * left * left * left : 0;
  }
  Vector gradient(const Vector& r) const {
    const double left = 1 - r.squaredNorm() / squared(grid_.width);
    const double factor = left > 0 ? -6 * largest_weight() * left * left / squared(grid_.width) : 0;
    return factor * r;
  }
  double largest_weight() const {
    const double c = grid_.width;
    return Dim == 2 ? 4 / (std::numbers::pi * c * c) : 315 / (64 * std::numbers::pi * c * c * c);
  }
  // ∫_0^1 φ(r − from − s l) ds: a polynomial of degree 6 where φ is not 0, for which four points of
  // Gauss's rule are exact.
  double line_weight(const Vector& r, const Vector& from, const Vector& l) const {
    const Vector d = r - from;
    const double a = l.squaredNorm(), b = d.dot(l), c = d.squaredNorm() - squared(grid_.width);
    if (!(a > 0)) return weight(d);
    const double discriminant = b * b - a * c;
    if (!(discriminant > 0)) return 0;
    const double root = std::sqrt(discriminant);
    const double first = std::max(0.0, (b - root) / a), last = std::min(1.0, (b + root) / a);
    if (!(first < last)) return 0;
    constexpr double points[] = {0.3399810435848563, 0.8611363115940526};
    constexpr double shares[] = {0.6521451548625461, 0.3478548451374538};
    const double middle = (first + last) / 2, half = (last - first) / 2;
    double sum = 0;
    for (int k = 0; k < 2; ++k) {
      for (const double side : {-1.0, 1.0}) {
        sum += shares[k] * weight(d - (middle + side * half * points[k]) * l);
      }
    }
    return sum * half;
  }

  // f(numbers of the point, position) for the points within the width of a line.
  template <class F>
  void for_each_near(const Vector& from, const Vector& to, F&& f) {
    std::array<Index, Dim> first, last;
    for (int k = 0; k < Dim; ++k) {
      const auto axis = std::size_t(k);
      const double below = std::min(from[k], to[k]) - grid_.width - grid_.region.lower[k];
      const double above = std::max(from[k], to[k]) + grid_.width - grid_.region.lower[k];
      const double end = double(counts_[axis] - 1) * steps_[k];
      if (above < 0 || below > end) return;
      first[axis] = Index(std::ceil(std::max(0.0, below) / steps_[k]));
      last[axis] = Index(std::floor(std::min(end, above) / steps_[k]));
      if (first[axis] > last[axis]) return;
    }
    std::array<Index, Dim> each = first;
    while (true) {
      Index point = 0;
      Vector r;
      for (int k = Dim - 1; k >= 0; --k) {
        const auto axis = std::size_t(k);
        point = point * counts_[axis] + each[axis];
        r[k] = grid_.region.lower[k] + double(each[axis]) * steps_[k];
      }
      f(numbers_.data() + point * words, r);
      std::size_t axis = 0;
      while (axis < Dim && ++each[axis] > last[axis]) {
        each[axis] = first[axis];
        ++axis;
      }
      if (axis == Dim) return;
    }
  }

  CoarseGrid<Dim> grid_;
  std::array<Index, Dim> counts_{};
  Vector steps_;
  Buffer<double> numbers_;
};

/// Fields on a grid. Positions, velocities and contacts must belong to the same time, as in a
/// simulation's state(). Of grains that processes share, all call it, and get the fields of all.
/// The same bits on any number of threads. Throws as CoarseGrid::check() does.
template <class P, class C>
CoarseGrained<P::dimension> coarse_grained(const P& grains, const C& contacts,
                                           const CoarseGrid<P::dimension>& grid) {
  static_assert(!move_in_bodies<P>,
                "silt::dem::coarse_grained: it does not know the forces within clumps, which bear "
                "a part of the "
                "stress");
  using Vector = Vec<P::dimension>;
  CoarseGrained<P::dimension> fields(grid);
  const auto x = grains[position];
  // A contact reaches beyond its grain by the radius of the partner.
  double longest = 0;
  for (const auto R : grains.with_halo(radius)) longest = std::max(longest, 4 * double(R));
  for (Index i = 0; i < grains.size(); ++i) {
    for_each_image(grains.box(), in_double(x[i]), grid.width, [&](const Vector& at) {
      fields.add_grain(double(grains[mass][i]), in_double(grains[velocity][i]), at);
    });
  }
  contacts.for_each_contact(grains, [&](Index i, Index j, const auto& contact, const auto& force) {
    double length = double(grains[radius][i]) - double(contact.overlap);
    if (j != no_index) length += double(grains.with_halo(radius)[j]);
    const Vector l = length * in_double(contact.normal);
    for_each_image(grains.box(), in_double(x[i]), grid.width + longest, [&](const Vector& to) {
      fields.add_contact(in_double(force), to - l, to, j == no_index);
    });
  });
  silt::detail::replace_by_sums(grains, fields.numbers());
  return fields;
}

}  // namespace silt::dem
