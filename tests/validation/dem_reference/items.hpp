// SPDX-License-Identifier: MIT
// The exact results for the verification of DEM, by subject.
#pragma once

#include "support/reference_table.hpp"

namespace silt::test {

/// Each function adds the rows of its items.
void impacts(ReferenceTable& table);
void bounces(ReferenceTable& table);
void friction(ReferenceTable& table);
void hertz(ReferenceTable& table);
void oblique_impacts(ReferenceTable& table);
void grains_at_rest(ReferenceTable& table);
void grains_in_flight(ReferenceTable& table);
void time_steps(ReferenceTable& table);

}  // namespace silt::test
