// SPDX-License-Identifier: MIT
// Functions of Python that a step calls.
#pragma once

#include "interpreter_lock.hpp"
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <utility>
#include <vector>

namespace silt::python {

namespace py = pybind11;

/// A function of Python from numbers to numbers. Its copies, which simulations make without the
/// lock, share it. What it raises is thrown as py::error_already_set.
class PythonFunction {
 public:
  explicit PythonFunction(py::object function)
      : function_(new py::object(std::move(function)),
                  [](const py::object* held) { with_lock([&] { delete held; }); }) {}

  std::vector<double> operator()(const std::vector<double>& arguments) const {
    return with_lock([&] {
      PyObject* const tuple = PyTuple_New(Py_ssize_t(arguments.size()));
      if (tuple == nullptr) throw py::error_already_set();
      for (std::size_t k = 0; k < arguments.size(); ++k) {
        PyTuple_SET_ITEM(tuple, Py_ssize_t(k), PyFloat_FromDouble(arguments[k]));
      }
      PyObject* const result = PyObject_CallObject(function_->ptr(), tuple);
      Py_DECREF(tuple);
      if (result == nullptr) throw py::error_already_set();
      return py::reinterpret_steal<py::object>(result).cast<std::vector<double>>();
    });
  }

 private:
  std::shared_ptr<const py::object> function_;
};

}  // namespace silt::python
