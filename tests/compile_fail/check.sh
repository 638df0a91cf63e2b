#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   check.sh FLAGS-FILE SOURCE COMPILER...
#
# Passes if SOURCE does not compile and the compiler's words match the regular expression (grep -E)
# of its first line, "// expect: REGEX". With SILT_VALID defined the same file must compile, so that
# it cannot fail for a reason of its own, such as a misspelt include.
set -uo pipefail
export LC_ALL=C

flags=$1
source=$2
shift 2
compile=("$@" "@$flags" -fsyntax-only "$source")

expected=$(sed -n '1s|^// expect: ||p' "$source")
if [[ -z $expected ]]; then
  echo "$source: the first line must be \"// expect: REGEX\""
  exit 1
fi
if ! "${compile[@]}" -DSILT_VALID; then
  echo "$source: does not compile with SILT_VALID defined"
  exit 1
fi
if words=$("${compile[@]}" 2>&1); then
  echo "$source: compiles, but must not"
  exit 1
fi
if ! grep -Eq -- "$expected" <<<"$words"; then
  printf '%s\n' "$words" "$source: does not compile, but the words above do not match: $expected"
  exit 1
fi
grep -E -m 1 -- "$expected" <<<"$words"
