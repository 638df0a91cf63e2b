// SPDX-License-Identifier: MIT
// The exact results that DEM is held against, by what they are about.
#pragma once

#include "support/reference_table.hpp"

namespace silt::test {

/// Each adds the rows of its items.
void impacts(ReferenceTable& table);
void bounces(ReferenceTable& table);
void friction(ReferenceTable& table);
void hertz(ReferenceTable& table);
void grains_at_rest(ReferenceTable& table);
void grains_in_flight(ReferenceTable& table);
void time_steps(ReferenceTable& table);

}  // namespace silt::test
