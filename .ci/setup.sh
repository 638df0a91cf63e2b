# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Sourced by tests/run, examples/run, bench/run and docs/run, which set -euo pipefail: finds the
# repository, installs missing system packages, configures and builds. Nothing here prompts for input, and
# nothing is silent for more than ten seconds.

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cores=$(nproc 2>/dev/null || echo 2)

# The usage of the script: its comments that are indented by more than one space.
print_usage() { sed -n 's/^#  //p' "$0"; }

# [kB]; a guess if the system does not tell.
available_memory() {
  local available=""
  if [[ -r /proc/meminfo ]]; then
    available=$(sed -n 's/^MemAvailable: *\([0-9]*\) kB/\1/p' /proc/meminfo)
  fi
  echo "${available:-$((cores * 1500000))}"
}

# Number of simultaneous compilations: one per core, limited by the memory, at 1.5 GB each.
count_jobs() {
  local fit=$(($(available_memory) / 1500000))
  echo $((fit < 1 ? 1 : fit < cores ? fit : cores))
}
jobs=$(count_jobs)

# --- progress ------------------------------------------------------------------------------------

# COMMAND 2>&1 | report TEXT [last]: forwards the output of the command and, whenever it is silent
# for some time, prints TEXT and the elapsed time. With "last" the output is not forwarded; its last
# line is shown after TEXT. On a terminal, this is one line, updated every second.
report() {
  local text=$1 only_last=${2:-} pause=6 line="" part code wait last="" said=$SECONDS begin=$SECONDS
  # Ctrl-C ends the command; what it prints before it ends is still passed on.
  trap '' INT TERM
  if [[ -t 2 ]]; then pause=1; fi
  report_line() {
    local shown=${line:-$last}
    shown="$text: $((SECONDS - begin)) s  ${shown##*$'\r'}"
    if [[ -t 2 ]]; then printf '\r%s\e[K' "${shown:0:79}" >&2; else echo "${shown:0:120}" >&2; fi
    said=$SECONDS
  }
  if [[ -t 2 ]]; then report_line; else echo "$text …" >&2; fi
  while true; do
    code=0
    wait=$((said + pause - SECONDS))
    IFS= read -r -t $((wait > 0 ? wait : 1)) part || code=$?
    line+=$part
    if ((code > 128)); then  # silence
      report_line
      continue
    fi
    if [[ -n $only_last ]]; then
      if [[ -n $line ]]; then last=$line; fi
      if ((SECONDS - said >= pause)); then report_line; fi
    elif [[ -n $line ]] || ((code == 0)); then
      if [[ -t 2 ]]; then printf '\r\e[K' >&2; fi
      printf '%s\n' "$line"
      said=$SECONDS
    fi
    line=""
    if ((code != 0)); then break; fi
  done
  if [[ -t 2 ]]; then printf '\r\e[K' >&2; fi
  if [[ -n $only_last ]]; then echo "$text: took $((SECONDS - begin)) s" >&2; fi
}

# quietly TEXT FILE COMMAND...: runs the command with its output in FILE.
quietly() {
  local text=$1 file=$2
  shift 2
  mkdir -p "$(dirname "$file")"
  "$@" 2>&1 </dev/null | tee "$file" | report "$text" last
}

# logged TEXT FILE COMMAND...: like quietly, but prints the output to stderr if the command fails.
logged() { quietly "$@" || { cat "$2" >&2; return 1; }; }

# --- packages ------------------------------------------------------------------------------------

missing=()           # required packages that are missing (Debian's names)
optional=()          # optional packages that are missing,
optional_checks=()   # the commands that check for them,
optional_features=() # and what is skipped without them

# need COMMAND PACKAGE: requires a program on the path.
need() { command -v "$1" >/dev/null || missing+=("$2"); }

# Prints a Python interpreter that can import the given modules, if there is one.
python_with() {
  local python
  for python in python3 /usr/bin/python3; do
    if "$python" -c "import ${1:-sys}" >/dev/null 2>&1; then echo "$python"; return; fi
  done
  return 1
}

# need_python MODULE PACKAGE
need_python() { python_with "$1" >/dev/null || missing+=("$2"); }

# want CHECK PACKAGE FEATURE: an optional package; CHECK is a command that succeeds if it is installed,
# completely (dpkg -s also succeeds if the package was removed, but not its configuration: dpkg_has);
# FEATURE is skipped without it.
want() {
  if [[ " ${optional[*]} " = *" $2 "* ]] || eval "$1" >/dev/null 2>&1; then return; fi
  optional+=("$2")
  optional_checks+=("$1")
  optional_features+=("$3")
}

# has_header NAME: a check for want.
has_header() { echo "#include <$1>" | "${CXX:-c++}" -E -x c++ - >/dev/null 2>&1; }

# need_cmake_packages "NAME [VERSION]" PACKAGE ...: checks with CMake, all packages at once and, if
# that fails because one is broken, one by one. Without a toolchain, all count as missing.
need_cmake_packages() {
  local scratch i
  scratch=$(mktemp -d)
  if ! find_cmake_packages "$scratch" "$@"; then
    for ((i = 1; i < $#; i += 2)); do find_cmake_packages "$scratch" "${!i}" "" || true; done
  fi
  while (($#)); do
    [[ -e $scratch/found.${1%% *} ]] || missing+=("$2")
    shift 2
  done
  rm -rf "$scratch"
}
find_cmake_packages() {
  local scratch=$1
  shift
  rm -rf "$scratch/build"
  {
    echo 'cmake_minimum_required(VERSION 3.24)'
    echo 'project(probe LANGUAGES CXX)'
    while (($#)); do
      echo "find_package($1 QUIET NO_MODULE)"
      echo "if(${1%% *}_FOUND)"
      echo "  file(TOUCH \${CMAKE_SOURCE_DIR}/found.${1%% *})"
      echo 'endif()'
      shift 2
    done
  } >"$scratch/CMakeLists.txt"
  cmake -S "$scratch" -B "$scratch/build" >/dev/null 2>&1
}

# Requires the tools that every build needs, and that they work.
need_toolchain() {
  echo '#include <vector>' | "${CXX:-c++}" -fsyntax-only -x c++ - 2>/dev/null || missing+=(g++)
  cmake --version >/dev/null 2>&1 || missing+=(cmake)
  if ! command -v make >/dev/null; then
    if command -v ninja >/dev/null; then export CMAKE_GENERATOR=Ninja; else missing+=(make); fi
  fi
}

# Sets as_root to the prefix that runs a command as root without a password prompt; fails if there
# is none.
as_root=()
become_root() {
  as_root=()
  if [[ $(id -u) -eq 0 ]]; then return; fi
  as_root=(sudo -n)
  command -v sudo >/dev/null && sudo -n true 2>/dev/null
}

# apt_install ARGUMENT...: apt-get install, which waits while another program installs packages.
apt_install() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
    -o DPkg::Lock::Timeout=600 "$@"
}
# Prints those of the packages that can be installed.
installable() {
  local package
  for package in "$@"; do
    if apt_install --dry-run "$package" >/dev/null 2>&1; then echo "$package"; fi
  done
}

# install_packages PACKAGE...: installs them; if the list of packages is missing or stale, it is updated.
install_packages() {
  command -v apt-get >/dev/null || return 1
  local log=$repo/build/install.log
  if apt_install --dry-run "$@" >/dev/null 2>&1 </dev/null &&
    quietly "Installing packages" "$log" apt_install "$@"; then
    return
  fi
  logged "Updating the list of packages" "$repo/build/update.log" \
    wait_for_lock "${as_root[@]}" apt-get update &&
    logged "Installing packages" "$log" apt_install "$@"
}
# apt-get update does not wait for its lock by itself.
wait_for_lock() {
  local output tries
  for ((tries = 0; tries < 120; ++tries)); do
    if output=$(LC_ALL=C "$@" 2>&1); then echo "$output"; return; fi
    echo "$output"
    [[ $output = *"Could not get lock"* ]] || return 1
    sleep 5
  done
  return 1
}

# Installs the packages that the calls of need… and want above found missing. If that is not
# possible, prints the command to do so, and exits if a required package is missing.
install_missing() {
  local packages i
  mapfile -t packages < <(printf '%s\n' "${missing[@]}" "${optional[@]}" | sort -u | sed '/^$/d')
  ((${#packages[@]})) || return 0

  if become_root; then
    echo "Missing packages: ${packages[*]}" >&2
    if ! install_packages "${packages[@]}" && ((${#packages[@]} > 1)); then
      # One that cannot be installed must not keep the others away.
      local file=$repo/build/installable.txt
      quietly "Looking for those that can be installed" "$file" installable "${packages[@]}"
      mapfile -t packages <"$file"
      if ((${#packages[@]})); then install_packages "${packages[@]}" || true; fi
    fi
  fi
  hash -r
  local left=() feature
  local -A without=()
  for i in "${!optional[@]}"; do
    if ! eval "${optional_checks[i]}" >/dev/null 2>&1; then
      without[${optional_features[i]}]+=" ${optional[i]}"
      left+=("${optional[i]}")
    fi
  done
  for feature in "${!without[@]}"; do
    echo "silt: skipped without the packages${without[$feature]}: $feature" >&2
  done
  if ((${#missing[@]})) && ! dpkg_has "${missing[@]}"; then left+=("${missing[@]}"); fi
  if ((${#left[@]})); then print_install_command "${left[@]}"; fi
  if ((${#missing[@]})) && ! dpkg_has "${missing[@]}"; then
    echo "silt: then run this script again." >&2
    exit 1
  fi
  missing=() optional=() optional_checks=() optional_features=()
}

# dpkg_has PACKAGE...: succeeds if all are installed.
dpkg_has() {
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Status}\n' "$@" 2>/dev/null | grep -cx installed) || true
  [[ $installed = "$#" ]]
}

# What docs/run needs.
site_packages=(mkdocs-material python3-pybtex doxygen doxygen-awesome-css libjs-mathjax
  fonts-roboto-fontface)
want_site_packages() {
  local package
  for package in "${site_packages[@]}"; do want "dpkg_has $package" "$package" "the site"; done
}

# What docs/live/run needs; docs/run can do without.
live_packages=(clang-19 lld-19 libc++-19-dev-wasm32 libc++abi-19-dev-wasm32 libclang-rt-19-dev-wasm32
  wasi-libc libeigen3-dev)
want_live_packages() {
  local package
  for package in "${live_packages[@]}"; do want "dpkg_has $package" "$package" "the live page"; done
  want "command -v npm" npm "the live page"
}

# install_optional FEATURE PACKAGE...: installs what the calls of want found missing, unless
# SILT_DOCS_INSTALL=OFF; exits with 77 if one of these packages is missing then.
install_optional() {
  local package absent=()
  if [[ ${SILT_DOCS_INSTALL:-ON} = ON ]]; then install_missing; fi
  for package in "${@:2}"; do dpkg_has "$package" || absent+=("$package"); done
  if ((${#absent[@]})); then
    echo "silt: $1 is skipped without ${absent[*]}; install, and run this script again" >&2
    exit 77
  fi
}

print_install_command() {
  if ! command -v apt-get >/dev/null; then
    echo "silt: install these packages, named here as in Debian: $*" >&2
    return
  fi
  local command="apt-get update && apt-get install -y --no-install-recommends $*"
  if command -v sudo >/dev/null; then
    command="sudo apt-get update && sudo apt-get install -y --no-install-recommends $*"
  elif [[ $(id -u) -ne 0 ]]; then
    command="su -c '$command'"
  fi
  echo "silt: packages cannot be installed by this script. To install them, type" >&2
  echo "  $command" >&2
}

# --- building ------------------------------------------------------------------------------------

# configure FOLDER [CMake options]: configures build/FOLDER, and shows which packages are half there.
configure() {
  local folder=$1
  shift
  logged "Configuring build/$folder" "$repo/build/$folder.log" \
    cmake -S "$repo" -B "$repo/build/$folder" "$@"
  grep '^-- Silt: .* does not work' "$repo/build/$folder.log" >&2 || true
}

# build FOLDER TEXT [CMake build options]: compiles TEXT in build/FOLDER; shows each warning once.
build() {
  local folder=$1 text=$2 log=$repo/build/$1.build.log
  shift 2
  logged "Compiling $text" "$log" cmake --build "$repo/build/$folder" -j "$jobs" "$@"
  if grep -q 'warning:' "$log"; then
    grep 'warning:' "$log" | sort -u >&2
    echo "The whole output of the compiler is in $log" >&2
  fi
}

# --- showing -------------------------------------------------------------------------------------

# require_port NUMBER: exits if this port cannot be served.
require_port() {
  command -v python3 >/dev/null || return 0  # not installed yet
  python3 - "$1" <<'END' || exit 2
import socket, sys
try:
    with socket.socket() as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", int(sys.argv[1])))
except (OSError, OverflowError, ValueError) as error:
    why = getattr(error, "strerror", None) or "not a number from 1 to 65535"
    sys.exit(f"Cannot serve port {sys.argv[1]} ({why}); give another one with --port")
END
}

# serve TEXT FOLDER PORT: serves the folder to this machine only, until Ctrl-C.
serve() {
  need python3 python3
  install_missing
  echo "$1: http://localhost:$3 (Ctrl-C ends it)"
  exec python3 -m http.server "$3" --bind 127.0.0.1 --directory "$2"
}
