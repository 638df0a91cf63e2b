// SPDX-License-Identifier: MIT
// A rigid body that floats in a flow, as a user describes it.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/rigid_body.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace silt::mps {

namespace detail {

// Not calls where they are used: g++ 12 fails in nested lists with default initialisers that call.
template <int Dim>
inline const Vec<Dim> no_velocity = Vec<Dim>::Zero();
template <int Dim>
inline const AngularVec<Dim> no_spin = zero_of<AngularVec<Dim>>();

}  // namespace detail

/// A rigid body whose surface is a wall of the flow. One given by a density is solid: fluid in it at the
/// beginning, or faces of other walls, are an error of the first step; see remove_inside(). One given by
/// mass_properties may be a hull: what is in it, such as a liquid cargo, moves with it and is no part of
/// its mass. (Moving faces, MovingFaces, may enclose fluid, too: a tank.)
template <int Dim>
struct FloatingBody {
  std::vector<Face<Dim>> faces = {};         ///< closed, all normals outwards or all inwards
  double density = 0;                        ///< [kg/m³], above 0; or give mass_properties
  std::optional<MassProperties<Dim>> mass_properties{};  ///< instead of the density
  Vec<Dim> velocity = detail::no_velocity<Dim>;  ///< of the centre of mass at first [m/s]
  AngularVec<Dim> spin = detail::no_spin<Dim>;  ///< at first [1/s]
  /// Along these axes it keeps its first velocity, whatever the load.
  std::array<bool, std::size_t(Dim)> is_held = {};
  bool keeps_orientation = false;  ///< it does not turn
  /// Of a disc or a sphere [m], about the centre of its volume: contacts are those of this shape,
  /// and the faces, such as those of faces_of_disc() or faces_of_sphere(), those of the fluid only.
  /// Begin a spacing l0 away from walls and other bodies; as it rolls, its speed is its spin times
  /// radius + l0/2. 0: contacts are those of its faces.
  double radius = 0;
  /// Coefficient of its friction on walls, and on other bodies, of which the smaller one counts
  /// [-].
  double friction = 0;
  /// Load of springs, moorings and the like, at a time [s]; none if empty. It must be a function of
  /// state and time only: after a restart, and on other processes, it is called again.
  std::function<BodyLoad<Dim>(const BodyState<Dim>&, double time)>
      load{};  // not = {}: g++ 12 fails then
};

}  // namespace silt::mps
