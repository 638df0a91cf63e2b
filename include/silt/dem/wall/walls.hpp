// SPDX-License-Identifier: MIT
// All wall types and wall motions.
#pragma once

#include <silt/dem/wall/box_wall.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/dem/wall/mesh/periodic_copies.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/dem/wall/plane.hpp>
#include <silt/dem/wall/polyline.hpp>
#include <silt/dem/wall/round_walls.hpp>
#include <silt/dem/wall/surface_velocity.hpp>
#include <silt/dem/wall/wall.hpp>
#include <silt/dem/wall/wall_set.hpp>
