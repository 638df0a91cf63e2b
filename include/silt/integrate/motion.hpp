// SPDX-License-Identifier: MIT
// The equations of motion of the leapfrog in the form that suits the storage of the particles.
#pragma once

#include <silt/core/rows_of_four.hpp>
#include <silt/core/simd.hpp>
#include <silt/integrate/motion_in_columns.hpp>
#include <silt/integrate/motion_in_rows.hpp>

#include <type_traits>

namespace silt {

/// MotionInRows or MotionInColumns, whichever is faster for the storage of the particles P.
template <class P>
using MotionOf =
    std::conditional_t<in_rows_of_four<P>() && 4 * sizeof(typename P::Real) <= simd::width,
                       MotionInRows<P>, MotionInColumns<P>>;

}  // namespace silt
