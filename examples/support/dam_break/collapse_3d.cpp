// SPDX-License-Identifier: MIT
#include "collapse.hpp"

namespace dam_break {

template void collapse<3>(const Options&);

}  // namespace dam_break
