// SPDX-License-Identifier: MIT
// Eigen's vectors and matrices, without the warnings that g++ gives for Eigen's code when Eigen is
// no system header and the processor has AVX.
#pragma once

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-variable"
#endif
#include <Eigen/Core>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
