// SPDX-License-Identifier: MIT
// Includes the file SILT_KERNELS once for each instruction set of the program, see
// instruction_set.hpp. It has SILT_INSTRUCTION_SET, the name of its namespace, and SILT_LEVEL: 0
// without intrinsics, 1 with SSE2, 2 with AVX2, 3 with AVX-512. If SILT_KERNELS_UP_TO_AVX2 is
// defined, AVX-512 is not added: see SILT_FOR_PROCESSOR_UP_TO_AVX2.
//
// Not by the macros of the compiler, such as __AVX2__: g++ defines them only after it has read a
// file, and clang does not define them at all. A list of instruction sets rather than an
// architecture, because g++ then inlines functions that are not part of it. It is without FMA, and
// g++ is told not to use that of AVX-512; clang decides that where it reads an expression, see
// eigen.hpp.
//
// g++ vectorises these loops with -O3 only. It inlines no function whose other options, such as
// -fmath-errno, differ, and none with an option of its own into code without: therefore, the
// instruction set of the flags, of which other code calls functions, has the options of the flags.
#include <silt/core/instruction_set.hpp>

#ifdef SILT_KERNELS

#ifdef __clang__
#define SILT_END_OF_SET _Pragma("clang attribute pop")
#else
// Also warns that packs wider than a register are passed in memory; these functions are inlined.
#define SILT_END_OF_SET _Pragma("GCC pop_options")
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#define SILT_INSTRUCTION_SET SILT_ISA_OF_FLAGS
#define SILT_LEVEL SILT_LEVEL_OF_FLAGS
#include SILT_KERNELS
#undef SILT_INSTRUCTION_SET
#undef SILT_LEVEL

#if SILT_ADDS_AVX2
#define SILT_INSTRUCTION_SET avx2
#define SILT_LEVEL 2
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,bmi,bmi2,popcnt"))), \
                             apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2,popcnt")
#ifdef __OPTIMIZE__
#pragma GCC optimize("O3", "fp-contract=off")
#endif
#endif
#include SILT_KERNELS
SILT_END_OF_SET
#undef SILT_INSTRUCTION_SET
#undef SILT_LEVEL
#endif

#if SILT_ADDS_AVX512 && !defined(SILT_KERNELS_UP_TO_AVX2)
#define SILT_INSTRUCTION_SET avx512
#define SILT_LEVEL 3
#ifdef __clang__
#pragma clang attribute push(                                                                 \
    __attribute__((target("avx2,bmi,bmi2,popcnt,avx512f,avx512vl,avx512dq,avx512bw"))), \
    apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2,popcnt,avx512f,avx512vl,avx512dq,avx512bw")
#ifdef __OPTIMIZE__
#pragma GCC optimize("O3", "fp-contract=off")
#endif
#endif
#include SILT_KERNELS
SILT_END_OF_SET
#undef SILT_INSTRUCTION_SET
#undef SILT_LEVEL
#endif

#ifndef __clang__
#pragma GCC diagnostic pop
#endif
#undef SILT_END_OF_SET
#undef SILT_KERNELS_UP_TO_AVX2
#undef SILT_KERNELS
#endif
