// SPDX-License-Identifier: MIT
// How many calls of a fuzz target's inputs succeeded, and how many threw silt::Error: a test that
// only ever sees one of the two checks little.
#pragma once

#include <cstdint>

namespace silt::fuzz {

inline std::uint64_t accepted = 0;
inline std::uint64_t refused = 0;

}  // namespace silt::fuzz
