#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   precompile.sh FLAGS-FILE FOLDER HEADERS COMPILER...
#
# Precompiles umbrella headers, such as "silt dem", in FOLDER, for the tests that compile short
# programs.
set -euo pipefail

flags=$1 folder=$2 headers=$3
shift 3
rm -rf "$folder"
mkdir -p "$folder/silt"
for header in $headers; do
  echo "#include <silt/$header.hpp>" >"$folder/$header.hpp"
  # Used if the header is included a second time.
  printf '#pragma GCC system_header\n#include_next <silt/%s.hpp>\n' "$header" >"$folder/silt/$header.hpp"
  "$@" "@$flags" -x c++-header "$folder/$header.hpp" -o "$folder/silt/$header.hpp.gch"
done
