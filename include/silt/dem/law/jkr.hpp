// SPDX-License-Identifier: MIT
// Normal component: adhesive elastic spheres of Johnson, Kendall and Roberts (1971), whose contact
// is drawn out into a neck before it breaks.
#pragma once

#include <silt/core/cube_root.hpp>
#include <silt/core/lane.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/elastic.hpp>
#include <silt/dem/law/first_and_last_step.hpp>
#include <silt/dem/law/law_components.hpp>

#include <cmath>
#include <numbers>

namespace silt::dem {

/// With the work of adhesion w = 2 γ and the radius a of the contact area
/// [JohnsonKendallRoberts1971]
///
///   δ = a²/R* − √(2 π w a/E*)
///   F = 4 E* a³/(3 R*) − √(8 π w E* a³)
///
/// The contact begins at δ = 0, with −8/9 F_c, and ends at the gap 3 a_c²/R*, a_c³ = π w R*²/(8
/// E*), with −5/9 F_c, where F_c = 3/2 π w R* is the largest tension. The dashpot is Tsuji's, c = 2
/// √(5/6) ζ √(S m*) with S = 2 E* a. Friction and rolling resistance are limited by F + 2 F_c
/// [Thornton1991]. At a wall of several elements, such as a mesh, the neck ends where another
/// element becomes the nearest. For large, soft spheres; for small, stiff ones DmtAdhesion.
struct Jkr {
  Elastic elastic = {};
  double surface_energy = 0;     ///< γ [J/m²] of one surface, above 0
  Restitution restitution = {};  ///< e [-] in (0, 1] of the dashpot, without adhesion

  template <int, class Real>
  struct History {
    CentredDashpot::History<Real> dashpot{};  ///< its speed before
    StepsOfContact<Real> steps{};             ///< of the contact, up to two

    template <class Archive>
    void transfer(Archive& archive) {
      archive("dashpot", dashpot);
      archive("steps", steps);
    }
  };

  void check() const {
    elastic.check("Jkr");
    check_magnitude("Jkr: surface_energy", surface_energy);
    restitution.check("Jkr: restitution");
  }

  template <class C, class M>
  NormalForce<C> normal_force(const C& contact, M& history) const {
    using std::sqrt;
    using Real = typename C::Real;
    const Real R = contact.effective_radius;
    const Real pull_off = Real(1.5 * std::numbers::pi * work_of_adhesion()) * R;
    const Real a = contact_radius(contact);
    const Real force = Real(4.0 / 3 * elastic.contact_modulus()) * a * a * a / R -
                       Real(2 * elastic.contact_modulus() * attraction()) * a * sqrt(a);
    const auto shares = history.steps.next(contact, max_gap(R));
    const Real missing =
        (shares.of_beginning * Real(8.0 / 9) + shares.of_end * Real(5.0 / 9)) * pull_off;
    const Real S = Real(2 * elastic.contact_modulus()) * a;
    const Real c = dashpot(contact, S);
    return {.spring = force + 2 * pull_off,
            .dashpot = CentredDashpot::force(shares.contact, history.dashpot, S, c),
            .stiffness = S,
            .beta = c / S,
            .adhesion = missing - 2 * pull_off,
            .contact_radius = a};
  }

  /// Of the force F + 2 F_c, from the end of the contact on [J].
  template <class C, class M>
  double elastic_energy(const C& contact, const M&) const {
    const double R = double(contact.effective_radius);
    return energy_at(double(contact_radius(contact)), R) - energy_at(last_radius(R), R) +
           attraction_energy(contact);
  }
  /// Of the attraction −2 F_c, so that the sum of both is 0 at δ = 0; the work from there to the
  /// end is lost when the contact ends [J].
  template <class C, class M>
  double adhesion_energy(const C& contact, const M&) const {
    const double R = double(contact.effective_radius);
    const double a_0 = squared(cube_root(attraction() * R));
    return energy_at(last_radius(R), R) - energy_at(a_0, R) - attraction_energy(contact);
  }

  /// S, which exceeds dF/dδ.
  template <class C>
  Stiffness stiffness(const C& contact) const {
    using Real = typename C::Real;
    const Real a = contact_radius(contact);
    const Real S = Real(2 * elastic.contact_modulus()) * a;
    return {.normal = double(S),
            .beta = CentredDashpot::stability_factor * double(dashpot(contact, S)) / double(S),
            .contact_radius = double(a)};
  }

  /// 3 a_c²/R* [m].
  template <class Real>
  Real max_gap(const Real& effective_radius) const {
    const Real a_c = squared(root_of_smallest_radius(effective_radius));
    return 3 * a_c * a_c / effective_radius;
  }

  /// 1/E* is the sum of both materials' (1 − ν²)/E; γ = √(γ_a γ_b); the lower restitution.
  static Jkr mix(const Jkr& a, const Jkr& b) {
    return {.elastic = Elastic::mix(a.elastic, b.elastic),
            .surface_energy = std::sqrt(a.surface_energy * b.surface_energy),
            .restitution = Restitution::mix(a.restitution, b.restitution)};
  }

 private:
  double work_of_adhesion() const { return 2 * surface_energy; }
  // √(2 π w/E*) [m^½].
  double attraction() const {
    return std::sqrt(2 * std::numbers::pi * work_of_adhesion() / elastic.contact_modulus());
  }

  // a_c [m].
  double last_radius(double R) const { return squared(root_of_smallest_radius(R)); }
  // 2 F_c times the distance to the end of the contact [J].
  template <class C>
  double attraction_energy(const C& contact) const {
    const double R = double(contact.effective_radius);
    return 3 * std::numbers::pi * work_of_adhesion() * R * (double(contact.overlap) + max_gap(R));
  }

  // √a_c [m^½].
  template <class Real>
  Real root_of_smallest_radius(const Real& effective_radius) const {
    return cube_root(Real(Real(attraction() / 4) * effective_radius));
  }

  // The larger a with this δ, by Newton's method for b = √a: b⁴ − √(2 π w/E*) R* b − R* δ = 0.
  template <class C>
  typename C::Real contact_radius(const C& contact) const {
    using std::sqrt;
    using Real = typename C::Real;
    const Real R_delta = contact.effective_radius * contact.overlap;
    const Real factor = Real(attraction()) * contact.effective_radius;
    const Real least = root_of_smallest_radius(contact.effective_radius);
    // b from above: the parabola at the least b, which is exact near it, or the sum of the roots
    // without R* δ and without adhesion.
    const Real rise = larger(Real(0), Real(3 * squared(squared(least)) + R_delta));
    const Real parabola = least + sqrt(Real(rise / (6 * squared(least))));
    // ∛4 = 1.587…
    const Real sum = Real(1.5874010519681994) * least + sqrt(Real(sqrt(larger(Real(0), R_delta))));
    Real b = smaller(parabola, sum);
    SILT_UNROLLED
    for (int n = 0; n < 6; ++n) {
      const Real cube = b * b * b;
      // At the least b the derivative is 0 but for rounding errors.
      const Real slope = larger(Real(4 * cube - factor), Real(factor * Real(1e-6)));
      b = b - (b * cube - factor * b - R_delta) / slope;
    }
    b = larger(b, least);
    return b * b;
  }

  // c [N s/m].
  template <class C>
  typename C::Real dashpot(const C& contact, typename C::Real S) const {
    using std::sqrt;
    using Real = typename C::Real;
    return Real(2 * std::sqrt(5.0 / 6) * restitution.damping_ratio) *
           sqrt(S * contact.effective_mass);
  }

  // ∫ F dδ from a = 0 [J].
  double energy_at(double a, double R) const {
    const double k = attraction();
    const double E = elastic.contact_modulus();
    return E * squared(a) *
           (8.0 / 15 * a * squared(a) / squared(R) - 4.0 / 3 * k * a * std::sqrt(a) / R +
            squared(k) / 2);
  }
};

}  // namespace silt::dem
