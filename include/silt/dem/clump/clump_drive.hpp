// SPDX-License-Identifier: MIT
// What moves a clump, apart from the forces on its spheres: a given velocity or spin, for walls of
// spheres that are at rest or move, or a force and a torque.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/rigid_body.hpp>

#include <array>

namespace silt::dem {

/// How a clump is driven. Without any of it, it moves freely.
template <int Dim>
struct ClumpDrive {
  /// Whether it keeps its velocity along an axis, whatever acts on it.
  std::array<bool, std::size_t(Dim)> keeps_velocity{};
  bool keeps_spin = false;                              ///< whatever torque acts on it
  Vec<Dim> force = Vec<Dim>::Zero();                    ///< on its centre of mass [N]
  AngularVec<Dim> torque = zero_of<AngularVec<Dim>>();  ///< [N m]

  /// Keeps its velocity and its spin.
  static ClumpDrive given_motion() {
    ClumpDrive drive{.keeps_spin = true};
    drive.keeps_velocity.fill(true);
    return drive;
  }
  /// Throws if force or torque are not finite.
  void check() const {
    require_finite("dem::ClumpDrive: force", force);
    require_finite("dem::ClumpDrive: torque", torque);
  }
};

namespace detail {

/// The drive of a clump, the spin that it keeps, and the load that was measured.
template <int Dim>
struct DriveOfClump {
  ClumpDrive<Dim> drive;
  bool is_any = false;
  AngularVec<Dim> spin = zero_of<AngularVec<Dim>>();  ///< [1/s]
  BodyLoad<Dim> load;

  template <class Archive>
  void transfer(Archive& archive) {
    archive("keeps_velocity", drive.keeps_velocity);
    archive("keeps_spin", drive.keeps_spin);
    archive("force", drive.force);
    archive("torque", drive.torque);
    archive("is_any", is_any);
    archive("spin", spin);
    archive("load_force", load.force);
    archive("load_torque", load.torque);
  }
};

}  // namespace detail

}  // namespace silt::dem
