// SPDX-License-Identifier: MIT
// What a flow is made from.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include "any_openings.hpp"
#include "any_simulation.hpp"

#include <memory>
#include <vector>

namespace silt::python {

/// A flow of mps::Recommended in a rectangular tank with a corner at the origin.
template <int Dim>
struct FlowSetup {
  Rows positions;            ///< [m]
  Rows velocities;           ///< [m/s]
  std::vector<double> tank;  ///< length[, depth] and height [m]
  bool lid = false;
  std::vector<Face<Dim>> walls;     ///< further ones at rest
  mps::AnyMovingWalls<Dim> moving;  ///< and those that move, with the bodies
  Index moving_count = 0;           ///< of them that are neither pistons of openings nor bodies
  std::shared_ptr<AnyOpenings<Dim>> openings;  ///< null: none; their pistons are among those
  OnEscape on_escape = OnEscape::refuse;
  double spacing = 0;                                  ///< [m]
  double density = 0;                                  ///< [kg/m³]
  double viscosity = 0;                                ///< kinematic [m²/s]
  double speed_scale = 0;                              ///< [m/s]
  Vec<Dim> gravity = -9.81 * Vec<Dim>::Unit(Dim - 1);  ///< [m/s²]

  FlowSetup without_fluid() const {
    FlowSetup rest = *this;
    rest.positions = rest.velocities = {};
    return rest;
  }
};

/// Water at rest in the tank of a flow, see mps::Pool.
template <int Dim>
struct PoolSetup {
  FlowSetup<Dim> flow;  ///< but for the fluid
  Vec<Dim> inside;      ///< [m]
  double level = 0;     ///< [m]
};

/// What mps::fill() made.
struct FilledPool {
  Rows positions;        ///< [m]
  double volume = 0;     ///< [m³], in 2D [m²]
  double deviation = 0;  ///< [-]
};

/// Compiled in filling.cpp. Throws if a number is out of range, or the pool is invalid.
template <int Dim>
FilledPool fill_pool(const PoolSetup<Dim>& setup);

/// Throws if a number is out of range, or a particle outside of the tank.
template <int Dim>
std::unique_ptr<AnySimulation> make_flow_simulation(const FlowSetup<Dim>& setup);

}  // namespace silt::python
