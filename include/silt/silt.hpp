// SPDX-License-Identifier: MIT
// Includes all of Silt: DEM and MPS.
#pragma once

#include <silt/dem.hpp>
#include <silt/mps.hpp>
