// SPDX-License-Identifier: MIT
// Tangential component for use with Hertz: the contact of [MindlinDeresiewicz1953], whose rim slips
// before the whole contact slides.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/elastic.hpp>
#include <silt/dem/law/law_components.hpp>
#include <silt/dem/law/slider.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace silt::dem {

/// Partial slip by the method of dimensionality reduction [PopovHess2015]: the contact of radius
/// a = √(R* δ) is a row of springs at the distances x ≤ a from its centre. Those between x and
/// x + dx have together the stiffness 8 G* dx, carry the part F_n dS of the normal force, with
/// S = (3 x/a − x³/a³)/2, and slide at F_n tan φ_μ dS. Under Mindlin's assumptions this is exact
/// for any history of oblique loading, in which every spring sticks or slides for itself; a single
/// contact needs no cases of loading, unloading and reloading. Five to ten springs represent the
/// row: the spin after an impact of 11° differs by at most 0.6 % from that of many, of 3° by 2 %.
///
/// The dashpot is that of Mindlin, without the springs that slide. A spring that loses a part of
/// its area loses that part of its force, too.
struct MindlinDeresiewicz {
  Elastic elastic = {};
  FrictionAngle friction_angle = {};  ///< φ_μ [rad] in [0, π/2)

  /// Number of springs; even.
  static constexpr std::size_t springs = 10;

  template <int Dim, class Real>
  struct History {
    std::array<Vec<Dim, Real>, springs> force;  ///< on i, from the centre to the rim [N]
    Real spacing = 0;  ///< of the springs; all together reach to at least a [m]
    Real radius = 0;   ///< a of the previous step [m]
    Real energy = 0;   ///< stored by them [J]

    History() { force.fill(Vec<Dim, Real>::Zero()); }

    template <class Archive>
    void transfer(Archive& archive) {
      archive("force", force);
      archive("spacing", spacing);
      archive("radius", radius);
      archive("energy", energy);
    }
  };

  void check() const {
    elastic.check("MindlinDeresiewicz");
    friction_angle.check("MindlinDeresiewicz: friction_angle");
  }

  template <class C, class M>
  TangentialForce<C> tangential_force(const C& contact, const NormalForce<C>& normal,
                                      M& history) const {
    using std::sqrt;
    using Real = typename C::Real;
    using Vec = typename C::Vec;
    const Real a = contact_radius_of(contact, Real(normal.contact_radius));
    make_springs_reach(a, history);
    const Real divisor = larger(a, Real(std::numeric_limits<float>::min()));
    const Real per_length = Real(8 * elastic.contact_shear_modulus());
    const Real dashpot_per_length = normal.beta * sqrt(normal.stiffness * per_length * a) / divisor;
    const Real limit = larger(Real(0), Real(normal.spring * Real(friction_angle.tangent)));
    const Vec v = contact.tangential_velocity();
    TangentialForce<C> all;
    Vec before = Vec::Zero();
    Real energy = 0;
    Real share_inside = 0;
    for_each_spring([&](std::size_t s) {
      const Real inner = Real(double(s)) * history.spacing;
      const Real width = width_of(inner, a, history);
      const Real width_before = width_of(inner, history.radius, history);
      const Real shrinks_to = choose(width < width_before, width, Real(1)) /
                              choose(width < width_before, width_before, Real(1));
      const Vec last = rotated_into_plane(history.force[s], contact.normal);
      const Real share = share_within(Real((inner + width) / divisor));
      const Slider<Real> slider{.stiffness = per_length * width,
                                .dashpot = dashpot_per_length * width,
                                .limit = larger(Real(0), Real(share - share_inside)) * limit};
      const auto result = slide(slider, Vec(last * shrinks_to), v, contact);
      share_inside = larger(share, share_inside);
      before += last;
      all.spring += result.spring;
      all.dashpot += result.dashpot;
      energy += result.spring.squaredNorm() /
                larger(Real(2 * slider.stiffness), Real(std::numeric_limits<float>::min()));
      history.force[s] = result.spring;
    });
    // The work on the springs is that of the mean of the forces before and after.
    const Real work = -Real((before + all.spring).dot(v)) * contact.time_step / 2;
    all.friction = larger(Real(0), Real(history.energy + work - energy));
    history.radius = a;
    history.energy = energy;
    return all;
  }

  template <class C, class M>
  double elastic_energy(const C&, const M& history) const {
    return double(history.energy);
  }

  /// That of all springs, 8 G* a, as if none slid.
  template <class C>
  Stiffness stiffness(const C& contact, Stiffness normal) const {
    const double a = double(contact_radius_of(contact, typename C::Real(normal.contact_radius)));
    normal.tangential = 8 * elastic.contact_shear_modulus() * a;
    return normal;
  }

  /// 1/G* is the sum of both materials' (2 − ν)/G; the smaller friction angle.
  static MindlinDeresiewicz mix(const MindlinDeresiewicz& a, const MindlinDeresiewicz& b) {
    return {.elastic = Elastic::mix(a.elastic, b.elastic),
            .friction_angle = FrictionAngle::mix(a.friction_angle, b.friction_angle)};
  }

 private:
  // f(s) for each spring; without a loop, which would keep g++ from vectorising that over contacts.
  template <class F>
  static void for_each_spring(F&& f) {
    [&]<std::size_t... s>(std::index_sequence<s...>) {
      (f(s), ...);
    }(std::make_index_sequence<springs>());
  }

  // The part of the normal force within x, from ξ = x/a.
  template <class Real>
  static Real share_within(const Real& xi) {
    const Real within = smaller(xi, Real(1));
    return within * (3 - within * within) / 2;
  }

  // Of a spring that begins at `inner`, the width inside a contact of this radius [m].
  template <class Real, class M>
  static Real width_of(const Real& inner, const Real& radius, const M& history) {
    return larger(Real(0), smaller(Real(history.spacing), Real(radius - inner)));
  }

  // Doubles the spacing if the springs do not reach to the radius a: each then replaces two. If a
  // has more than doubled, one replaces all.
  template <class Real, class M>
  static void make_springs_reach(const Real& a, M& history) {
    const Real number = Real(double(springs));
    const Real extent = history.spacing * number;
    const bool is_short = extent < a;
    const bool is_far_too_short = 2 * extent < a;
    using Vec = typename decltype(history.force)::value_type;
    Vec sum = Vec::Zero();
    for_each_spring([&](std::size_t s) { sum += history.force[s]; });
    for_each_spring([&](std::size_t s) {
      Vec pair = Vec::Zero();
      if (2 * s + 1 < springs) pair = history.force[2 * s] + history.force[2 * s + 1];
      const Vec all = s == 0 ? sum : Vec(Vec::Zero());
      for (int k = 0; k < Vec::SizeAtCompileTime; ++k) {
        history.force[s][k] =
            choose(is_far_too_short, all[k], choose(is_short, pair[k], history.force[s][k]));
      }
    });
    history.spacing = choose(is_far_too_short, Real(a / number),
                             choose(is_short, Real(2 * history.spacing), Real(history.spacing)));
  }
};

}  // namespace silt::dem
