// SPDX-License-Identifier: MIT
// Flows on several processes.
#pragma once

#include <silt/mpi/boomer_amg.hpp>
#include <silt/mps/flow.hpp>
#include <silt/mps/recommended.hpp>
#include <silt/solve/conjugate_gradient.hpp>

namespace silt::mpi {

/// mps::Flow for particles of distribute().
template <class Scheme = mps::Recommended, int Dim = 2, class Real = double>
using Flow = mps::BasicFlow<Scheme, Dim, Real, ConjugateGradient<BoomerAmg>>;

}  // namespace silt::mpi
