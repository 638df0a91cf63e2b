// SPDX-License-Identifier: MIT
// Eigen's vectors and matrices, without the warnings that compilers give for Eigen's own code where
// the processor has AVX: unused variables if Eigen's folder is not a system folder, and, of g++ 12,
// false alarms about the intrinsics of AVX-512.
#pragma once

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-variable"
#if defined(__clang__)
#pragma GCC diagnostic ignored "-Wc99-extensions"
#else
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#endif
#include <Eigen/Core>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
