#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   check.sh SOURCE SCRATCH COMPILER
#
# Configures tests, examples and benchmarks with every optional package missing, broken or
# incomplete: the targets that need them are skipped, all others exist.
set -euo pipefail

source=$1 scratch=$2 compiler=$3
rm -rf "$scratch"
mkdir -p "$scratch/bin"
packages=(GTest benchmark CLI11 nlohmann_json Boost)
targets=(GTest::gtest_main benchmark::benchmark CLI11::CLI11 nlohmann_json::nlohmann_json Boost::headers)

give_up() {
  echo "$*"
  exit 1
}

# Open MPI's compiler wrapper without its headers, as some packages install it.
for name in mpicxx mpic++ mpiCC mpic++.openmpi mpicxx.openmpi; do
  cat >"$scratch/bin/$name" <<END
#!/bin/sh
case "\$*" in
  *-showme:compile*) echo "-I$scratch/nowhere -pthread" ;;
  *-showme:link*) echo "-pthread -lmpi_cxx -lmpi" ;;
  *-showme:incdirs*) echo "$scratch/nowhere" ;;
  *-show*) echo "$compiler -I$scratch/nowhere -pthread -lmpi_cxx -lmpi" ;;
  *) exec "$compiler" -I$scratch/nowhere "\$@" ;;
esac
END
  chmod +x "$scratch/bin/$name"
done
export PATH=$scratch/bin:$PATH
mkdir "$scratch/hypre"
touch "$scratch/hypre/HYPRE.h"
echo 'inline int HYPRE_GetError() { return 0; }' >"$scratch/hypre/HYPRE_utilities.h"
ar rc "$scratch/hypre/libHYPRE.a"

# configure_with NAME [CMake options]: checks that configuring succeeds, and that the programs that
# need only the library exist.
configure_with() {
  local build=$scratch/build_$1 package
  echo "== $1"
  shift
  cmake -S "$source" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DSILT_BUILD_TESTS=ON \
    -DSILT_BUILD_EXAMPLES=ON -DSILT_BUILD_BENCH=ON "-DSILT_HYPRE_INCLUDE=$scratch/hypre" \
    "-DSILT_HYPRE_LIBRARY=$scratch/hypre/libHYPRE.a" "$@" >"$build.txt" 2>&1 ||
    { cat "$build.txt"; give_up "the configuration failed"; }
  for package in "${packages[@]}"; do
    grep -q "^-- $package was not found or does not work" "$build.txt" ||
      { cat "$build.txt"; give_up "$package was not reported"; }
  done
  grep -q '^-- The benchmarks are skipped' "$build.txt" || give_up "the benchmarks were not reported"
  grep -q '^-- Example dam_break is skipped' "$build.txt" || give_up "an example was not reported"
  cmake --build "$build" --target help >"$build.targets.txt"
  grep -q quickstart_tower "$build.targets.txt" || give_up "quickstart_tower is skipped"
  if grep -E 'dam_break$|bench_|test_core|test_solve_hypre' "$build.targets.txt"; then
    give_up "there is a program whose packages are missing"
  fi
}

# Creates packages with these lines as their CMake file, in a folder that is searched first.
make_packages() {
  local i
  for i in "${!packages[@]}"; do
    mkdir -p "$scratch/$1/lib/cmake/${packages[i]}"
    echo "${2//TARGET/${targets[i]}}" \
      >"$scratch/$1/lib/cmake/${packages[i]}/${packages[i]}Config.cmake"
  done
}

missing=()
for package in "${packages[@]}"; do missing+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
configure_with missing "${missing[@]}"

make_packages broken 'message(FATAL_ERROR "a file of this package is missing")'
configure_with broken "-DCMAKE_PREFIX_PATH=$scratch/broken"

make_packages incomplete 'add_library(TARGET INTERFACE IMPORTED)
target_link_libraries(TARGET INTERFACE silt_has_no_such_library)'
configure_with incomplete "-DCMAKE_PREFIX_PATH=$scratch/incomplete"

# With GoogleTest, hypre is checked, and MPI is incomplete unless its headers are found elsewhere.
echo "== MPI without headers"
build=$scratch/build_mpi
cmake -S "$source" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DSILT_BUILD_TESTS=ON \
  "-DSILT_HYPRE_INCLUDE=$scratch/hypre" "-DSILT_HYPRE_LIBRARY=$scratch/hypre/libHYPRE.a" \
  >"$build.txt" 2>&1 || { cat "$build.txt"; give_up "the configuration failed"; }
grep -q '^SILT_MPI_WORKS:INTERNAL=TRUE' "$build/CMakeCache.txt" ||
  grep -q '^-- MPI was not found or does not work' "$build.txt" ||
  { cat "$build.txt"; give_up "MPI was neither used nor reported"; }

# If the Python package is asked for, what it lacks ends the configuration with its name.
for package in pybind11 Python; do
  echo "== the Python package without $package"
  build=$scratch/build_without_$package
  if cmake -S "$source" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DSILT_BUILD_PYTHON=ON \
    "-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON" >"$build.txt" 2>&1; then
    give_up "the configuration succeeded"
  fi
  # Without headers or NumPy the message is that about Python.
  grep -qE "Silt: the Python package needs (Python|$package)" "$build.txt" ||
    { cat "$build.txt"; give_up "what is missing was not named"; }
done
