// SPDX-License-Identifier: MIT
#include "bench_definitions.hpp"

template class silt::test::Bench<3>;
