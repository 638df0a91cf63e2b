// SPDX-License-Identifier: MIT
// Arrays of NumPy from and to memory.
#pragma once

#include <silt/core/types.hpp>

#include "any_simulation.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cctype>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace silt::python {

namespace py = pybind11;

inline py::dtype dtype_of(const FieldInfo& field) {
  std::string name = field.number;
  for (char& letter : name) letter = char(std::tolower(static_cast<unsigned char>(letter)));
  return py::dtype(name);
}

// An array of this memory, which `owner` keeps.
inline py::array array_of(const ColumnMemory& memory, const py::handle& owner) {
  const py::dtype number = dtype_of(memory.field);
  std::vector<py::ssize_t> shape{py::ssize_t(memory.size)}, strides{memory.stride};
  if (memory.field.components > 0) {
    shape.push_back(memory.field.components);
    strides.push_back(number.itemsize());
  }
  return py::array(number, shape, strides, memory.first, owner);
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline Rows rows_of(const Doubles& array) {
  return {{array.data(), array.data() + array.size()}, Index(array.shape(1))};
}
inline std::vector<double> numbers_of(const Doubles& array) {
  return {array.data(), array.data() + array.size()};
}

inline py::dict dict_of(const std::vector<ColumnCopy>& columns) {
  py::dict all;
  for (const ColumnCopy& column : columns) {
    const py::dtype number = dtype_of(column.field);
    std::vector<py::ssize_t> shape{py::ssize_t(column.size)};
    if (column.field.components > 0) shape.push_back(column.field.components);
    py::array array(number, shape);
    if (!column.bytes.empty()) {
      std::memcpy(array.mutable_data(), column.bytes.data(), column.bytes.size());
    }
    all[py::str(column.field.name)] = std::move(array);
  }
  return all;
}

}  // namespace silt::python
