#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   precompile.sh FLAGS-FILE FOLDER COMPILER...
#
# Precompiles the umbrella headers into FOLDER, for the tests that compile short programs.
set -euo pipefail

flags=$1 folder=$2
shift 2
rm -rf "$folder"
mkdir -p "$folder/silt"
for header in silt dem mps; do
  "$@" "@$flags" -x c++-header -o "$folder/silt/$header.hpp.gch" - <<<"#include <silt/$header.hpp>"
done
