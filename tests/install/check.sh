#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   check.sh WAY SOURCE BUILD SCRATCH COMPILER OPENMP [OTHER_COMPILER]
#
# Builds and runs consumer/ against the library as its users get it.
#   WAY       prefix | build_tree | subdirectory | fetch_content | pkg_config, or
#             choices: what the user chooses when configuring, build type, OpenMP and -ffp-contract=off,
#             reaches the user's program and nothing else does
#   SOURCE    the library's source tree;  BUILD  its configured build tree
#   SCRATCH   a folder of this test's own
#   OPENMP    ON if COMPILER has OpenMP
#   OTHER_COMPILER  for choices: uses what the build tree's compiler installed
set -euo pipefail

way=$1 source=$2 build=$3 scratch=$4 compiler=$5 openmp=$6 other_compiler=${7:-$5}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rm -rf "$scratch"
mkdir -p "$scratch"
expected="one thread"
if [[ $openmp = ON ]]; then expected=OpenMP; fi

give_up() {
  echo "$*"
  exit 1
}

# Installs, and moves what was installed: it has to work wherever it lies.
install_and_move() {
  cmake --install "$build" --prefix "$scratch/first"
  mv "$scratch/first" "$scratch/prefix"
  diff -r "$source/include" "$scratch/prefix/include"
}

# configure_consumer [CMake options]: prints what CMake says and keeps it in said.txt.
configure_consumer() {
  rm -rf "$scratch/build"
  cmake -S "$here/consumer" -B "$scratch/build" -DCMAKE_CXX_COMPILER="$compiler" "$@" 2>&1 |
    tee "$scratch/said.txt"
}

# said NUMBER TEXT: the last configuration said so, that many times.
said() {
  local times
  times=$(grep -c -- "$2" "$scratch/said.txt") || true
  ((times == $1)) || give_up "expected $1 times '$2', found $times"
}

# compiled_with NUMBER FLAG: whether consumer is compiled with it.
compiled_with() {
  local times
  times=$(grep -c -e " $2" "$scratch/build/compile_commands.json") || true
  ((times == $1)) || give_up "expected $2 in $1 of the commands, found it in $times"
}

run_consumer() {
  local printed
  printed=$("$1")
  [[ $printed = "$2" ]] || give_up "expected a program with $2, found $printed"
}

consume() {
  configure_consumer -DCMAKE_BUILD_TYPE=Debug "$@"
  said 0 "CMake Warning"
  compiled_with 1 -ffp-contract=off
  cmake --build "$scratch/build"
  run_consumer "$scratch/build/consumer" "$expected"
}

# The options of each way of using the library by CMake, one a line.
ways_by_cmake=("-DWAY=package -DCMAKE_PREFIX_PATH=$scratch/prefix" "-DWAY=package -Dsilt_DIR=$build"
  "-DWAY=subdirectory -DSILT_SOURCE=$source" "-DWAY=fetch_content -DSILT_SOURCE=$source")

check_choices() {
  install_and_move
  if grep -rniE 'openmp|fopenmp' "$scratch"/prefix/share/{pkgconfig,cmake/silt/siltTargets*}; then
    give_up "what is installed has OpenMP of the compiler that installed it"
  fi

  local options line
  for line in "${ways_by_cmake[@]}"; do
    IFS=' ' read -ra options <<<"$line"
    echo "== $line"
    configure_consumer "${options[@]}"
    said 1 "No build type is set"
    said 1 "cmake -DCMAKE_BUILD_TYPE=Release"
    compiled_with 0 -O
    grep -q '^CMAKE_BUILD_TYPE:STRING=$' "$scratch/build/CMakeCache.txt" ||
      give_up "the build type was set"
    configure_consumer "${options[@]}" -DCMAKE_CXX_FLAGS=-O2
    said 0 "CMake Warning"

    configure_consumer "${options[@]}" -DCMAKE_BUILD_TYPE=Release -DSILT_SAME_BITS=OFF
    said 0 "CMake Warning"
    compiled_with 0 -ffp-contract
    compiled_with 0 -march

    configure_consumer "${options[@]}" -DCMAKE_BUILD_TYPE=Release -DSILT_OPENMP=OFF
    said 0 OpenMP
    compiled_with 0 -fopenmp

    configure_consumer "${options[@]}" -DCMAKE_BUILD_TYPE=Debug \
      -DCMAKE_CXX_COMPILER="$other_compiler" -DCMAKE_DISABLE_FIND_PACKAGE_OpenMP=ON
    said 1 "OpenMP was not found"
    said 0 "CMake Warning"
    compiled_with 0 -fopenmp
    compiled_with 1 -ffp-contract=off
  done
  # The last of them is built.
  cmake --build "$scratch/build"
  run_consumer "$scratch/build/consumer" "one thread"
}

case $way in
  prefix)
    install_and_move
    consume -DWAY=package "-DCMAKE_PREFIX_PATH=$scratch/prefix"
    ;;
  build_tree)
    consume -DWAY=package "-DCMAKE_PREFIX_PATH=$build"
    configure_consumer -DCMAKE_BUILD_TYPE=Debug -DWAY=package "-Dsilt_DIR=$build"
    ;;
  subdirectory | fetch_content)
    consume "-DWAY=$way" "-DSILT_SOURCE=$source"
    # A guest builds nothing, installs nothing and tests nothing of its own.
    if find "$scratch/build" -name '*.o' | grep -v /consumer.dir/ | grep -v /CMakeFiles/3; then
      give_up "the library built something of its own"
    fi
    cmake --install "$scratch/build" --prefix "$scratch/prefix"
    [[ ! -e $scratch/prefix ]] || give_up "the library installed itself as a guest"
    ;;
  pkg_config)
    install_and_move
    export PKG_CONFIG_PATH=$scratch/prefix/share/pkgconfig
    read -ra flags <<<"$(pkg-config --cflags --libs silt)"
    [[ " ${flags[*]} " = *" -ffp-contract=off "* ]] || give_up "no -ffp-contract=off: ${flags[*]}"
    [[ ${flags[*]} != *openmp* ]] || give_up "OpenMP's flag is the user's: ${flags[*]}"
    "$compiler" -std=c++20 "$here/consumer/main.cpp" -o "$scratch/consumer" "${flags[@]}"
    run_consumer "$scratch/consumer" "one thread"
    if [[ $openmp = ON ]]; then
      "$compiler" -std=c++20 -fopenmp "$here/consumer/main.cpp" -o "$scratch/consumer" "${flags[@]}"
      run_consumer "$scratch/consumer" OpenMP
    fi
    without=$(pkg-config --define-variable=same_bits= --cflags silt)
    [[ $without != *contract* ]] || give_up "same_bits= leaves the flag: $without"
    ;;
  choices) check_choices ;;
  *)
    echo "unknown way $way"
    exit 2
    ;;
esac
