// SPDX-License-Identifier: MIT
// Includes Eigen's vectors and matrices without compiler warnings about Eigen itself on processors
// with AVX: unused variables, if Eigen is not in a system directory, and false positives of g++ 12
// for the intrinsics of AVX-512.
//
// The first header of the library that a program reads.
#pragma once

// clang fuses a multiplication and an addition where it reads them unless it is told not to. In what
// it reads from here on, a user's law, too: it may be inlined for AVX-512, which has such an
// operation, see instruction_set.hpp. All other code of the program has none, and does not change.
#if defined(__clang__) && defined(__x86_64__) && !defined(__FMA__)
#pragma clang fp contract(off)
#endif

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
