#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   check.sh METHOD SOURCE BUILD SCRATCH COMPILER OPENMP [OTHER_COMPILER]
#
# Builds and runs consumer/ against the library, by one of the methods available to users.
#   METHOD    prefix | build_tree | subdirectory | fetch_content | pkg_config, or
#             choices: checks that the user's choices of build type, OpenMP and -ffp-contract=off,
#             and no others, are applied to the user's program, or
#             processes: a program on two processes, by prefix and by subdirectory
#   SOURCE    source tree of the library;  BUILD  its configured build tree
#   SCRATCH   a folder for this test
#   OPENMP    ON if COMPILER has OpenMP
#   OTHER_COMPILER  for choices: another compiler that uses the installed library
set -euo pipefail

method=$1 source=$2 build=$3 scratch=$4 compiler=$5 openmp=$6 other_compiler=${7:-$5}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rm -rf "$scratch"
mkdir -p "$scratch"
expected="one thread"
if [[ $openmp = ON ]]; then expected=OpenMP; fi

give_up() {
  echo "$*"
  exit 1
}

# Installs the library and moves the installed tree, which must be relocatable.
install_and_move() {
  cmake --install "$build" --prefix "$scratch/first"
  mv "$scratch/first" "$scratch/prefix"
  diff -r "$source/include" "$scratch/prefix/include"
}

# configure_consumer [CMake options]: prints CMake's output and keeps it in printed.txt.
configure_consumer() {
  rm -rf "$scratch/build"
  cmake -S "$here/consumer" -B "$scratch/build" -DCMAKE_CXX_COMPILER="$compiler" "$@" 2>&1 |
    tee "$scratch/printed.txt"
}

# expect_printed NUMBER TEXT: checks that the last configuration printed TEXT that many times.
expect_printed() {
  local times
  times=$(grep -c -- "$2" "$scratch/printed.txt") || true
  ((times == $1)) || give_up "expected $1 times '$2', found $times"
}

# compiled_with NUMBER FLAG: checks that so many of consumer's compile commands have FLAG.
compiled_with() {
  local times
  times=$(grep -c -e " $2" "$scratch/build/compile_commands.json") || true
  ((times == $1)) || give_up "expected $2 in $1 of the commands, found it in $times"
}

# run_consumer EXPECTED PROGRAM...
run_consumer() {
  local expected=$1 printed
  shift
  printed=$("$@")
  [[ $printed = "$expected" ]] || give_up "expected a program with $expected, found $printed"
}

consume() {
  configure_consumer -DCMAKE_BUILD_TYPE=Debug "$@"
  expect_printed 0 "CMake Warning"
  compiled_with 1 -ffp-contract=off
  cmake --build "$scratch/build"
  run_consumer "$expected" "$scratch/build/consumer"
}

# CMake options of each method of using the library with CMake.
cmake_methods=("-DMETHOD=package -DCMAKE_PREFIX_PATH=$scratch/prefix"
  "-DMETHOD=package -Dsilt_DIR=$build"
  "-DMETHOD=subdirectory -DSILT_SOURCE=$source" "-DMETHOD=fetch_content -DSILT_SOURCE=$source")

check_choices() {
  install_and_move
  if grep -rniE 'openmp|fopenmp' "$scratch"/prefix/share/{pkgconfig,cmake/silt/siltTargets*}; then
    give_up "the installed files contain OpenMP options of the compiler that installed them"
  fi

  local options line
  for line in "${cmake_methods[@]}"; do
    IFS=' ' read -ra options <<<"$line"
    echo "== $line"
    configure_consumer "${options[@]}"
    expect_printed 1 "No build type is set"
    expect_printed 1 "cmake -DCMAKE_BUILD_TYPE=Release"
    compiled_with 0 -O
    grep -q '^CMAKE_BUILD_TYPE:STRING=$' "$scratch/build/CMakeCache.txt" ||
      give_up "the build type was set"
    configure_consumer "${options[@]}" -DCMAKE_CXX_FLAGS=-O2
    expect_printed 0 "CMake Warning"

    configure_consumer "${options[@]}" -DCMAKE_BUILD_TYPE=Release -DSILT_SAME_BITS=OFF
    expect_printed 0 "CMake Warning"
    compiled_with 0 -ffp-contract
    compiled_with 0 -march

    configure_consumer "${options[@]}" -DCMAKE_BUILD_TYPE=Release -DSILT_OPENMP=OFF
    expect_printed 0 OpenMP
    compiled_with 0 -fopenmp

    configure_consumer "${options[@]}" -DCMAKE_BUILD_TYPE=Debug \
      -DCMAKE_CXX_COMPILER="$other_compiler" -DCMAKE_DISABLE_FIND_PACKAGE_OpenMP=ON
    expect_printed 1 "OpenMP was not found"
    expect_printed 0 "CMake Warning"
    compiled_with 0 -fopenmp
    compiled_with 1 -ffp-contract=off
  done
  # Only the last one is built.
  cmake --build "$scratch/build"
  run_consumer "one thread" "$scratch/build/consumer"
}

case $method in
  prefix)
    install_and_move
    consume -DMETHOD=package "-DCMAKE_PREFIX_PATH=$scratch/prefix"
    ;;
  build_tree)
    consume -DMETHOD=package "-DCMAKE_PREFIX_PATH=$build"
    configure_consumer -DCMAKE_BUILD_TYPE=Debug -DMETHOD=package "-Dsilt_DIR=$build"
    ;;
  subdirectory | fetch_content)
    consume "-DMETHOD=$method" "-DSILT_SOURCE=$source"
    # As a subproject, the library must not build, install or test anything.
    if find "$scratch/build" -name '*.o' | grep -vE '/consumer.dir/|/CMakeFiles/3|/silt_packages/'; then
      give_up "the library built something"
    fi
    cmake --install "$scratch/build" --prefix "$scratch/prefix"
    [[ ! -e $scratch/prefix ]] || give_up "the library installed itself as a subproject"
    ;;
  pkg_config)
    install_and_move
    export PKG_CONFIG_PATH=$scratch/prefix/share/pkgconfig
    read -ra flags <<<"$(pkg-config --cflags --libs silt)"
    [[ " ${flags[*]} " = *" -ffp-contract=off "* ]] || give_up "no -ffp-contract=off: ${flags[*]}"
    [[ ${flags[*]} != *openmp* ]] || give_up "unexpected OpenMP flag: ${flags[*]}"
    IFS=. read -r major minor patch <<<"$(pkg-config --modversion silt)"
    flags+=("-DVERSION_FOUND=$((major * 10000 + minor * 100 + patch))")
    "$compiler" -std=c++20 "$here/consumer/main.cpp" -o "$scratch/consumer" "${flags[@]}"
    run_consumer "one thread" "$scratch/consumer"
    if [[ $openmp = ON ]]; then
      "$compiler" -std=c++20 -fopenmp "$here/consumer/main.cpp" -o "$scratch/consumer" "${flags[@]}"
      run_consumer OpenMP "$scratch/consumer"
    fi
    without=$(pkg-config --define-variable=same_bits= --cflags silt)
    [[ $without != *contract* ]] || give_up "same_bits= leaves the flag: $without"
    ;;
  choices) check_choices ;;
  processes)
    install_and_move
    for line in "${cmake_methods[0]}" "${cmake_methods[2]}"; do
      IFS=' ' read -ra options <<<"$line"
      configure_consumer -DCMAKE_BUILD_TYPE=Debug -DPROCESSES=ON "${options[@]}"
      cmake --build "$scratch/build"
    done
    run_consumer "2 processes" mpirun -np 2 "$scratch/build/consumer"
    ;;
  *)
    echo "unknown method $method"
    exit 2
    ;;
esac
