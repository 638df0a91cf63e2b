// SPDX-License-Identifier: MIT
// Free-surface flow: everything an MPS program needs except file input and output.
#pragma once

#include <silt/core/lattice.hpp>
#include <silt/core/simulation.hpp>
#include <silt/integrate/semi_implicit.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/policy/cone_surface.hpp>
#include <silt/mps/policy/higher_order_source.hpp>
#include <silt/mps/scheme/cases.hpp>
#include <silt/mps/scheme/recommended.hpp>
#include <silt/mps/setup/tank.hpp>
#include <silt/mps/step/flow.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/neighbour_list.hpp>
#include <silt/search/uniform_grid.hpp>
#include <silt/solve/cell_multigrid.hpp>
#include <silt/solve/conjugate_gradient.hpp>
#include <silt/version.hpp>

namespace silt::mps {

/// The default solver: the number of iterations does not grow with the number of particles.
template <int Dim>
using PressureSolver = ConjugateGradient<CellMultigrid<Dim>>;

/// The flow of a scheme, with the default pressure solver: mps::Flow<mps::Case10> in 2D.
template <class Scheme, int Dim = 2, class Real = double,
          LinearSolver Solver = PressureSolver<Dim>>
using Flow = BasicFlow<Scheme, Dim, Real, Solver>;

}  // namespace silt::mps
