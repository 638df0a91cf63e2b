# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Sourced by examples/run, examples/pictures and examples/paper_figures, after .ci/setup.sh:
# installs the packages that examples need, and builds them.

# exit_after_help ARGUMENT...: prints the usage and exits if an argument is -h or --help.
exit_after_help() {
  local argument
  for argument in "$@"; do
    if [[ $argument = -h || $argument = --help ]]; then
      print_usage
      exit
    fi
  done
}

# The text of an example and of the support headers that it includes.
text_of() {
  local source=$repo/examples/$1.cpp header
  cat "$source"
  sed -n 's/^#include "\(support\/[^"]*\)".*/\1/p' "$source" |
    while read -r header; do cat "$repo/examples/$header"; done
}

# Installs the packages that the includes of these examples need, and those requested before.
install_for() {
  local packages=("Eigen3 3.4" libeigen3-dev) name includes=""
  for name in "$@"; do includes+=$(text_of "$name" | grep '^#include'); done
  if [[ $includes = *"<CLI/"* ]]; then packages+=("CLI11 2.0" libcli11-dev); fi
  if [[ $includes = *"<nlohmann/"* ]]; then packages+=("nlohmann_json 3.9" nlohmann-json3-dev); fi
  if [[ $includes = *"<boost/"* ]]; then packages+=(Boost libboost-dev); fi
  need_toolchain
  need_cmake_packages "${packages[@]}"
  install_missing
}

# build_examples NAME...: builds them in parallel.
build_examples() {
  configure examples -DCMAKE_BUILD_TYPE=Release -DSILT_BUILD_EXAMPLES=ON \
    "-DSILT_EXAMPLES=$(IFS=';' && echo "$*")"
  build examples "$*"
}
