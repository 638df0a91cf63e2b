# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Sourced by the tests in a minimal Debian system, which are called with SOURCE SCRATCH: makes $base, a
# root file system with git only, and runs commands in copies of it. Without root, debootstrap or a
# Debian mirror in /etc/apt it exits with 77, "skipped".

release=bookworm
# shellcheck disable=SC2034
source=$(cd "$1" && pwd)
mkdir -p "$2"
scratch=$(cd "$2" && pwd)

skip() {
  echo "Skipped: $*"
  exit 77
}
give_up() {
  echo "FAILED: $*"
  exit 1
}

# The Debian mirror that this machine uses.
mirror() {
  local files=(/etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources)
  { cat "${files[@]}" 2>/dev/null || true; } |
    sed -nE 's/^(URIs:|deb +(\[[^]]*\] *)?) *((https?|file):[^ ]*\/debian)\/?( .*)?$/\3/p' | head -n 1
}

[[ $(id -u) -eq 0 ]] || skip "only root can create a root file system"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
command -v unshare >/dev/null || skip "unshare is not installed"
mirror=$(mirror)
[[ -n $mirror ]] || skip "no Debian mirror was found in /etc/apt"

# Created once; every user gets a copy.
base=$scratch/base
if [[ ! -e $base.done ]]; then
  rm -rf "$base"
  debootstrap --variant=minbase --include=git,ca-certificates "$release" "$base" "$mirror" \
    >"$scratch/debootstrap.txt" 2>&1 ||
    { tail -n 5 "$scratch/debootstrap.txt"; skip "debootstrap failed"; }
  rm -rf "$base"/var/lib/apt/lists/* "$base"/var/cache/apt/archives/*.deb
  # Same network configuration as this machine.
  cp -L /etc/resolv.conf /etc/hosts "$base/etc/"
  apt-config dump | grep -i '^Acquire::[a-z]*::Proxy' >"$base/etc/apt/apt.conf.d/90proxy" || true
  chroot "$base" useradd --create-home --shell /bin/bash user
  touch "$base.done"
fi

# inside ROOT USER SCRIPT: runs it as USER, without terminal and input, in its own process and mount
# namespaces, which end with it.
inside() {
  # shellcheck disable=SC2016
  unshare --mount --pid --fork --kill-child setsid --wait bash -c '
    mount -t proc proc "$1/proc"
    mkdir -p "$1/dev/shm" && mount -t tmpfs tmpfs "$1/dev/shm"
    exec env -i TERM=dumb PATH=/usr/sbin:/usr/bin:/sbin:/bin chroot "$1" su - "$2" -c "$3"' _ "$1" "$2" "$3" </dev/null
}
