// SPDX-License-Identifier: MIT
// Time steps of DEM: the paper's, the one that is stable for given contacts, and a default.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace silt::dem {

struct Spring {
  double mass = 0;       ///< m [kg], above 0
  double stiffness = 0;  ///< k [N/m], above 0

  void check() const {
    require_positive("Spring: mass", mass);
    require_positive("Spring: stiffness", stiffness);
  }
};

/// Δt_critical = 2 √(m/k), [SahChoi2004] (34) [s]; the paper uses 0.8 of it. It is the limit of one
/// particle on one spring to the ground. It is NOT safe between particles: a pair has √2 √(m/k),
/// a particle with more contacts less. Contacts::step refuses what is unstable.
inline double sah_choi_critical_time_step(const Spring& spring) {
  spring.check();
  return 2 * std::sqrt(spring.mass / spring.stiffness);
}

/// Half a period of an undamped contact, π √(m*/k) [s]; `mass` is the effective one.
inline double contact_duration(const Spring& spring) {
  spring.check();
  return std::numbers::pi * std::sqrt(spring.mass / spring.stiffness);
}

/// Largest stable Δt of leapfrog [s] for the angular frequency ω [1/s] with dashpots c = β k that
/// see the velocity of the half step before: (2/ω) (√(1 + ζ²) − ζ), ζ = β ω/2.
struct Oscillator {
  double angular_frequency = 0;
  double beta = 0;
};
inline double stable_time_step(const Oscillator& o) {
  const double zeta = o.beta * o.angular_frequency / 2;
  return 2 / o.angular_frequency * (std::sqrt(1 + zeta * zeta) - zeta);
}

/// Bound on the squared angular frequency [1/s²] of a grain among the contacts that it has.
///
/// A contact's spring energy is ½ k (g_i·q_i + g_j·q_j)², with q the displacements and turns in
/// mass-weighted coordinates. By Cauchy and Schwarz, each grain may be given the share
/// (1/m_i + 1/m_j) m_i k (g_i·q_i)²; the largest eigenvalue of the sum of a grain's shares then bounds
/// ω² of the whole system from above, and is exact for a single pair.
template <int Dim, class Real>
class FrequencyBound {
  static constexpr int size = Dim == 2 ? 3 : 6;
  using Matrix = Eigen::Matrix<double, size, size>;

 public:
  /// The contact of a grain with the given mass [kg], inertia [kg m²] and lever arm [m].
  struct Side {
    double mass;
    double inertia;
    double arm;
  };
  void add(const Contact<Dim, Real>& contact, const Stiffness& k, const Side& side) {
    const Vec<Dim, double> n = contact.normal.template cast<double>();
    // Velocity of the contact point from that of the grain and its scaled spin w √(I/m).
    Eigen::Matrix<double, Dim, size> motion = Eigen::Matrix<double, Dim, size>::Zero();
    motion.template leftCols<Dim>().setIdentity();
    const double lever = side.arm * std::sqrt(side.mass / side.inertia);
    if constexpr (Dim == 2) {
      motion.col(2) = lever * Vec<2, double>(n[1], -n[0]);
    } else {
      motion.template rightCols<3>() << 0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0;
      motion.template rightCols<3>() *= lever;
    }
    using Plane = Eigen::Matrix<double, Dim, Dim>;
    const Plane normal = n * n.transpose();
    const Plane spring = k.normal * normal + k.tangential * (Plane::Identity() - normal);
    shares_ += motion.transpose() * spring * motion / double(contact.effective_mass);
  }

  /// ≥ the largest eigenvalue, too large by less than 6 %: the trace of the 32nd power.
  double squared_frequency() const {
    const double scale = shares_.trace();
    if (!(scale > 0)) return 0;
    Matrix power = shares_ / scale;
    double exponent = 1;
    for (int squarings = 0; squarings < 5; ++squarings) {
      power = Matrix(power * power);
      exponent /= 2;
    }
    return scale * std::pow(power.trace(), exponent);
  }

 private:
  Matrix shares_ = Matrix::Zero();
};

}  // namespace silt::dem
