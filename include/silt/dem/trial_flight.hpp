// SPDX-License-Identifier: MIT
// Two grains, or one and a wall, that fly into contact and out of it under a law on trial.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/prescribed_contact.hpp>

#include <cmath>

namespace silt::dem {

/// How a flight begins. The first grain comes along the first axis, and slides along the second.
struct FlightStart {
  bool wall = false;     ///< onto a wall, in place of a smaller grain
  double speed = 0;      ///< against the other one [m/s]
  double angle = 0;      ///< of that velocity against the normal [rad]
  double spin = 0;       ///< of the first grain, times R, over the speed [-]
  double time_step = 0;  ///< [s]
  double longest = 0;    ///< after so long they are said to stick [s]
};

struct FlightReport {
  double restitution = 0;    ///< normal speed after over before; 0 if they stick [-]
  double energy_before = 0;  ///< of motion and spin, where the centre of mass rests [J]
  double energy_after = 0;   ///< likewise; 0 if they stick
};

/// Moves them by leapfrog, from before the contact to behind it.
template <int Dim>
class TrialFlight {
 public:
  TrialFlight(const Grain& grain, const FlightStart& start) : start_(start) {
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
    // The centre of mass rests.
    const Vec<Dim> v = start.speed * (-std::cos(start.angle) * n_ +
                                      std::sin(start.angle) * Vec<Dim>::Unit(1));
    grains_[velocity][0] = contact_.effective_mass / m[0] * v;
    if (!start.wall) grains_[velocity][1] = -contact_.effective_mass / m[1] * v;
    const double spin = start.spin * start.speed / grain.radius;
    if constexpr (Dim == 2) {
      grains_[silt::spin][0] = spin;
    } else {
      grains_[silt::spin][0] = {0.3 * spin, 0.4 * spin, 0.8 * spin};
    }
  }

  FlightReport operator()(const AskLaw<Dim>& ask) {
    FlightReport report{.energy_before = energy()};
    const double coming = -separating();
    bool touched = false;
    for (double time = 0; time < start_.longest; time += start_.time_step) {
      look();
      if (contact_.overlap > 0) {
        touched = true;
        kick(ask(contact_));
      } else if (touched) {
        report.restitution = separating() / coming;
        report.energy_after = energy();
        break;
      }
      const auto v = grains_[velocity];
      for (Index i = 0; i < 2; ++i) grains_[position][i] += v[i] * start_.time_step;
    }
    return report;
  }

 private:
  // From the other one's centre, or from the wall, which is at 0.
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
  void look() {
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
  FlightStart start_;
  Grains<Dim> grains_;  // the second one stands aside where there is a wall
  Contact<Dim, double> contact_;
};

}  // namespace silt::dem
