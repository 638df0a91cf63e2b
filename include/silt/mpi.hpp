// SPDX-License-Identifier: MIT
// Simulations on several processes, see docs/many_machines.md. Flows need hypre in addition.
#pragma once

#include <silt/mpi/distribute.hpp>
#include <silt/mpi/world.hpp>
#include <silt/version.hpp>

#if __has_include(<HYPRE.h>)

#include <silt/mpi/shared_cell_cycle.hpp>
#include <silt/mps.hpp>

namespace silt::mpi {

/// The solver of mps::Flow, for unknowns that processes share.
template <int Dim>
using PressureSolver = ConjugateGradient<CellMultigrid<Dim, SharedCellCycle<Dim>>>;

/// mps::Flow for particles of distribute().
template <class Scheme, int Dim = 2, class Real = double>
using Flow = mps::Flow<Scheme, Dim, Real, PressureSolver<Dim>>;

}  // namespace silt::mpi

#endif
