# SPDX-License-Identifier: MIT
# The packages of tests, examples, benchmarks and the Python package, see silt_find. Included by
# CMakeLists.txt.

silt_package(GTest TARGETS GTest::gtest_main HEADER gtest/gtest.h USES "testing::InitGoogleTest()"
  WITHOUT "The unit tests need it (Debian: libgtest-dev)")
silt_package(benchmark TARGETS benchmark::benchmark HEADER benchmark/benchmark.h USES "benchmark::Shutdown()"
  WITHOUT "The benchmarks need it (Debian: libbenchmark-dev)")
silt_package(nanoflann TARGETS nanoflann::nanoflann HEADER nanoflann.hpp
  USES "(void)sizeof(nanoflann::SearchParams)"
  WITHOUT "The comparison of searches with it is skipped (Debian: libnanoflann-dev)")
silt_package(CLI11 FIND 2.0 TARGETS CLI11::CLI11 HEADER CLI/CLI.hpp
  WITHOUT "The larger examples need it (Debian: libcli11-dev)")
silt_package(nlohmann_json FIND 3.9 TARGETS nlohmann_json::nlohmann_json HEADER nlohmann/json.hpp
  WITHOUT "The larger examples need it (Debian: nlohmann-json3-dev)")
silt_package(Boost FIND CONFIG TARGETS Boost::headers HEADER boost/units/systems/si.hpp
  WITHOUT "The example with units needs it (Debian: libboost-dev)")
silt_package(Python3 FIND COMPONENTS Interpreter TARGETS Python3::Interpreter
  WITHOUT "Tests, such as those of the pages, need it (Debian: python3)")

silt_package(Python FIND 3.10 COMPONENTS Interpreter Development.Module TARGETS Python::Module HEADER Python.h
  WITHOUT "The Python package needs it (Debian: python3-dev); or set -DSILT_BUILD_PYTHON=OFF")
silt_package(pybind11 FIND 2.10 CONFIG TARGETS pybind11::module HEADER pybind11/numpy.h NEEDS Python
  WITHOUT "The Python package needs it (Debian: pybind11-dev); or set -DSILT_BUILD_PYTHON=OFF")
