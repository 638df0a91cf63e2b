// SPDX-License-Identifier: MIT
// What is stored of each clump and of each of its spheres.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/orientation.hpp>

#include <cstdint>

namespace silt::dem {

namespace detail {

/// A sphere of a clump.
template <int Dim>
struct SphereOfClump {
  Id id = 0;                           ///< of the grain
  Vec<Dim> offset = Vec<Dim>::Zero();  ///< from the centre of mass, where the shape was given [m]

  template <class Archive>
  void transfer(Archive& archive) {
    archive("id", id);
    archive("offset", offset);
  }
};

/// What does not change of a clump.
template <int Dim>
struct ClumpConstants {
  Id name = 0;              ///< as in the field `clump`
  std::uint64_t first = 0;  ///< of its spheres
  std::uint64_t spheres = 0;
  double mass = 0;                                             ///< [kg]
  silt::Inertia<Dim> inertia = zero_of<silt::Inertia<Dim>>();  ///< [kg m²]
  silt::Inertia<Dim> inverse = zero_of<silt::Inertia<Dim>>();  ///< of it
  /// What the moment of inertia of its spheres lacks [kg m²].
  silt::Inertia<Dim> beyond_spheres = zero_of<silt::Inertia<Dim>>();

  template <class Archive>
  void transfer(Archive& archive) {
    archive("name", name);
    archive("first", first);
    archive("spheres", spheres);
    archive("mass", mass);
    archive("inertia", inertia);
    archive("inverse", inverse);
    archive("beyond_spheres", beyond_spheres);
  }
};

/// The motion of a clump, with velocity and angular momentum as the integrator stores them.
template <int Dim>
struct ClumpMotion {
  Vec<Dim> position = Vec<Dim>::Zero();                   ///< of the centre of mass [m]
  Orientation<Dim> orientation;                           ///< against how the shape was given
  Vec<Dim> velocity = Vec<Dim>::Zero();                   ///< [m/s]
  AngularVec<Dim> momentum = zero_of<AngularVec<Dim>>();  ///< angular, about the centre [kg m²/s]

  template <class Archive>
  void transfer(Archive& archive) {
    archive("position", position);
    if constexpr (Dim == 2) {
      archive("angle", orientation.angle);
    } else {
      archive("quaternion", orientation.quaternion);
    }
    archive("velocity", velocity);
    archive("angular_momentum", momentum);
  }
};

}  // namespace detail

}  // namespace silt::dem
