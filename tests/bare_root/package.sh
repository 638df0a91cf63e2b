#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   package.sh SOURCE SCRATCH
#
# Makes the Debian package of SOURCE, installs it into a minimal Debian system and builds programs
# with it, as an ordinary user, by the methods of using an installed library: find_package, with and
# without silt_DIR; FetchContent, which finds the package; pkg-config; the compiler alone. Removes the
# package again. Skipped with exit code 77 like check.sh.
set -euo pipefail

source "$(dirname "${BASH_SOURCE[0]}")/root.sh"
root=$scratch/package
trap 'rm -rf "$root"' EXIT

# --- the package -----------------------------------------------------------------------------------

rm -rf "$scratch/package_build"
cmake -S "$source" -B "$scratch/package_build" >/dev/null
(cd "$scratch/package_build" && cpack)
packages=("$scratch"/package_build/*.deb)
((${#packages[@]} == 1)) || give_up "cpack made ${packages[*]}"
package=${packages[0]}

# expect_field NAME VALUE
expect_field() {
  local found
  found=$(dpkg-deb --field "$package" "$1")
  [[ $found = "$2" ]] || give_up "the package's field $1 is '$found', not '$2'"
}
version=$(sed -nE 's/^#define SILT_VERSION_(MAJOR|MINOR|PATCH) //p' "$source/include/silt/version.hpp" |
  paste -sd .)
expect_field Package libsilt-dev
expect_field Version "$version"
expect_field Architecture all
expect_field Section libdevel
expect_field Depends "libeigen3-dev (>= 3.4)"
expect_field Recommends ""
[[ $(dpkg-deb --field "$package" Maintainer) = *"<"*"@"*">" ]] || give_up "the maintainer has no address"
[[ $(basename "$package") = "libsilt-dev_${version}_all.deb" ]] || give_up "the package is called $package"
if dpkg-deb --contents "$package" | awk '{ print $1, $2, $6 }' |
  grep -vE '^(drwxr-xr-x|-rw-r--r--) root/root \./usr/((include|share)/)?((silt|cmake|pkgconfig|doc)/.*)?$'; then
  give_up "these files of the package are elsewhere, or others may not read them or may write them"
fi
if command -v lintian >/dev/null; then
  [[ -z $(lintian --allow-root "$package" 2>/dev/null | tee "$scratch/lintian.txt") ]] ||
    { cat "$scratch/lintian.txt"; give_up "lintian finds faults"; }
fi

# --- the five methods --------------------------------------------------------------------------------

rm -rf "$root"
cp -a "$base" "$root"
cp "$package" "$root/srv/"
name=/srv/$(basename "$package")
inside "$root" root "apt-get update && apt-get install -y --no-install-recommends $name g++ cmake make pkg-config" \
  >"$scratch/package.txt" 2>&1 || { tail "$scratch/package.txt"; give_up "the package cannot be installed"; }
inside "$root" root "dpkg --verify libsilt-dev && dpkg-query --show libeigen3-dev"
diff -r "$source/include/silt" "$root/usr/include/silt" || give_up "the headers are not those of the sources"

cp -r "$source/tests/install/consumer" "$root/home/user/"
cp "$source/examples/quickstart_tower.cpp" "$root/home/user/"
chroot "$root" chown -R user: /home/user

# try METHOD COMMANDS: as the ordinary user; the last line must be "OpenMP".
try() {
  echo "== $1"
  local printed
  printed=$(inside "$root" user "set -e; $2" 2>&1) || { echo "$printed"; give_up "$1"; }
  [[ ${printed##*$'\n'} = OpenMP ]] || { echo "$printed"; give_up "$1: the program has no OpenMP"; }
  if grep -i warning <<<"$printed"; then give_up "$1: there are warnings"; fi
}
with_cmake() {
  echo "rm -rf build; cmake -S consumer -B build -DCMAKE_BUILD_TYPE=Debug $*; cmake --build build; build/consumer"
}
compile="g++ -std=c++20 -fopenmp consumer/main.cpp -o program"
try "find_package" "$(with_cmake -DMETHOD=package)"
try "find_package with silt_DIR" "$(with_cmake -DMETHOD=package -Dsilt_DIR=/usr/share/cmake/silt)"
try "FetchContent, which finds the package" "$(with_cmake -DMETHOD=fetch_package)"
try "pkg-config" "$compile \$(pkg-config --cflags silt); ./program"
try "the compiler alone" "$compile -I /usr/include/eigen3; ./program"
echo "== a simulation"
inside "$root" user "set -e; g++ -std=c++20 -O1 -fopenmp quickstart_tower.cpp \$(pkg-config --cflags silt) -o program
  ./program; ls tower.pvd" || give_up "a simulation"

inside "$root" root "apt-get remove -y libsilt-dev" >>"$scratch/package.txt" 2>&1
if find "$root/usr" -path "*silt*" | grep .; then give_up "files are left after the package was removed"; fi
