// SPDX-License-Identifier: MIT
// An impact of two grains, or of a grain on a wall, for the checks of a law.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/conformance/prescribed_contact.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/setup/grains.hpp>

#include <cmath>

namespace silt::dem::detail {

/// Initial conditions. The first grain moves along the first axis, with a slip along the second.
struct ImpactStart {
  bool wall = false;     ///< impact on a wall instead of a smaller grain
  double speed = 0;      ///< relative to the other side [m/s]
  double angle = 0;      ///< between this velocity and the normal [rad]
  double spin = 0;       ///< of the first grain, times R, over the speed [-]
  double time_step = 0;  ///< [s]
  double max_time = 0;   ///< contacts that last longer are regarded as sticking [s]
};

struct ImpactResult {
  double restitution = 0;    ///< normal speed after over before; 0 if they stick [-]
  double energy_before = 0;  ///< kinetic, with rotation, in the centre-of-mass frame [J]
  double energy_after = 0;   ///< the same after the impact; 0 if they stick [J]
};

/// Integrates the motion with leapfrog from before the contact until after it.
template <int Dim>
class TestImpact {
 public:
  TestImpact(const Grain& grain, const ImpactStart& start) : start_(start) {
    Grain smaller = grain;
    smaller.radius *= 0.7;
    const double gap = 1.5 * start.speed * std::cos(start.angle) * start.time_step;
    add_grain(grains_, Vec<Dim>((grain.radius + gap) * n_), grain);
    add_grain(grains_, Vec<Dim>(-smaller.radius * n_), smaller);
    const auto m = grains_[mass];
    contact_.time_step = start.time_step;
    contact_.effective_mass = start.wall ? m[0] : m[0] * m[1] / (m[0] + m[1]);
    contact_.effective_radius =
        start.wall ? grain.radius : grain.radius * smaller.radius / (grain.radius + smaller.radius);
    // The centre of mass is at rest.
    const Vec<Dim> v =
        start.speed * (-std::cos(start.angle) * n_ + std::sin(start.angle) * Vec<Dim>::Unit(1));
    grains_[velocity][0] = contact_.effective_mass / m[0] * v;
    if (!start.wall) grains_[velocity][1] = -contact_.effective_mass / m[1] * v;
    const double spin = start.spin * start.speed / grain.radius;
    if constexpr (Dim == 2) {
      grains_[silt::spin][0] = spin;
    } else {
      grains_[silt::spin][0] = {0.3 * spin, 0.4 * spin, 0.8 * spin};
    }
  }

  ImpactResult operator()(const ContactEvaluator<Dim>& evaluate) {
    ImpactResult report{.energy_before = energy()};
    const double approach_speed = -separating();
    bool touched = false;
    for (double time = 0; time < start_.max_time; time += start_.time_step) {
      update_contact();
      if (contact_.overlap > 0) {
        touched = true;
        kick(evaluate(contact_));
      } else if (touched) {
        report.restitution = separating() / approach_speed;
        report.energy_after = energy();
        break;
      }
      const auto v = grains_[velocity];
      for (Index i = 0; i < 2; ++i) grains_[position][i] += v[i] * start_.time_step;
    }
    return report;
  }

 private:
  // Vector from the other grain's centre, or from the wall, which is at 0.
  Vec<Dim> distance() const {
    if (start_.wall) return grains_[position][0].dot(n_) * n_;
    return grains_[position][0] - grains_[position][1];
  }
  double separating() const {
    return (grains_[velocity][0] - grains_[velocity][1]).dot(distance().normalized());
  }

  double arm(Index i) const {
    return grains_[radius][i] - contact_.overlap / (start_.wall ? 1 : 2);
  }
  void update_contact() {
    const Vec<Dim> r = distance();
    const auto R = grains_[radius];
    contact_.normal = r.normalized();
    contact_.overlap = R[0] + (start_.wall ? 0 : R[1]) - r.norm();
    const auto surface = [&](Index i, double towards) {
      const Vec<Dim> at = towards * arm(i) * contact_.normal;
      return Vec<Dim>(grains_[velocity][i] + cross(grains_[spin][i], at));
    };
    contact_.relative_velocity = surface(0, -1) - surface(1, 1);
    contact_.relative_spin = grains_[spin][0] - grains_[spin][1];
  }

  void kick(const LawLoad<Dim>& load) {
    const double sides[] = {1, -1};
    for (Index i = 0; i < (start_.wall ? 1u : 2u); ++i) {
      const Vec<Dim> force = sides[i] * load.force;
      const Vec<Dim> at = -sides[i] * arm(i) * contact_.normal;
      const AngularVec<Dim> turning = cross(at, force) + sides[i] * load.couple;
      grains_[velocity][i] += force / grains_[mass][i] * start_.time_step;
      grains_[spin][i] += turning / grains_[inertia][i] * start_.time_step;
    }
  }

  double energy() const { return kinetic_energy(grains_) + rotational_energy(grains_); }

  const Vec<Dim> n_ = Vec<Dim>::Unit(0);
  ImpactStart start_;
  Grains<Dim> grains_;  // the second one is unused in an impact on a wall
  Contact<Dim, double> contact_;
};

}  // namespace silt::dem::detail
