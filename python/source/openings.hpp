// SPDX-License-Identifier: MIT
// Openings of flows, from the objects of the package. They are compiled in openings.cpp.
#pragma once

#include "any_openings.hpp"
#include <pybind11/pybind11.h>

#include <memory>

namespace silt::python {

namespace py = pybind11;

/// Null if there are none. Throws if one is invalid. Spacing of the particles in [m].
template <int Dim>
std::shared_ptr<AnyOpenings<Dim>> openings_of(const py::list& openings, double spacing);

}  // namespace silt::python
