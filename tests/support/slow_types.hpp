// SPDX-License-Identifier: MIT
// The types of a typed test.
#pragma once

#include <gtest/gtest.h>

#include <type_traits>

#ifndef SILT_SLOW_TESTS
#define SILT_SLOW_TESTS 1
#endif

namespace silt::test {

/// With --all, all types; else the usual ones: those that users have, and whose code differs most.
template <class All, class Usual>
using AllOrUsual = std::conditional_t<SILT_SLOW_TESTS, All, Usual>;

}  // namespace silt::test
