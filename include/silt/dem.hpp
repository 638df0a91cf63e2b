// SPDX-License-Identifier: MIT
// Granular flow: all headers of a DEM program except those for reading and writing files.
#pragma once

#include <silt/core/forces.hpp>
#include <silt/core/lattice.hpp>
#include <silt/core/simulation.hpp>
#include <silt/dem/bond/bonds.hpp>
#include <silt/dem/contact/chung_ooi.hpp>
#include <silt/dem/contact/contacts.hpp>
#include <silt/dem/law/adhesion.hpp>
#include <silt/dem/law/capillary_bridge.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/cundall_strack.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/jkr.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/mindlin_deresiewicz.hpp>
#include <silt/dem/law/plastic_cohesive.hpp>
#include <silt/dem/law/rolling_resistance.hpp>
#include <silt/dem/law/walton_braun.hpp>
#include <silt/dem/measure/coarse_grained.hpp>
#include <silt/dem/measure/coordination.hpp>
#include <silt/dem/measure/energy_ledger.hpp>
#include <silt/dem/measure/stress.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/setup/inflow.hpp>
#include <silt/dem/setup/packing.hpp>
#include <silt/dem/setup/settling.hpp>
#include <silt/integrate/leapfrog.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/level_grid.hpp>
#include <silt/search/neighbour_list.hpp>
#include <silt/search/uniform_grid.hpp>
#include <silt/version.hpp>
