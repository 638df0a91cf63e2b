// SPDX-License-Identifier: MIT
// The beam between two bonded grains, [PotyondyCundall2004] section 2.2: cement that carries
// tension, shear, bending and, in 3D, twisting, until it breaks. Pure functions of one bond.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace silt::dem {

/// Stiffnesses are those of springs spread over the cross-section, per area; a beam of the modulus
/// E and the shear modulus G between centres that are L apart has k̄_n = E/L and k̄_s = G/L.
struct ParallelBond {
  double normal_stiffness = 0;   ///< k̄_n [N/m³], above 0
  double tangential_stiffness = 0;  ///< k̄_s [N/m³]
  double radius_share = 1;       ///< λ̄: the beam's radius R̄ over the smaller grain's [-], above 0
  double beta = 0;               ///< dashpot over spring c/k, of all four springs [s]
  double tensile_strength = std::numeric_limits<double>::infinity();  ///< σ̄_c [Pa], above 0
  double shear_strength = std::numeric_limits<double>::infinity();    ///< τ̄_c [Pa], above 0

  /// Throws if a parameter is out of range.
  void check() const {
    require_positive("ParallelBond: normal_stiffness", normal_stiffness);
    require_not_negative("ParallelBond: tangential_stiffness", tangential_stiffness);
    require_positive("ParallelBond: radius_share", radius_share);
    require_not_negative("ParallelBond: beta", beta);
    const auto require_strength = [](const char* name, double strength) {
      if (!(strength > 0)) {  // infinity is one
        fail(std::string(name) + " = " + to_text(strength) +
             " must be positive; leave it out for a bond that does not break this way");
      }
    };
    require_strength("ParallelBond: tensile_strength", tensile_strength);
    require_strength("ParallelBond: shear_strength", shear_strength);
  }
};

/// Cross-section of a beam: a strip of unit thickness in 2D, a disc in 3D.
struct BeamSection {
  double radius;         ///< R̄ [m]
  double area;           ///< A [m²]
  double bending;        ///< second moment I [m⁴]
  double twisting;       ///< polar moment J [m⁴]; 0 in 2D
};

template <int Dim>
BeamSection section_of(const ParallelBond& law, double smaller_radius) {
  const double R = law.radius_share * smaller_radius;
  if constexpr (Dim == 2) {
    return {.radius = R, .area = 2 * R, .bending = R * R * R * 2 / 3, .twisting = 0};
  } else {
    const double I = std::numbers::pi * R * R * R * R / 4;
    return {.radius = R, .area = std::numbers::pi * R * R, .bending = I, .twisting = 2 * I};
  }
}

/// Its four springs.
struct BeamSprings {
  double normal;    ///< k̄_n A [N/m]
  double shear;     ///< k̄_s A [N/m]
  double bending;   ///< k̄_n I [N m]
  double twisting;  ///< k̄_s J [N m]

  Stiffness stiffness(double beta) const {
    const double rolling = std::max(bending, twisting);
    return {.normal = normal, .tangential = shear, .beta = beta, .rolling = rolling,
            .rolling_dashpot = beta * rolling};
  }
};
inline BeamSprings springs_of(const ParallelBond& law, const BeamSection& section) {
  return {.normal = law.normal_stiffness * section.area,
          .shear = law.tangential_stiffness * section.area,
          .bending = law.normal_stiffness * section.bending,
          .twisting = law.tangential_stiffness * section.twisting};
}

/// A bond between the grains a < b: what it remembers, and what it did in the last step, to a; on b
/// acts the opposite force and couple.
template <int Dim, class RealType>
struct Bond {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;

  Id a = 0;
  Id b = 0;
  Real rest_length = 0;            ///< distance of the centres when bonded [m]
  Real length = 0;                 ///< distance of the centres in the last step [m]
  Vec normal = Vec::Zero();        ///< from b to a, of the last step
  Vec shear = Vec::Zero();         ///< how far a's side was shifted along the section [m]
  AngularVec turn = zero_of<AngularVec>();     ///< of a against b [rad]; along the normal it twists
  Vec force = Vec::Zero();         ///< [N]
  AngularVec couple = zero_of<AngularVec>();   ///< beside the moment of the force [N m]
  std::uint64_t looks = 0;         ///< steps that it was part of
};

/// The share of a spin, or of a couple, that twists: along the normal. None in the plane.
template <class Real>
Real twist_of(Real, const Vec<2, Real>&) {
  return 0;
}
template <class Real>
Vec<3, Real> twist_of(const Vec<3, Real>& spin, const Vec<3, Real>& normal) {
  return spin.dot(normal) * normal;
}

/// The smallest turn that takes one unit vector to another.
template <int Dim, class Real>
struct SmallestTurn {
  Vec<Dim, Real> from;
  Vec<Dim, Real> to;

  Vec<Dim, Real> operator()(const Vec<Dim, Real>& v) const {
    const Vec<Dim, Real> sum = from + to;
    return v - sum * (sum.dot(v) / (1 + from.dot(to))) + to * (2 * from.dot(v));
  }
  Real operator()(Real turn) const { return turn; }

  /// Its angle [rad], about its axis in 3D.
  AngularVec<Dim, Real> angle() const {
    const AngularVec<Dim, Real> sine = cross(from, to);
    const Real size = std::sqrt(squared_norm(sine));
    return size > 0 ? AngularVec<Dim, Real>(sine * (std::atan2(size, from.dot(to)) / size)) : sine;
  }
};

/// A vector turned by an angle, about its axis in 3D.
template <class Real>
Vec<2, Real> turned_by(Real angle, const Vec<2, Real>& v) {
  return Eigen::Rotation2D<Real>(angle) * v;
}
template <class Real>
Vec<3, Real> turned_by(const Vec<3, Real>& angle, const Vec<3, Real>& v) {
  const Real size = angle.norm();
  if (!(size > 0)) return v;
  return Eigen::AngleAxis<Real>(size, angle / size) * v;
}
/// In the plane, a turn stays what it is.
template <class Real>
Real turned_by(Real, Real turn) {
  return turn;
}

/// What the two grains did since the last step.
template <int Dim, class Real>
struct BondMotion {
  Vec<Dim, Real> between;  ///< centre of a from that of b [m]
  AngularVec<Dim, Real> turn_a;  ///< [rad]
  AngularVec<Dim, Real> turn_b;  ///< [rad]
  Real arm_a;              ///< of a's radius in the sum of both [-]: where between them the beam is
  Real time_step;          ///< that this took [s]; 0 if unknown yet
};

/// Stresses at the rim of the section, and what the springs hold.
struct BondState {
  double tensile_stress = 0;  ///< −F_n/A + |M_b| R̄/I, [PotyondyCundall2004] section 2.2 [Pa]
  double shear_stress = 0;    ///< |F_s|/A + |M_t| R̄/J [Pa]
  double elastic_energy = 0;  ///< [J]
};

template <int Dim, class Real>
BondState state_of(const Bond<Dim, Real>& bond, const BeamSection& section, const BeamSprings& k) {
  const double elongation = double(bond.length) - double(bond.rest_length);
  const double shear = double(bond.shear.norm());
  const auto twist = twist_of(bond.turn, bond.normal);
  const double twisted = std::sqrt(double(squared_norm(twist)));
  const double bent =
      std::sqrt(double(squared_norm(silt::AngularVec<Dim, Real>(bond.turn - twist))));
  const double twist_stress =
      section.twisting > 0 ? k.twisting * twisted * section.radius / section.twisting : 0;
  return {.tensile_stress = k.normal * elongation / section.area +
                            k.bending * bent * section.radius / section.bending,
          .shear_stress = k.shear * shear / section.area + twist_stress,
          .elastic_energy = (k.normal * squared(elongation) + k.shear * squared(shear) +
                             k.bending * squared(bent) + k.twisting * squared(twisted)) / 2};
}

/// Carries the bond's memory on by what the grains did, and makes its force and couple anew.
///
/// The normal spring is told by the distance, so that it keeps no error. The others are summed, of
/// angles: a turn of both grains and of the line between them is no strain, to round-off, however
/// large the step. The dashpots see the velocities of the half step before.
template <int Dim, class Real>
void carry_on(Bond<Dim, Real>& bond, const BondMotion<Dim, Real>& motion, const BeamSprings& k,
              double beta) {
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;
  const Real length = motion.between.norm();
  const Vec n = motion.between / length;
  Real stretched = 0;
  Vec slipped = Vec::Zero();
  AngularVec turned = zero_of<AngularVec>();
  if (bond.looks > 0) {
    // The section turns with its grains. Where that leaves the line, their sides slip.
    const AngularVec of_grains = motion.arm_a * motion.turn_a + (1 - motion.arm_a) * motion.turn_b;
    const SmallestTurn<Dim, Real> rest{turned_by(of_grains, bond.normal), n};
    stretched = length - bond.length;
    slipped = length * cross(rest.angle(), n);
    turned = motion.turn_a - motion.turn_b;
    bond.shear = rest(turned_by(of_grains, bond.shear)) + slipped;
    bond.shear -= bond.shear.dot(n) * n;
    bond.turn = rest(turned_by(of_grains, bond.turn));
    bond.turn += turned;
  }
  bond.normal = n;
  bond.length = length;
  ++bond.looks;
  const Real lag = motion.time_step > 0 ? Real(beta) / motion.time_step : Real(0);
  const AngularVec turn = bond.turn + lag * turned;
  const AngularVec twist = twist_of(turn, n);
  bond.force = Real(-k.normal) * (length - bond.rest_length + lag * stretched) * n -
               Real(k.shear) * Vec(bond.shear + lag * slipped);
  bond.couple = Real(-k.bending) * AngularVec(turn - twist) - Real(k.twisting) * twist;
}

}  // namespace silt::dem
