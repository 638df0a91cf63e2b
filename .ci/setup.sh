# SPDX-License-Identifier: MIT
# Sourced by tests/run, examples/run and bench/run: finds the repository, installs what is missing
# from the system's packages, configures and builds.

# Threads that wait by spinning keep others off the cores: beside one more busy process, a program on
# all cores takes up to a hundred times as long. Sleeping costs little.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
jobs=$(nproc 2>/dev/null || echo 2)
missing=()  # Debian's names of the packages we lack

# need COMMAND PACKAGE: a program on the path.
need() { command -v "$1" >/dev/null || missing+=("$2"); }

# A Python that can import the given modules, if any can.
python_with() {
  local python
  for python in python3 /usr/bin/python3; do
    if "$python" -c "import ${1:-sys}" >/dev/null 2>&1; then echo "$python"; return; fi
  done
  return 1
}

# need_python MODULE PACKAGE
need_python() { python_with "$1" >/dev/null || missing+=("$2"); }

# need_cmake_package "NAME [VERSION]" PACKAGE ...: asks CMake itself, for all of them at once. What
# configures nothing (a toolchain still to be installed) lacks them all.
need_cmake_packages() {
  local scratch name
  scratch=$(mktemp -d)
  {
    echo 'cmake_minimum_required(VERSION 3.24)'
    echo 'project(probe LANGUAGES CXX)'
    local i
    for ((i = 1; i < $#; i += 2)); do
      name=${!i}
      echo "find_package($name QUIET NO_MODULE)"
      echo "if(${name%% *}_FOUND)"
      echo "  file(TOUCH \${CMAKE_BINARY_DIR}/found.${name%% *})"
      echo 'endif()'
    done
  } >"$scratch/CMakeLists.txt"
  cmake -S "$scratch" -B "$scratch/build" >/dev/null 2>&1 || true
  while (($#)); do
    [[ -e $scratch/build/found.${1%% *} ]] || missing+=("$2")
    shift 2
  done
  rm -rf "$scratch"
}

# What every build needs.
need_toolchain() {
  need "${CXX:-c++}" g++
  need cmake cmake
  if ! command -v make >/dev/null; then
    if command -v ninja >/dev/null; then export CMAKE_GENERATOR=Ninja; else missing+=(make); fi
  fi
}

# Installs packages by apt-get; what it said is in $install_log. Fails where it cannot.
install_log=
install_packages() {
  local as_root=()
  if [[ $(id -u) -ne 0 ]]; then as_root=(sudo); fi
  install_log="there is no apt-get here, or no way to be root"
  command -v apt-get >/dev/null && command -v "${as_root[0]:-apt-get}" >/dev/null || return 1
  echo "Installing $*"
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
    apt-get install -y --no-install-recommends "$@")
  install_log=$("${install[@]}" 2>&1 </dev/null) && return
  # A fresh machine has no list of packages, an old one a stale list.
  install_log+=$("${as_root[@]}" apt-get update 2>&1 </dev/null) || true
  install_log+=$("${install[@]}" 2>&1 </dev/null)
}

# Installs what the need… calls above found missing, or says what that is and gives up.
install_missing() {
  ((${#missing[@]})) || return 0
  if ! install_packages "${missing[@]}"; then
    echo "$install_log" >&2
    echo "silt: please install ${missing[*]} (Debian's names), which cannot be done from here." >&2
    exit 1
  fi
  missing=()
}

# want CHECK PACKAGE WHAT: installs a package that one can do without, or says what will be missing.
want() {
  if eval "$1" >/dev/null 2>&1 || install_packages "$2"; then return; fi
  echo "silt: $2 (Debian's name) cannot be installed from here: $3 is left out."
}

# has_header NAME: for want.
has_header() { echo "#include <$1>" | "${CXX:-c++}" -E -x c++ - >/dev/null 2>&1; }

# configure FOLDER [CMake options]: configures build/FOLDER with just the programs asked for.
configure() {
  local folder=$1
  shift
  mkdir -p "$repo/build"
  cmake -S "$repo" -B "$repo/build/$folder" "$@" >"$repo/build/$folder.log" 2>&1 ||
    { cat "$repo/build/$folder.log" >&2; return 1; }
}

# build FOLDER [CMake build options]
build() {
  local folder=$1
  shift
  cmake --build "$repo/build/$folder" -j "$jobs" "$@"
}
