// SPDX-License-Identifier: MIT
// The instruction sets of one program, and the one that it uses.
//
// Code that knows the width of registers is compiled once for each instruction set, see
// each_instruction_set.hpp, and chosen when it is called:
//
//   instruction set   registers   if the compiler's flags allow
//   sse2              16 bytes    x86-64
//   avx2              32 bytes    x86-64-v3, or less: then it is added
//   avx512            64 bytes    x86-64-v4, or less: then it is added
//   portable          16 bytes    no x86, or SILT_NO_INTRINSICS is defined
//
// A program uses the widest one of the processor, or that which the environment variable SILT_ISA
// names. Results have the same bits in all, see docs/design.md. SILT_NO_DISPATCH leaves only that
// of the flags. All files of a program must have the same flags.
#pragma once

#include <silt/core/error.hpp>

#include <cstdlib>
#include <string>
#include <string_view>

// The instruction set of the compiler's flags.
#if defined(SILT_NO_INTRINSICS) || !defined(__SSE2__)
#define SILT_ISA_OF_FLAGS portable
#define SILT_LEVEL_OF_FLAGS 0
#elif defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__)
#define SILT_ISA_OF_FLAGS avx512
#define SILT_LEVEL_OF_FLAGS 3
#elif defined(__AVX2__)
#define SILT_ISA_OF_FLAGS avx2
#define SILT_LEVEL_OF_FLAGS 2
#else
#define SILT_ISA_OF_FLAGS sse2
#define SILT_LEVEL_OF_FLAGS 1
#endif

#if defined(__x86_64__) && SILT_LEVEL_OF_FLAGS >= 1 && !defined(SILT_NO_DISPATCH)
#define SILT_ADDS_AVX2 (SILT_LEVEL_OF_FLAGS < 2)
#define SILT_ADDS_AVX512 (SILT_LEVEL_OF_FLAGS < 3)
#else
#define SILT_ADDS_AVX2 0
#define SILT_ADDS_AVX512 0
#endif

// SILT_FOR_PROCESSOR(Class<T>::function): a pointer to the function in the namespace of the
// instruction set that the program uses.
#if SILT_ADDS_AVX2
#define SILT_FOR_PROCESSOR(...)                                                      \
  ::silt::detail::for_processor(&SILT_ISA_OF_FLAGS::__VA_ARGS__, &avx2::__VA_ARGS__, \
                                &avx512::__VA_ARGS__)
#elif SILT_ADDS_AVX512
#define SILT_FOR_PROCESSOR(...)                                                                   \
  ::silt::detail::for_processor(&SILT_ISA_OF_FLAGS::__VA_ARGS__, &SILT_ISA_OF_FLAGS::__VA_ARGS__, \
                                &avx512::__VA_ARGS__)
#else
#define SILT_FOR_PROCESSOR(...) (&SILT_ISA_OF_FLAGS::__VA_ARGS__)
#endif
// The same for kernels that are not compiled for AVX-512 in addition, because no pack of theirs is
// wider than a register of AVX2.
#if SILT_ADDS_AVX2
#define SILT_FOR_PROCESSOR_UP_TO_AVX2(...)                                           \
  ::silt::detail::for_processor(&SILT_ISA_OF_FLAGS::__VA_ARGS__, &avx2::__VA_ARGS__, \
                                &avx2::__VA_ARGS__)
#else
#define SILT_FOR_PROCESSOR_UP_TO_AVX2(...) (&SILT_ISA_OF_FLAGS::__VA_ARGS__)
#endif

namespace silt {

/// From the narrowest to the widest.
enum class InstructionSet {
  portable,  ///< no intrinsics
  sse2,      ///< registers of 16 bytes
  avx2,      ///< of 32 bytes
  avx512     ///< of 64 bytes: AVX-512 F, VL, DQ and BW
};

/// That of the compiler's flags, which the program needs in any case.
inline constexpr InstructionSet instruction_set_of_flags = InstructionSet(SILT_LEVEL_OF_FLAGS);

namespace detail {

inline constexpr std::string_view instruction_set_names[] = {"portable", "sse2", "avx2", "avx512"};

#if SILT_ADDS_AVX512
// With all that each_instruction_set.hpp permits.
inline bool has_avx2() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
}
#endif
inline bool has_processor([[maybe_unused]] InstructionSet set) {
  if (set == instruction_set_of_flags) return true;
#if SILT_ADDS_AVX2
  if (set == InstructionSet::avx2) return has_avx2();
#endif
#if SILT_ADDS_AVX512
  if (set == InstructionSet::avx512) {
    return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  }
#endif
  return false;
}

// Not inlined: the loops that ask would contain it.
[[gnu::cold, gnu::noinline]] inline InstructionSet choose_instruction_set() {
  constexpr InstructionSet all[] = {InstructionSet::avx512, InstructionSet::avx2,
                                    InstructionSet::sse2, InstructionSet::portable};
  const auto name_of = [](InstructionSet set) { return instruction_set_names[int(set)]; };
#ifdef __wasm__
  const char* const wanted = nullptr;  // a page has no environment
#else
  const char* const wanted = std::getenv("SILT_ISA");
#endif
  if (wanted == nullptr || *wanted == '\0') {
    for (const InstructionSet set : all) {
      if (has_processor(set)) return set;
    }
    return instruction_set_of_flags;
  }
  std::string possible;
  for (const InstructionSet set : all) {
    if (!has_processor(set)) continue;
    if (name_of(set) == wanted) return set;
    possible += (possible.empty() ? "" : ", ") + std::string(name_of(set));
  }
  fail({"SILT_ISA: this program on this processor has no instruction set \"", std::string(wanted),
        "\"; it has ", possible});
}

// Not const, for tests.
inline InstructionSet& used_instruction_set() {
  static InstructionSet chosen = choose_instruction_set();
  return chosen;
}

}  // namespace detail

/// The one that this program uses, chosen at the first call. Throws if the environment variable
/// SILT_ISA names another than the program and the processor have.
inline InstructionSet instruction_set() { return detail::used_instruction_set(); }

namespace detail {
#if SILT_ADDS_AVX512
template <class Function>
Function* for_processor(Function* of_flags, Function* avx2, Function* avx512) {
  switch (instruction_set()) {
    case InstructionSet::avx512:
      return avx512;
    case InstructionSet::avx2:
      return avx2;
    default:
      return of_flags;
  }
}
#endif
}  // namespace detail

}  // namespace silt
