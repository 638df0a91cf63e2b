// SPDX-License-Identifier: MIT
// A simulation on several processes, see docs/many_machines.md.
#pragma once

#include <silt/mpi/agreement.hpp>
#include <silt/mpi/cuts.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/shared_particles.hpp>
#include <silt/mpi/world.hpp>

#if __has_include(<HYPRE.h>)
#include <silt/mpi/flow.hpp>
#endif
