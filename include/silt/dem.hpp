// SPDX-License-Identifier: MIT
// Granular flow: all headers of a DEM program except those for reading and writing files.
#pragma once

#include <silt/core/forces.hpp>
#include <silt/core/lattice.hpp>
#include <silt/core/simulation.hpp>
#include <silt/dem/adhesion.hpp>
#include <silt/dem/bonds.hpp>
#include <silt/dem/contacts.hpp>
#include <silt/dem/coordination.hpp>
#include <silt/dem/cundall_strack.hpp>
#include <silt/dem/energy_ledger.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/hertz.hpp>
#include <silt/dem/inflow.hpp>
#include <silt/dem/law.hpp>
#include <silt/dem/linear_friction.hpp>
#include <silt/dem/linear_spring_dashpot.hpp>
#include <silt/dem/mindlin.hpp>
#include <silt/dem/outflow.hpp>
#include <silt/dem/packing.hpp>
#include <silt/dem/rolling_resistance.hpp>
#include <silt/dem/settling.hpp>
#include <silt/dem/stress.hpp>
#include <silt/dem/walton_braun.hpp>
#include <silt/integrate/leapfrog.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/level_grid.hpp>
#include <silt/search/neighbour_list.hpp>
#include <silt/search/uniform_grid.hpp>
