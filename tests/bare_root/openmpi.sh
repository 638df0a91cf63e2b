#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   openmpi.sh SOURCE SCRATCH
#
# Configures Silt, and a program that asks for several processes, in a minimal Debian system that has
# openmpi-bin, which LAMMPS and ParaView install, but not libopenmpi-dev: MPI's compilers without its
# headers. Skipped with exit code 77 like check.sh.
set -euo pipefail

source "$(dirname "${BASH_SOURCE[0]}")/root.sh"
root=$scratch/openmpi
trap 'rm -rf "$root"' EXIT

rm -rf "$root"
cp -a "$base" "$root"
inside "$root" root "apt-get update && apt-get install -y --no-install-recommends openmpi-bin g++ cmake \
  make pkg-config python3 libeigen3-dev libgtest-dev libbenchmark-dev libcli11-dev nlohmann-json3-dev" \
  >"$scratch/openmpi.txt" 2>&1 || { tail "$scratch/openmpi.txt"; give_up "openmpi-bin cannot be installed"; }
inside "$root" root "command -v mpicxx" || give_up "openmpi-bin has no mpicxx, so that this test proves nothing"
git -C "$source" ls-files -z -c -o --exclude-standard | (cd "$source" && xargs -0 cp --parents -t "$root/srv")
cp -r "$source/tests/install/consumer" "$root/home/user/"
chroot "$root" chown -R user: /home/user

# try NAME COMMAND LINE…: as the ordinary user; the output must have these lines once, and nothing else of MPI.
try() {
  echo "== $1"
  local printed code=0 line
  printed=$(inside "$root" user "$2" 2>&1) || code=$?
  ((code == ${4:-0})) || { echo "$printed"; give_up "$1: exit code $code"; }
  [[ $(tr -s ' \n' ' ' <<<"$printed") = *"$3"* ]] || { echo "$printed"; give_up "$1: nothing of '$3'"; }
}
