// SPDX-License-Identifier: MIT
// Grains in a fluid that does not resolve them: DEM and MPS in one program.
#pragma once

#include <silt/coupled/coupled.hpp>
#include <silt/coupled/drag.hpp>
#include <silt/coupled/fluid_forces.hpp>
#include <silt/coupled/grains_in_fluid.hpp>
#include <silt/coupled/make_room.hpp>
#include <silt/coupled/observers.hpp>
#include <silt/dem.hpp>
#include <silt/mps.hpp>
#include <silt/mps/scheme/mixture.hpp>
