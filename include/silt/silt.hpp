// SPDX-License-Identifier: MIT
// Both methods.
#pragma once

#include <silt/dem.hpp>
#include <silt/mps.hpp>
