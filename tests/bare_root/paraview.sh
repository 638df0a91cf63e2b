#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   paraview.sh SOURCE SCRATCH
#
# Installs Debian's ParaView into a minimal Debian system and reads the frames of the quick start's
# tower with it. In a system of its own, because Debian's packages of ParaView and of VTK for Python
# exclude each other. Skipped with exit code 77 like check.sh.
set -euo pipefail

source "$(dirname "${BASH_SOURCE[0]}")/root.sh"
root=$scratch/paraview
trap 'rm -rf "$root"' EXIT

read -ra eigen <<<"$(pkg-config --cflags eigen3 2>/dev/null || echo -I/usr/include/eigen3)"
"${CXX:-c++}" -std=c++20 -O1 -I "$source/include" "${eigen[@]}" "$source/examples/quickstart_tower.cpp" \
  -o "$scratch/quickstart_tower"

rm -rf "$root"
cp -a "$base" "$root"
inside "$root" root "apt-get update && apt-get install -y --no-install-recommends python3-paraview" \
  >"$scratch/paraview.txt" 2>&1 || { tail "$scratch/paraview.txt"; give_up "ParaView cannot be installed"; }

(cd "$root/home/user" && "$scratch/quickstart_tower" >/dev/null)
cp "$source/tests/bare_root/read_with_paraview.py" "$root/home/user/"
chroot "$root" chown -R user: /home/user
found=$(inside "$root" user "python3 read_with_paraview.py tower.pvd" 2>&1) || { echo "$found"; give_up "the frames cannot be read"; }
echo "$found"
frames=$(grep -c "<DataSet" "$root/home/user/tower.pvd")
grains=$(sed -nE '0,/NumberOfPoints/s/.*NumberOfPoints="([0-9]+)".*/\1/p' "$root/home/user/tower/tower_000000.vtu")
[[ $(sed -n 1p <<<"$found") = "$frames frames" ]] || give_up "ParaView finds another number of frames than $frames"
for line in 2 3; do
  # The names of the arrays, in their order in the alphabet.
  [[ " $(sed -n ${line}p <<<"$found") " = " $grains "*" id "*" radius "*" velocity "* ]] ||
    give_up "ParaView does not find $grains particles with their fields"
done
