// SPDX-License-Identifier: MIT
// Flows on several processes.
#pragma once

#include <silt/mpi/cell_cycle.hpp>
#include <silt/mps/flow.hpp>
#include <silt/mps/recommended.hpp>
#include <silt/solve/cell_multigrid.hpp>
#include <silt/solve/conjugate_gradient.hpp>

namespace silt::mpi {

/// The solver of mps::Flow for unknowns that processes share.
template <int Dim>
using PressureSolver = ConjugateGradient<CellMultigrid<Dim, CellCycle<Dim>>>;

/// mps::Flow for particles of distribute().
template <class Scheme = mps::Recommended, int Dim = 2, class Real = double>
using Flow = mps::BasicFlow<Scheme, Dim, Real, PressureSolver<Dim>>;

}  // namespace silt::mpi
