// SPDX-License-Identifier: MIT
// Tangential component: the spring, dashpot and slider of Cundall and Strack (1979).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_components.hpp>
#include <silt/dem/law/slider.hpp>

#include <algorithm>

namespace silt::dem {

/// F_s^N = F_s^{N−1} − k_s v_s Δt, limited to F_n tan φ_μ + c, (10)–(13) of [SahChoi2004]; F_n is
/// the spring force of the normal component. The dashpot uses the β of the normal component,
/// c_s = β k_s (24), and is 0 while the contact slides. The spring force rotates with the contact
/// plane and keeps its magnitude.
struct LinearFriction {
  double tangential_stiffness = 0;    ///< k_s [N/m], above 0
  FrictionAngle friction_angle = {};  ///< φ_μ [rad] in [0, π/2)
  double cohesion = 0;                ///< c of (13): limit of the force without load [N]

  template <int Dim, class Real>
  struct History {
    Vec<Dim, Real> force = Vec<Dim, Real>::Zero();  ///< spring force on i [N]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("force", force);
    }
  };

  void check() const {
    check_magnitude("LinearFriction: tangential_stiffness", tangential_stiffness);
    friction_angle.check("LinearFriction: friction_angle");
    require_not_negative("LinearFriction: cohesion", cohesion);
  }

  template <class C, class M>
  TangentialForce<C> tangential_force(const C& contact, const NormalForce<C>& normal,
                                      M& history) const {
    using Real = typename C::Real;
    const Real k = Real(tangential_stiffness);
    const Slider<Real> slider{
        .stiffness = k,
        .dashpot = normal.beta * k,
        .limit =
            larger(Real(0), Real(normal.spring * Real(friction_angle.tangent) + Real(cohesion)))};
    const auto result = slide(slider, rotated_into_plane(history.force, contact.normal),
                              contact.tangential_velocity(), contact);
    history.force = result.spring;
    return {.spring = result.spring, .dashpot = result.dashpot, .friction = result.lost};
  }

  template <class C, class M>
  double elastic_energy(const C&, const M& history) const {
    return energy_of_spring(history.force, tangential_stiffness);
  }

  template <class C>
  Stiffness stiffness(const C&, Stiffness normal) const {
    normal.tangential = tangential_stiffness;
    return normal;
  }

  /// Springs in series (equal stiffnesses are kept), the smaller friction angle and cohesion.
  static LinearFriction mix(const LinearFriction& a, const LinearFriction& b) {
    return {.tangential_stiffness = in_series(a.tangential_stiffness, b.tangential_stiffness),
            .friction_angle = FrictionAngle::mix(a.friction_angle, b.friction_angle),
            .cohesion = std::min(a.cohesion, b.cohesion)};
  }
};

}  // namespace silt::dem
