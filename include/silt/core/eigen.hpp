// SPDX-License-Identifier: MIT
// Includes Eigen's vectors and matrices without compiler warnings about Eigen itself on processors
// with AVX: unused variables, if Eigen is not in a system directory, and false positives of g++ 12
// for the intrinsics of AVX-512.
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
