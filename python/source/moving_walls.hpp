// SPDX-License-Identifier: MIT
// Walls of flows that move and bodies that float in them, from the objects of the package. They are
// compiled in moving_walls.cpp.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include "any_openings.hpp"
#include "arrays.hpp"
#include <pybind11/pybind11.h>

#include <vector>

namespace silt::python {

namespace py = pybind11;

/// Of MovingFaces, pistons of openings, unless these are null, and FloatingBodies; empty if there
/// are none.
template <int Dim>
mps::AnyMovingWalls<Dim> moving_walls_of(const py::list& moving, const AnyOpenings<Dim>* openings,
                                         const py::list& bodies);

/// Those of the positions, an array of shape (n, Dim) [m], at which mps::remove_inside() leaves
/// fluid of this spacing [m].
template <int Dim>
py::array without_inside(const Doubles& positions, const Doubles& faces, double spacing);

/// Faces on the sides of a box [m], an array of shape (n, Dim, Dim).
template <int Dim>
py::array faces_of_box(const std::vector<double>& lower, const std::vector<double>& upper,
                       bool open_top);

/// Those of a disc or a sphere [m].
template <int Dim>
py::array faces_of_ball(const std::vector<double>& centre, double radius, double edge);

}  // namespace silt::python
