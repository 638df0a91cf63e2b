#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   check.sh WAY SOURCE BUILD SCRATCH COMPILER OPENMP
#
# Builds and runs consumer/ against the library as its users get it.
#   WAY       prefix | build_tree | subdirectory | fetch_content | pkg_config
#   SOURCE    the library's source tree;  BUILD  its configured build tree
#   SCRATCH   a folder of this test's own
#   OPENMP    ON or OFF, as the build tree was configured
set -euo pipefail

way=$1 source=$2 build=$3 scratch=$4 compiler=$5 openmp=$6
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rm -rf "$scratch"
mkdir -p "$scratch"

# Installs, and moves what was installed: it has to work wherever it lies.
install_and_move() {
  cmake --install "$build" --prefix "$scratch/first"
  mv "$scratch/first" "$scratch/prefix"
}

consume() {
  cmake -S "$here/consumer" -B "$scratch/build" -DCMAKE_CXX_COMPILER="$compiler" \
    -DCMAKE_BUILD_TYPE=Debug "$@"
  cmake --build "$scratch/build"
  "$scratch/build/consumer"
}

case $way in
  prefix)
    install_and_move
    consume -DWAY=package "-DCMAKE_PREFIX_PATH=$scratch/prefix"
    ;;
  build_tree)
    consume -DWAY=package "-DCMAKE_PREFIX_PATH=$build"
    rm -rf "$scratch/build"
    consume -DWAY=package "-Dsilt_DIR=$build"
    ;;
  subdirectory | fetch_content)
    consume "-DWAY=$way" "-DSILT_SOURCE=$source" "-DSILT_OPENMP=$openmp"
    # A guest builds nothing, installs nothing and tests nothing of its own.
    if find "$scratch/build" -name '*.o' | grep -v /consumer.dir/ | grep -v /CMakeFiles/3; then
      echo "the library built something of its own"
      exit 1
    fi
    cmake --install "$scratch/build" --prefix "$scratch/prefix"
    if [[ -e $scratch/prefix ]]; then
      echo "the library installed itself as a guest"
      exit 1
    fi
    ;;
  pkg_config)
    install_and_move
    export PKG_CONFIG_PATH=$scratch/prefix/share/pkgconfig
    read -ra flags <<<"$(pkg-config --cflags --libs silt)"
    "$compiler" -std=c++20 "$here/consumer/main.cpp" -o "$scratch/consumer" "${flags[@]}"
    "$scratch/consumer"
    ;;
  *)
    echo "unknown way $way"
    exit 2
    ;;
esac
