// SPDX-License-Identifier: MIT
// The tank of a flow.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/scheme/recommended.hpp>
#include <silt/mps/setup/tank.hpp>

#include "any_simulation.hpp"
#include "flow_setup.hpp"

#include <string>

namespace silt::python {

/// The tank and all other walls, without fluid. Throws if a length is out of range; `function` is
/// that to which it was given.
template <int Dim>
mps::TankOf<mps::Recommended, Dim> empty_tank_of(const std::string& function,
                                                 const FlowSetup<Dim>& setup) {
  const Vec<Dim> size = to_vector<Dim>(function + ": tank", setup.tank);
  mps::Tank<Dim> tank{.size = {.length = size[0], .height = size[Dim - 1]},
                      .spacing = setup.spacing,
                      .lid = setup.lid,
                      .on_escape = setup.on_escape};
  if constexpr (Dim == 3) tank.size.depth = size[1];
  auto made = mps::make_empty_tank<mps::Recommended, Dim>(tank);
  auto& faces = made.walls.template faces<Dim>();
  faces.insert(faces.end(), setup.walls.begin(), setup.walls.end());
  if constexpr (Dim == 2) {
    made.walls.moving_2d = setup.moving;
  } else {
    made.walls.moving_3d = setup.moving;
  }
  return made;
}

}  // namespace silt::python
