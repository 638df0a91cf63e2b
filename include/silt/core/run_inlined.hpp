// SPDX-License-Identifier: MIT
// Plain code compiled once for each instruction set: all that a function calls is inlined in it,
// and so is optimised for that. The numbers and vectors of a policy need not know of it.
//
// Included once for each instruction set, see each_instruction_set.hpp. Not for AVX-512, which has
// no more to offer to vectors of three numbers and packs of four, and would have to be compiled,
// too.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_CORE_RUN_INLINED
#define SILT_CORE_RUN_INLINED

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <type_traits>

#define SILT_KERNELS_UP_TO_AVX2
#define SILT_KERNELS <silt/core/run_inlined.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt {

/// f(values…), compiled for the instruction set that the program uses, with all that it calls. For
/// work of at least a tenth of a microsecond: a call takes several nanoseconds. Packs in it are
/// split into registers of the flags' set, see each_instruction_set.hpp; f must not return one.
template <class F, class... Values>
decltype(auto) run_inlined(F&& f, Values... values) {
  return SILT_FOR_PROCESSOR_UP_TO_AVX2(run_inlined<std::remove_reference_t<F>, Values...>)(
      f, values...);
}

/// f(), in 3D as run_inlined(); in 2D, what is near faces takes too little time to be compiled
/// twice.
template <int Dim, class F>
void run_in_space(F&& f) {
  if constexpr (Dim == 3) {
    run_inlined(f);
  } else {
    f();
  }
}

/// f(i) for every i in [0, n), in parallel, as run_inlined().
template <class F>
void for_each_inlined(Index n, F&& f) {
  for_each_range(n, [&f](Index first, Index last) {
    run_inlined(
        [&f](Index from, Index to) {
          for (Index i = from; i < to; ++i) f(i);
        },
        first, last);
  });
}

}  // namespace silt

#endif
#else

namespace silt::SILT_INSTRUCTION_SET {

#if SILT_LEVEL > SILT_LEVEL_OF_FLAGS
/// f(values…), with all that it calls.
template <class F, class... Values>
[[gnu::flatten, gnu::noinline]] decltype(auto) run_inlined(F& f, Values... values) {
  return f(values...);
}
#else
/// f(values…); what to inline in it is left to the compiler, as everywhere else. A loop around it
/// keeps its registers.
template <class F, class... Values>
[[gnu::noinline]] decltype(auto) run_inlined(F& f, Values... values) {
  return f(values...);
}
#endif

}  // namespace silt::SILT_INSTRUCTION_SET

#endif
