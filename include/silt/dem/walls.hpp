// SPDX-License-Identifier: MIT
// All wall types and wall motions.
#pragma once

#include <silt/dem/box_wall.hpp>
#include <silt/dem/mesh_wall.hpp>
#include <silt/dem/plane.hpp>
#include <silt/dem/polyline.hpp>
#include <silt/dem/round_walls.hpp>
#include <silt/dem/segment.hpp>
#include <silt/dem/wall.hpp>
#include <silt/dem/wall_motion.hpp>
#include <silt/dem/wall_set.hpp>
