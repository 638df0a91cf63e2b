#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   install.sh BUILD SCRATCH FOLDER PYTHON
#
# Installs the build folder with its Python package below SCRATCH, and runs a program with the package
# from there, where FOLDER is relative to the prefix. The Debian package, of no architecture, must have
# none of it.
set -euo pipefail

build=$1 prefix=$2/prefix folder=$3 python=$4
rm -rf "$2"
mkdir -p "$2"
cmake --install "$build" --prefix "$prefix" >"$2/log.txt"
cd "$2"
PYTHONPATH=$prefix/$folder "$python" -W error -c '
import pathlib, sys, silt
where = pathlib.Path(silt.__file__).parent
assert where == pathlib.Path(sys.argv[1]), where
assert (where / "py.typed").exists()
assert silt.__version__.count(".") == 2, silt.__version__
disc = silt.grain_simulation(position=[(0, 1)], radius=0.1, density=1000,
                             law=silt.CundallStrack(normal_stiffness=1e6))
disc.run(until=0.1)
' "$prefix/$folder/silt"

if command -v dpkg-deb >/dev/null; then
  # For this generator cpack does not build again what the tests use.
  cpack --config "$build/CPackConfig.cmake" -B "$2/package" -D CPACK_CMAKE_GENERATOR=Ninja >>log.txt
  dpkg-deb --contents "$2"/package/*.deb >contents.txt
  grep -q 'silt/core/simulation.hpp' contents.txt
  if grep 'python\|\.so' contents.txt; then
    echo "The Debian package is of all architectures, but has these files." >&2
    exit 1
  fi
fi
