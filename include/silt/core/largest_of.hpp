// SPDX-License-Identifier: MIT
// The maximum of the values of a function over a range of indices.
//
// Included once for each instruction set, see each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_CORE_LARGEST_OF
#define SILT_CORE_LARGEST_OF

#include <silt/core/types.hpp>

#include <algorithm>

#define SILT_KERNELS <silt/core/largest_of.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {

/// The maximum of `initial` and all f(i) for i in [first, last).
template <class Value, class F>
[[gnu::flatten, gnu::noinline]] Value largest_of(Index first, Index last, Value initial, F& f) {
  Value maximum = initial;
  for (Index i = first; i < last; ++i) maximum = std::max<Value>(maximum, f(i));
  return maximum;
}

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
