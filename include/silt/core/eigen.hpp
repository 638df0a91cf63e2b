// SPDX-License-Identifier: MIT
// Eigen's vectors and matrices, without the warnings that compilers give for Eigen's own code where
// its folder is not a system folder and the processor has AVX.
#pragma once

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-variable"
#if defined(__clang__)
#pragma GCC diagnostic ignored "-Wc99-extensions"
#endif
#endif
#include <Eigen/Core>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
