// SPDX-License-Identifier: MIT
// Calibrates a contact law by derivatives. Its parameters are numbers that carry their derivatives,
// Eigen's AutoDiffScalar, so that an impact gives the rebound and how it depends on the parameters.
#include <silt/dem.hpp>

#include <unsupported/Eigen/AutoDiff>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

using namespace silt;
using Dual = Eigen::AutoDiffScalar<Eigen::Vector2d>;  // derivatives by stiffness and friction

/// A spring with a dashpot, and a spring with a slider. Number is the type of its parameters.
template <class Number>
struct Law {
  Number stiffness;    ///< k_n [N/m]; k_s is 0.8 of it
  Number friction;     ///< μ [-]
  double dashpot = 0;  ///< c_n [N s/m]

  template <int Dim, class Real>
  struct History {
    dem::CentredDashpot::History<Real> normal{};
    Vec<Dim, Real> tangential = Vec<Dim, Real>::Zero();  ///< spring force [N]
  };

  template <class C>
  typename C::Vec force(const C& contact, History<C::dimension, typename C::Real>& history) const {
    using Real = typename C::Real;
    const Real k(stiffness);
    const Real damping = dem::CentredDashpot::force(contact, history.normal, k, Real(dashpot));
    const Real normal = k * contact.overlap + damping;
    const dem::Slider<Real> slider{.stiffness = Real(0.8) * k,
                                   .limit = std::max<Real>(Real(0), Real(friction) * normal)};
    const auto v = contact.tangential_velocity();
    history.tangential = dem::slide(slider, history.tangential, v, contact).spring;
    return normal * contact.normal + history.tangential;
  }
};
static_assert(dem::ContactLaw<Law<double>, 3, double>);  // so that a Simulation accepts it

struct Impact {
  double radius = 0;  ///< of the sphere [m]
  double mass = 0;    ///< m*: of a sphere that hits a plate; half of that if it hits its like [kg]
  double speed = 0;   ///< relative [m/s]
  double angle = 0;   ///< between velocity and normal [rad]
};
/// Velocities of the centre after the impact over those before, tangential and normal [-].
template <class Number>
Vec<2, Number> rebound(const Law<Number>& law, const Impact& impact) {
  constexpr double dt = 1e-9;  // [s]
  const Vec<2> before = impact.speed * Vec<2>(std::sin(impact.angle), -std::cos(impact.angle));
  typename Law<Number>::template History<2, Number> history{};
  dem::Contact<2, Number> contact;
  contact.normal = Vec<2, Number>(Number(0), Number(1));
  contact.effective_mass = Number(impact.mass);
  contact.time_step = Number(dt);
  Vec<2, Number> v = before.cast<Number>();
  Number omega(0);
  contact.overlap = Number(-before[1] * dt / 2);
  while (contact.overlap > 0) {
    contact.relative_velocity = v + Vec<2, Number>(impact.radius * omega, Number(0));
    const Vec<2, Number> F = law.force(contact, history);
    v += F * Number(dt / impact.mass);
    omega += F[0] * (dt / (0.4 * impact.mass * impact.radius));
    contact.overlap -= v[1] * dt;
  }
  return {before[0] > 0 ? Number(v[0] / before[0]) : Number(0), Number(v[1] / -before[1])};
}

int main() {
  // Two glass beads collide head on, with the restitution e.
  const Impact head_on{.radius = 1.5e-3, .mass = 1.8e-5, .speed = 1};
  const double k = 1e5, c = 0.1, h = 1e-7 * k;
  const auto e = [&](double s) { return rebound(Law<double>{s, 0, c}, head_on)[1]; };
  const double slope = rebound(Law<Dual>{Dual(k, 2, 0), Dual(0), c}, head_on)[1].derivatives()[0];
  const double difference = (e(k + h) - e(k - h)) / (2 * h);
  std::printf("d e/d k [m/N]: %.6e, by finite differences %.6e\n", slope, difference);
  // Spheres of aluminium oxide hit glass at 3.9 m/s [KharazGormanSalman2001]: angles [°] and the
  // tangential velocity after over before, as digitised by the project Lethe.
  constexpr double measured[][2] = {{39.38, 0.771}, {49.69, 0.848}, {60.02, 0.901}};
  const double m = 4000 * 4.0 / 3 * std::numbers::pi * std::pow(2.5e-3, 3);
  const double damping = 2 * dem::Restitution(0.98).damping_ratio * std::sqrt(1e7 * m);
  double friction = 0.3;
  for (int iteration = 0; iteration < 4; ++iteration) {  // Gauss–Newton
    double squares = 0, misfit = 0;
    for (const auto& [degrees, ratio] : measured) {
      const Dual found = rebound(Law<Dual>{Dual(1e7), Dual(friction, 2, 1), damping},
                                 {2.5e-3, m, 3.9, degrees * std::numbers::pi / 180})[0];
      squares += squared(found.derivatives()[1]);
      misfit += found.derivatives()[1] * (ratio - found.value());
    }
    friction += misfit / squares;
  }
  std::printf("friction %.4f; usually 0.092 in simulations of this experiment\n", friction);
  return std::abs(slope / difference - 1) < 1e-5 && std::abs(friction - 0.092) < 0.002 ? 0 : 1;
}
