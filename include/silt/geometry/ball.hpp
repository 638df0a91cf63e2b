// SPDX-License-Identifier: MIT
// A sphere, in 2D a disc.
#pragma once

#include <silt/core/types.hpp>

namespace silt {

/// A sphere, in 2D a disc.
template <int Dim, class Real = double>
struct Ball {
  Vec<Dim, Real> centre = Vec<Dim, Real>::Zero();  ///< [m]
  Real radius = 0;                                 ///< above 0 [m]
};

}  // namespace silt
