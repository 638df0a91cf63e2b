#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   killed.sh MPIEXEC FLAG PROGRAM
#
# If a process of a run is killed, the job ends soon, with an error, and its checkpoint is whole.
set -uo pipefail

cd "$(mktemp -d)" || exit 1
trap 'rm -rf "$PWD"' EXIT
timeout 60 "$1" "$2" 2 "$3" >log 2>&1
code=$?
if ((code == 0 || code == 124)); then
  cat log
  echo "killed.sh: the job ended with $code"
  exit 1
fi
"$1" "$2" 1 "$3" read
