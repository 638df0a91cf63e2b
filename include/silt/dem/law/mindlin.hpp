// SPDX-License-Identifier: MIT
// Tangential component for use with Hertz: the no-slip spring of [Mindlin1949] with a dashpot and a
// slider.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/elastic.hpp>
#include <silt/dem/law/law_components.hpp>
#include <silt/dem/law/slider.hpp>

#include <cmath>

namespace silt::dem {

/// F_s changes by −k_t v_s Δt with k_t = 8 G* √(R* δ) [Mindlin1949], the stiffness for the contact
/// area of this step, and is limited to F_n tan φ_μ. When the area grows, F_s is kept; when it
/// shrinks, F_s is reduced in proportion to k_t [ThorntonCumminsCleary2013]. Otherwise a closed
/// path of loading and shearing would generate energy. The energy lost by this reduction is part of
/// the friction. The dashpot is c_t = c_n √(k_t/k_n), with Hertz that of Tsuji, and 0 while the
/// contact slides. Micro-slip at the rim before gross sliding (Mindlin and Deresiewicz 1953) is not
/// modelled.
///
/// With keeps_displacement, F_s = −k_t ξ, where ξ is the displacement of the spring, also while the
/// area grows. This is the form of the benchmarks of [ChungOoi2011] and of many codes; a contact
/// that is sheared and then compressed creates energy, which counts as negative friction.
struct Mindlin {
  Elastic elastic = {};
  FrictionAngle friction_angle = {};  ///< φ_μ [rad] in [0, π/2)
  bool keeps_displacement = false;    ///< not the force, while the area grows

  template <int Dim, class Real>
  struct History {
    Vec<Dim, Real> force = Vec<Dim, Real>::Zero();  ///< spring force on i [N]
    Real stiffness = 0;                             ///< k_t of the previous step [N/m]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("force", force);
      archive("stiffness", stiffness);
    }
  };

  void check() const {
    elastic.check("Mindlin");
    friction_angle.check("Mindlin: friction_angle");
  }

  template <class C, class M>
  TangentialForce<C> tangential_force(const C& contact, const NormalForce<C>& normal,
                                      M& history) const {
    using std::sqrt;
    using Real = typename C::Real;
    using Vec = typename C::Vec;
    const Real k = stiffness_of_area(contact, normal.contact_radius);
    const Slider<Real> slider{
        .stiffness = k,
        .dashpot = normal.beta * sqrt(normal.stiffness * k),
        .limit = larger(Real(0), Real(normal.spring * Real(friction_angle.tangent)))};
    const Vec v = contact.tangential_velocity();
    const Real ratio = k / history.stiffness;
    const Vec last = rotated_into_plane(history.force, contact.normal);
    const Vec moved = v * contact.time_step;
    const auto with_this_displacement = with_displacement(k, ratio, last);
    const auto with_this_force = with_stiffness(k, ratio, last, moved);
    Vec kept;
    for (int i = 0; i < C::dimension; ++i) {
      kept[i] =
          choose(keeps_displacement, with_this_displacement.force[i], with_this_force.force[i]);
    }
    const Real lost = choose(keeps_displacement, with_this_displacement.lost, with_this_force.lost);
    const auto result = slide(slider, kept, v, contact);
    history.force = result.spring;
    history.stiffness = k;
    return {.spring = result.spring, .dashpot = result.dashpot, .friction = lost + result.lost};
  }

  template <class C, class M>
  double elastic_energy(const C&, const M& history) const {
    return energy_of_spring(history.force, double(history.stiffness));
  }

  template <class C>
  Stiffness stiffness(const C& contact, Stiffness normal) const {
    using Real = typename C::Real;
    normal.tangential = double(stiffness_of_area(contact, Real(normal.contact_radius)));
    return normal;
  }

  /// 1/G* is the sum of both materials' (2 − ν)/G; the smaller friction angle; the displacement is
  /// kept if both materials keep it.
  static Mindlin mix(const Mindlin& a, const Mindlin& b) {
    return {.elastic = Elastic::mix(a.elastic, b.elastic),
            .friction_angle = FrictionAngle::mix(a.friction_angle, b.friction_angle),
            .keeps_displacement = a.keeps_displacement && b.keeps_displacement};
  }

 private:
  // k_t [N/m].
  template <class C>
  typename C::Real stiffness_of_area(const C& contact, typename C::Real given_radius) const {
    using Real = typename C::Real;
    return Real(8 * elastic.contact_shear_modulus()) * contact_radius_of(contact, given_radius);
  }
};

}  // namespace silt::dem
