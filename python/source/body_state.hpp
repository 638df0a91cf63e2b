// SPDX-License-Identifier: MIT
// The bodies of a flow, whose type mps::BodyInFlow is known to moving_walls.cpp alone.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <vector>

namespace silt::python {

/// State of one of the bodies, as BodyState of the package reads it: position [m], orientation,
/// velocity [m/s], spin [1/s], and the rotation, row by row, and shift [m] from where it is
/// defined.
template <int Dim>
std::vector<double> state_of_body(const std::vector<mps::BodyInFlow<Dim>>& bodies, Index body);

/// Where the centre of mass of one of the bodies is defined [m].
template <int Dim>
Vec<Dim> centre_of_body(const std::vector<mps::BodyInFlow<Dim>>& bodies, Index body);

}  // namespace silt::python
