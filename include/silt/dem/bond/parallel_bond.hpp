// SPDX-License-Identifier: MIT
// The parallel bond, [PotyondyCundall2004] section 2.2: a cemented joint between two grains that
// transmits tension, shear, bending and, in 3D, twisting until it breaks. Pure functions of one
// bond.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace silt::dem {

/// The parallel bond of [PotyondyCundall2004], section 2.2. The stiffnesses are per unit area of
/// the cross-section: a beam with Young's modulus E and shear modulus G between centres at a
/// distance L has k̄_n = E/L and k̄_s = G/L.
struct ParallelBond {
  double normal_stiffness = 0;      ///< k̄_n [N/m³], above 0
  double tangential_stiffness = 0;  ///< k̄_s [N/m³]
  /// λ̄: radius R̄ of the bond over the smaller grain's [-], from 1e-6 to 1e6
  double radius_share = 1;
  double beta = 0;  ///< ratio of dashpot to spring c/k, for all four springs [s]
  double tensile_strength = std::numeric_limits<double>::infinity();  ///< σ̄_c [Pa], above 0
  double shear_strength = std::numeric_limits<double>::infinity();    ///< τ̄_c [Pa], above 0

  /// What checkpoints compare.
  std::vector<SetupPart> setup() const {
    const auto finite = [](double strength) { return is_finite(strength) ? strength : -1; };
    return {{"ParallelBond::normal_stiffness", {normal_stiffness}},
            {"ParallelBond::tangential_stiffness", {tangential_stiffness}},
            {"ParallelBond::radius_share", {radius_share}},
            {"ParallelBond::beta", {beta}},
            {"ParallelBond::tensile_strength", {finite(tensile_strength)}},
            {"ParallelBond::shear_strength", {finite(shear_strength)}}};
  }

  /// Throws if a parameter is out of range.
  void check() const {
    check_magnitude("ParallelBond: normal_stiffness", normal_stiffness);
    check_magnitude_or_zero("ParallelBond: tangential_stiffness", tangential_stiffness);
    // The second moments of the section have its fourth power.
    require_positive("ParallelBond: radius_share", radius_share);
    require_between("ParallelBond: radius_share", radius_share, {1e-6, 1e6});
    check_magnitude_or_zero("ParallelBond: beta", beta);
    const auto require_strength = [](const char* name, double strength) {
      if (!(strength > 0)) {  // may be infinite
        fail({name, " = ", strength,
              " must be positive; omit it for a bond that does not break in this mode"});
      }
    };
    require_strength("ParallelBond: tensile_strength", tensile_strength);
    require_strength("ParallelBond: shear_strength", shear_strength);
  }
};

/// Cross-section of a bond: a strip of unit thickness in 2D, a disc in 3D.
struct BeamSection {
  double radius;    ///< R̄ [m]
  double area;      ///< A [m²]
  double bending;   ///< second moment I [m⁴]
  double twisting;  ///< polar moment J [m⁴]; 0 in 2D
};

/// Section of a bond between grains of which the smaller one has this radius [m];
/// [PotyondyCundall2004] section 2.2.
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

/// The four springs of a bond.
struct BeamSprings {
  double normal;    ///< k̄_n A [N/m]
  double shear;     ///< k̄_s A [N/m]
  double bending;   ///< k̄_n I [N m]
  double twisting;  ///< k̄_s J [N m]

  /// Stiffness of the bond for the stability limit, with the β [s] of its dashpots.
  Stiffness stiffness(double beta) const {
    const double rolling = std::max(bending, twisting);
    return {.normal = normal,
            .tangential = shear,
            .beta = beta,
            .rolling = rolling,
            .rolling_dashpot = beta * rolling};
  }
};
/// Springs of a bond with this section; [PotyondyCundall2004] section 2.2.
inline BeamSprings springs_of(const ParallelBond& law, const BeamSection& section) {
  return {.normal = law.normal_stiffness * section.area,
          .shear = law.tangential_stiffness * section.area,
          .bending = law.normal_stiffness * section.bending,
          .twisting = law.tangential_stiffness * section.twisting};
}

/// A bond between the grains a < b, with its state and its load on a in the last step; the opposite
/// force and couple act on b.
template <int Dim, class RealType>
struct Bond {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;

  Id a = 0;
  Id b = 0;
  Real rest_length = 0;      ///< distance of the centres when bonded [m]
  Real length = 0;           ///< distance of the centres in the last step [m]
  Vec normal = Vec::Zero();  ///< unit vector from b to a in the last step [-]
  Vec shear = Vec::Zero();   ///< shear displacement of a's side of the section [m]
  AngularVec rotation = zero_of<AngularVec>();  ///< of a relative to b [rad]
  Vec force = Vec::Zero();                      ///< [N]
  AngularVec couple = zero_of<AngularVec>();    ///< in addition to the moment of the force [N m]
  std::uint64_t steps = 0;                      ///< number of steps since it was made

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("a", a);
    archive("b", b);
    archive("rest_length", rest_length);
    archive("length", length);
    archive("normal", normal);
    archive("shear", shear);
    archive("rotation", rotation);
    archive("force", force);
    archive("couple", couple);
    archive("steps", steps);
  }
};

/// Maximum stresses, at the rim of the section, and energy of the springs.
struct BondState {
  double tensile_stress = 0;  ///< −F_n/A + |M_b| R̄/I, [PotyondyCundall2004] section 2.2 [Pa]
  double shear_stress = 0;    ///< |F_s|/A + |M_t| R̄/J [Pa]
  double elastic_energy = 0;  ///< [J]
};

namespace detail {

/// The twisting part of a rotation or couple: its component along the normal. 0 in 2D.
template <class Real>
Real twist_of(Real, const Vec<2, Real>&) {
  return 0;
}
template <class Real>
Vec<3, Real> twist_of(const Vec<3, Real>& spin, const Vec<3, Real>& normal) {
  return spin.dot(normal) * normal;
}

/// The smallest rotation that maps one unit vector to another.
template <int Dim, class Real>
struct SmallestRotation {
  Vec<Dim, Real> from;
  Vec<Dim, Real> to;

  Vec<Dim, Real> operator()(const Vec<Dim, Real>& v) const {
    const Vec<Dim, Real> sum = from + to;
    return v - sum * (sum.dot(v) / (1 + from.dot(to))) + to * (2 * from.dot(v));
  }
  Real operator()(Real rotation) const { return rotation; }

  /// Its angle [rad]; in 3D times the unit vector of the axis.
  AngularVec<Dim, Real> angle() const {
    const AngularVec<Dim, Real> sine = cross(from, to);
    const Real size = std::sqrt(squared_norm(sine));
    return size > 0 ? AngularVec<Dim, Real>(sine * (std::atan2(size, from.dot(to)) / size)) : sine;
  }
};

/// A vector rotated by an angle [rad]; in 3D the angle times the unit vector of the axis.
template <class Real>
Vec<2, Real> rotated_by(Real angle, const Vec<2, Real>& v) {
  return multiply(rotation_by(angle), v);
}
template <class Real>
Vec<3, Real> rotated_by(const Vec<3, Real>& angle, const Vec<3, Real>& v) {
  const Real size = angle.norm();
  if (!(size > 0)) return v;
  return multiply(rotation_about(Vec<3, Real>(angle / size), size), v);
}
/// In 2D rotations commute: nothing to do.
template <class Real>
Real rotated_by(Real, Real rotation) {
  return rotation;
}

/// Motion of the two grains since the last step.
template <int Dim, class Real>
struct BondMotion {
  Vec<Dim, Real> between;            ///< x_a − x_b [m]
  AngularVec<Dim, Real> rotation_a;  ///< [rad]
  AngularVec<Dim, Real> rotation_b;  ///< [rad]
  Real arm_a;                        ///< R_a/(R_a + R_b) [-]: position of the section
  Real time_step;                    ///< duration of the motion [s]; 0 if not yet known
};

template <int Dim, class Real>
BondState state_of(const Bond<Dim, Real>& bond, const BeamSection& section, const BeamSprings& k) {
  const double elongation = double(bond.length) - double(bond.rest_length);
  const double shear = double(bond.shear.norm());
  const auto twist = twist_of(bond.rotation, bond.normal);
  const double twisted = std::sqrt(double(squared_norm(twist)));
  const double bent =
      std::sqrt(double(squared_norm(silt::AngularVec<Dim, Real>(bond.rotation - twist))));
  const double twist_stress =
      section.twisting > 0 ? k.twisting * twisted * section.radius / section.twisting : 0;
  return {.tensile_stress = k.normal * elongation / section.area +
                            k.bending * bent * section.radius / section.bending,
          .shear_stress = k.shear * shear / section.area + twist_stress,
          .elastic_energy = (k.normal * squared(elongation) + k.shear * squared(shear) +
                             k.bending * squared(bent) + k.twisting * squared(twisted)) /
                            2};
}

/// Updates the state of a bond after the motion of its grains, and computes its force and couple.
///
/// The normal force follows from the distance, so that no error accumulates. The other deformations
/// are sums over finite rotations: a rigid rotation of the pair causes no strain, to
/// round-off, however large the step. The dashpots use the velocities of the previous half step.
template <int Dim, class Real>
void advance(Bond<Dim, Real>& bond, const BondMotion<Dim, Real>& motion, const BeamSprings& k,
             double beta) {
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;
  const Real length = motion.between.norm();
  const Vec n = motion.between / length;
  Real stretched = 0;
  Vec slipped = Vec::Zero();
  AngularVec rotated = zero_of<AngularVec>();
  if (bond.steps > 0) {
    // The section rotates with its grains; the rotation of the line between the centres relative to
    // it is shear.
    const AngularVec section_rotation =
        motion.arm_a * motion.rotation_a + (1 - motion.arm_a) * motion.rotation_b;
    const SmallestRotation<Dim, Real> remaining{rotated_by(section_rotation, bond.normal), n};
    stretched = length - bond.length;
    slipped = length * cross(remaining.angle(), n);
    rotated = motion.rotation_a - motion.rotation_b;
    bond.shear = remaining(rotated_by(section_rotation, bond.shear)) + slipped;
    bond.shear -= bond.shear.dot(n) * n;
    bond.rotation = remaining(rotated_by(section_rotation, bond.rotation));
    bond.rotation += rotated;
  }
  bond.normal = n;
  bond.length = length;
  ++bond.steps;
  const Real lag = motion.time_step > 0 ? Real(beta) / motion.time_step : Real(0);
  const AngularVec rotation = bond.rotation + lag * rotated;
  const AngularVec twist = twist_of(rotation, n);
  bond.force = Real(-k.normal) * (length - bond.rest_length + lag * stretched) * n -
               Real(k.shear) * Vec(bond.shear + lag * slipped);
  bond.couple = Real(-k.bending) * AngularVec(rotation - twist) - Real(k.twisting) * twist;
}

}  // namespace detail
}  // namespace silt::dem
