// SPDX-License-Identifier: MIT
// Oblique impacts of two bodies, as in tests 4 to 8 of Chung and Ooi (2011), with several forms of
// the contact law.
#pragma once

#include <silt/dem/contact/chung_ooi.hpp>
#include <silt/dem/law/mindlin_deresiewicz.hpp>

#include "support/grains.hpp"

#include <cmath>
#include <string>

namespace silt::test {

enum class ImpactForm {
  by_default,    ///< Mindlin and the lever arm of Silt
  published,     ///< dem::chung_ooi_law, dem::chung_ooi_settings
  inferred,      ///< the same with the Inferred of the bodies
  partial_slip,  ///< Mindlin and Deresiewicz
};

/// A change of the published form, inferred from a published curve that it does not give.
struct Inferred {
  bool shearing_plane = false;  ///< in shear, the plane is as stiff as the sphere
  bool limited_sum = false;     ///< SumLimitedMindlin
  double poisson_ratio = 0;     ///< of the sphere; 0: the given one

  bool any() const { return shearing_plane || limited_sum || poisson_ratio > 0; }
};

struct ObliqueBody {
  double R = 0;        ///< [m]; 0: a plane
  double density = 0;  ///< [kg/m³]
  dem::Elastic elastic;
};

/// A sphere, and the plane or sphere that it hits.
struct ObliqueBodies {
  std::string name;
  ObliqueBody sphere;
  ObliqueBody other;
  double restitution;
  double friction;
  Inferred inferred = {};
};

struct ObliqueMotion {
  double v;                  ///< along the surface [m/s]
  double v_n;                ///< towards the other body before, away from it after [m/s]
  double spin;               ///< positive if the sphere rolls along v [1/s]
  double spin_of_other = 0;  ///< [1/s]
};

/// As Mindlin with keeps_displacement, but friction limits the sum of spring and dashpot.
struct SumLimitedMindlin {
  dem::Elastic elastic = {};
  double friction = 0;  ///< μ [-]

  template <int Dim, class Real>
  struct History {
    Vec<Dim, Real> displacement = Vec<Dim, Real>::Zero();  ///< [m]
  };

  template <class C, class M>
  dem::TangentialForce<C> tangential_force(const C& contact, const dem::NormalForce<C>& normal,
                                           M& history) const {
    using Real = typename C::Real;
    using Vec = typename C::Vec;
    const Real k = spring(contact);
    const Real c = normal.beta * std::sqrt(normal.stiffness * k);
    const Vec v = contact.tangential_velocity();
    const Vec elastic_force = -k * (dem::rotated_into_plane(history.displacement, contact.normal) +
                                    v * contact.time_step);
    const Vec both = elastic_force - c * v;
    const Real limit = Real(friction) * normal.spring;
    const Real size = both.norm();
    if (size > limit) {
      const Vec force = both * (limit / size);
      history.displacement = -force / k;
      return {.spring = force};
    }
    history.displacement = -elastic_force / k;
    return {.spring = elastic_force, .dashpot = -c * v};
  }

  template <class C>
  dem::Stiffness stiffness(const C& contact, dem::Stiffness all) const {
    all.tangential = double(spring(contact));
    return all;
  }

  static SumLimitedMindlin mix(const SumLimitedMindlin& a, const SumLimitedMindlin& b) {
    return {.elastic = dem::Elastic::mix(a.elastic, b.elastic), .friction = a.friction};
  }

 private:
  template <class C>
  typename C::Real spring(const C& contact) const {
    return typename C::Real(8 * elastic.contact_shear_modulus()) *
           std::sqrt(contact.effective_radius * contact.overlap);
  }
};

/// The motion of the first sphere after it has hit the second or, if it is alone, a plane at z = 0.
/// `duration` [s] is that of the contact.
template <class Law>
ObliqueMotion collide(const dem::Grains<3>& spheres, const dem::Materials<Law>& materials,
                      const dem::ContactSettings& settings, double duration) {
  const double far = spheres.size() == 1 ? 0 : -1e3;
  const dem::Plane<3> plane{.point = {0, 0, far}, .material = 1};
  Simulation simulation{spheres, UniformGrid<3>{}, dem::Contacts{materials, plane}.with(settings),
                        Leapfrog{}};
  bool has_touched = false;
  for (int step = 0; step < 2000; ++step) {
    simulation.step(duration / 500);
    has_touched |= simulation.interaction().size() > 0;
    if (has_touched && simulation.interaction().size() == 0) break;
  }
  const auto& after = simulation.particles();
  return {after[velocity][0][0], after[velocity][0][2], after[spin][0][1]};
}

template <class Law>
ObliqueMotion bounce(const ObliqueBodies& bodies, const ObliqueMotion& before,
                     const dem::Materials<Law>& materials, const dem::ContactSettings& settings) {
  const ObliqueBody& sphere = bodies.sphere;
  const ObliqueBody& other = bodies.other;
  const bool at_plane = other.R == 0;
  auto grains = one_grain<3>({0, 0, sphere.R * (1 + 1e-9)}, {before.v, 0, -before.v_n},
                             {.radius = sphere.R, .density = sphere.density});
  grains[spin][0] = {0, before.spin, 0};
  if (!at_plane) {
    dem::add_grain(grains, {0, 0, -other.R},
                   {.radius = other.R, .density = other.density, .material = 1});
    grains[spin][1] = {0, before.spin_of_other, 0};
  }
  // Hertz's theory for a much heavier body.
  const double R = at_plane ? sphere.R : sphere.R * other.R / (sphere.R + other.R);
  const double E = dem::Elastic::mix(sphere.elastic, other.elastic).contact_modulus();
  const double overlap =
      std::pow(15 * grains[mass][0] * squared(before.v_n) / (16 * E * std::sqrt(R)), 0.4);
  return collide(grains, materials, settings, 2.9433 * overlap / before.v_n);
}

/// The motion of the sphere after the impact.
inline ObliqueMotion bounce(const ObliqueBodies& bodies, const ObliqueMotion& before,
                            ImpactForm form) {
  const Inferred change = form == ImpactForm::inferred ? bodies.inferred : Inferred{};
  const double angle = std::atan(bodies.friction);
  const auto hertz = [&](const dem::Elastic& elastic) {
    return dem::Hertz{.elastic = elastic, .restitution = bodies.restitution};
  };
  const auto run = [&](const auto& law, const dem::ContactSettings& settings) {
    dem::Elastic own = bodies.sphere.elastic;
    if (change.poisson_ratio > 0) own.poisson_ratio = change.poisson_ratio;
    auto of_other = law(bodies.other.elastic);
    if (change.shearing_plane) of_other.tangential.elastic = own;
    return bounce(bodies, before, dem::Materials{law(own), of_other}, settings);
  };
  const auto default_law = [&](const dem::Elastic& elastic) {
    return dem::Law{hertz(elastic), dem::Mindlin{.elastic = elastic, .friction_angle = angle}};
  };
  const auto published_law = [&](const dem::Elastic& elastic) {
    return dem::chung_ooi_law(
        {.elastic = elastic, .restitution = bodies.restitution, .friction_angle = angle});
  };
  const auto sum_limited_law = [&](const dem::Elastic& elastic) {
    return dem::Law{hertz(elastic),
                    SumLimitedMindlin{.elastic = elastic, .friction = bodies.friction}};
  };
  const auto partial_slip_law = [&](const dem::Elastic& elastic) {
    return dem::Law{hertz(elastic),
                    dem::MindlinDeresiewicz{.elastic = elastic, .friction_angle = angle}};
  };
  if (form == ImpactForm::by_default) return run(default_law, {});
  if (form == ImpactForm::partial_slip) return run(partial_slip_law, {});
  if (change.limited_sum) return run(sum_limited_law, dem::chung_ooi_settings);
  return run(published_law, dem::chung_ooi_settings);
}

/// Test 7: two equal spheres with equal and opposite spins meet, without slip.
inline ObliqueMotion meet(double given_spin, ImpactForm form) {
  const dem::Elastic alloy{.young_modulus = 70e9, .poisson_ratio = 0.33};
  const ObliqueBody sphere{.R = 0.1, .density = 2700, .elastic = alloy};
  return bounce({"equal spheres", sphere, sphere, 0.5, 0.4},
                {.v = 0, .v_n = 0.4, .spin = given_spin, .spin_of_other = -given_spin}, form);
}

}  // namespace silt::test
