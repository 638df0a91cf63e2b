#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   check.sh FLAGS-FILE SOURCE COMPILER...
#
# Passes if SOURCE does not compile and the compiler's first two errors match the regular expression
# (grep -E) in its first line, "// expect: REGEX". With SILT_VALID defined the same file must
# compile, which excludes unrelated errors, such as a misspelt include. A line "// flags: FLAGS" is
# for the compilation that fails, and repeated for each line.
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
mapfile -t variants < <(sed -n 's|^// flags: ||p' "$source")
for flags in "${variants[@]:-}"; do
  # shellcheck disable=SC2086
  if output=$("${compile[@]}" -fmax-errors=2 $flags 2>&1); then
    echo "$source: compiles, but must not${flags:+ with $flags}"
    exit 1
  fi
  if ! grep -Eq -- "$expected" <<<"$output"; then
    printf '%s\n' "$output" "$source: does not compile, but the above does not match: $expected"
    exit 1
  fi
  grep -E -m 1 -- "$expected" <<<"$output"
done
