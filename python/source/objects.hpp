// SPDX-License-Identifier: MIT
// Attributes of objects of the package, which are numbers and tuples of numbers, and faces, which
// are arrays.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include "any_simulation.hpp"
#include "arrays.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <string>
#include <vector>

namespace silt::python {

namespace py = pybind11;

inline double number(const py::handle& object, const char* name) {
  return object.attr(name).cast<double>();
}
inline std::string type_of(const py::handle& object) {
  return py::type::of(object).attr("__name__").cast<std::string>();
}
template <int Dim>
Vec<Dim> vector(const py::handle& object, const char* name) {
  return to_vector<Dim>(type_of(object) + ": " + name,
                        object.attr(name).cast<std::vector<double>>());
}

/// Of an array of shape (n, 2, 2) or (n, 3, 3), which has been checked by the package. Throws if it
/// is of the other dimension; `name` is that of the argument.
template <int Dim>
std::vector<Face<Dim>> faces_from(const std::string& name, const Doubles& array) {
  if (array.shape(1) != Dim) {
    fail(name + " has the shape (n, " + std::to_string(array.shape(1)) + ", " +
         std::to_string(array.shape(2)) + "); in " + std::to_string(Dim) + "D give (n, " +
         std::to_string(Dim) + ", " + std::to_string(Dim) + ")");
  }
  std::vector<Face<Dim>> faces(Index(array.shape(0)));
  const double* number = array.data();
  for (Face<Dim>& face : faces) {
    for (Vec<Dim>& corner : face.corners) {
      for (double& coordinate : corner) coordinate = *number++;
    }
  }
  return faces;
}

}  // namespace silt::python
