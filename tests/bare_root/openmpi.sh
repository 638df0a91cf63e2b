#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   openmpi.sh SOURCE SCRATCH
#
# Configures Silt, runs an example, and configures a program for several processes in a minimal Debian
# system that has openmpi-bin but not libopenmpi-dev, as every one with LAMMPS or ParaView: MPI's
# compilers are there, its headers are not. Skipped with exit code 77 like check.sh.
set -euo pipefail

source "$(dirname "${BASH_SOURCE[0]}")/root.sh"
root=$scratch/openmpi
trap 'rm -rf "$root"' EXIT

rm -rf "$root"
cp -a "$base" "$root"
inside "$root" root "apt-get update && apt-get install -y --no-install-recommends openmpi-bin g++ cmake \
  make libeigen3-dev libgtest-dev libbenchmark-dev python3" >"$scratch/openmpi.txt" 2>&1 ||
  { tail "$scratch/openmpi.txt"; give_up "openmpi-bin cannot be installed"; }
inside "$root" root "command -v mpicxx && ! dpkg-query --status libopenmpi-dev" ||
  give_up "this system does not show what is tested"

mkdir "$root/home/user/silt"
tar -c -C "$source" --exclude=./build --exclude=./out --exclude=./.git . | tar -x -C "$root/home/user/silt"
chroot "$root" chown -R user: /home/user

# expect CODE COMMAND PATTERN...: as the ordinary user, in the sources; the output, with single spaces,
# matches each pattern.
expect() {
  local code=0 printed pattern
  echo "== $2"
  printed=$(inside "$root" user "cd silt; $2" 2>&1) || code=$?
  ((code == $1)) || { echo "$printed"; give_up "exit code $code"; }
  for pattern in "${@:3}"; do
    tr -s '[:space:]' ' ' <<<"$printed" | grep -qE -e "$pattern" || { echo "$printed"; give_up "nothing of: $pattern"; }
  done
}
line="-- Silt: MPI does not work, see [^ ]+\. Programs on several processes need it \(Debian: libopenmpi-dev\)"

expect 0 "examples/run quickstart_tower" "$line"
for folder in EXAMPLES TESTS BENCH; do
  expect 0 "cmake -B build/$folder -DCMAKE_BUILD_TYPE=Release -DSILT_BUILD_$folder=ON" "$line"
done
expect 0 "cmake --install build/TESTS --prefix ~/prefix"
consumer="cmake -S tests/install/consumer -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=\$HOME/prefix -DMETHOD=package"
expect 0 "$consumer -B build/one_process"
expect 1 "$consumer -B build/processes -DPROCESSES=ON" "$line" \
  "silt's component mpi needs MPI, Zoltan and hypre \(Debian: libopenmpi-dev, libtrilinos-zoltan-dev, libhypre-dev\)"
