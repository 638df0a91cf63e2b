#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
#   check.sh SOURCE SCRATCH [root] [user]
#
# Executes README.md literally in a minimal Debian system with git only, as root and as an ordinary
# user (or one of them): clones SOURCE as committed, and runs every ```sh block in order. A block is
# skipped if the line above it is
#   <!-- silt: skip-shell REASON -->
# and a block of any language is written to a file in the current folder if that line is
#   <!-- silt: save-as FILE -->
# Passes if all exit codes are 0, there are no warnings, no prompts (there is no input), no silence
# of more than ten seconds except in a compiler or CMake called by README itself, and a picture is
# drawn. Prints the minutes and the number of typed lines before the first picture. The output is
# kept in SCRATCH/root.txt and SCRATCH/user.txt.
#
# Needs root, debootstrap and a Debian mirror in /etc/apt; otherwise exits with 77, "skipped".
set -euo pipefail

longest_silence=10  # [s]

source "$(dirname "${BASH_SOURCE[0]}")/root.sh"
names=("${@:3}")
if ((${#names[@]} == 0)); then names=(root user); fi

git -C "$source" rev-parse HEAD >/dev/null || skip "$source is not a git repository"

# --- README --------------------------------------------------------------------------------------

# Writes the blocks of README to FOLDER/NN.sh, or FOLDER/NN.save with the file name as first line.
read_blocks() {
  awk -v folder="$2" '
    !inside && /^<!-- silt: skip-shell / { mark = "skip"; next }
    !inside && /^<!-- silt: save-as [^ ]+ -->/ { mark = $4; next }
    /^```/ {
      if (inside) { inside = 0; file = ""; mark = ""; next }
      inside = 1
      if (mark == "skip") next
      if (mark != "") {
        file = sprintf("%s/%02d.save", folder, ++count)
        print mark >file
      } else if (/^```sh[ \t]*$/) {
        file = sprintf("%s/%02d.sh", folder, ++count)
      }
      next
    }
    inside && file != "" { print >file; next }
    !inside && !/^[ \t]*$/ { mark = "" }' "$1"
}

# watch FILE: prefixes each line with the time; writes the longest silence, and the line before it,
# to FILE.
watch() {
  local file=$1 line now last=$EPOCHREALTIME began=$EPOCHREALTIME before="the beginning" more=yes
  while [[ $more = yes ]]; do
    IFS= read -r line || more=no
    now=$EPOCHREALTIME
    echo "$(((${now/./} - ${last/./}) / 1000)) ms after: $before"
    if [[ -n $line || $more = yes ]]; then
      printf '[%4d s] %s\n' $(((${now/./} - ${began/./}) / 1000000)) "$line" >&2
    fi
    last=$now before=$line
  done | sort -rn | sed -n 1p >"$file"
}

# The first picture drawn in ROOT: seconds since 1970, a space and its path.
first_picture() {
  find "$1/root" "$1/home" -name '*.png' -not -path '*/docs/*' -printf '%T@ %p\n' 2>/dev/null |
    sort -n | sed -n 1p
}

follow_readme() {
  local user=$1 login=$1 root=$scratch/$1 log=$scratch/$1.txt home
  echo "== As $user"
  rm -rf "$root"
  cp -a "$base" "$root"
  home=$(chroot "$root" su - "$login" -c pwd)

  # The repository, at the address given in README.
  git clone --quiet --bare "$source" "$root/srv/silt.git"
  local url
  url=$(sed -nE 's/^ *git clone ([^ ]+).*/\1/p' "$source/README.md" | head -n 1)
  inside "$root" root "git config --system safe.directory '*'"
  if [[ -n $url ]]; then
    inside "$root" root "git config --system url.file:///srv/silt.git.insteadOf '$url'"
  fi
  inside "$root" "$login" "git clone --quiet file:///srv/silt.git checkout"
  echo "$home$([[ -n $url ]] || echo /checkout)" >"$root/srv/folder"
  chmod 666 "$root/srv/folder"

  local blocks=$scratch/$user.blocks
  rm -rf "$blocks"
  mkdir -p "$blocks"
  read_blocks "$source/README.md" "$blocks"
  # Without sudo, a command for the administrator must be printed; afterwards the user gets sudo.
  if [[ $user != root ]]; then
    inside "$root" "$login" "cd checkout && examples/run" >"$scratch/$user.refused.txt" 2>&1 &&
      give_up "examples/run ran without packages"
    local command
    command=$(grep -A1 'To install them, type$' "$scratch/$user.refused.txt" | tail -n 1)
    [[ $command = *"apt-get install"* ]] ||
      { cat "$scratch/$user.refused.txt"; give_up "no command to install packages was printed"; }
    echo "The administrator types:$command"
    inside "$root" root "$command" >"$scratch/$user.administrator.txt" 2>&1 ||
      { tail "$scratch/$user.administrator.txt"; give_up "that command failed"; }
    inside "$root" root "apt-get install -y sudo && echo 'user ALL=(ALL) NOPASSWD: ALL' \
      >/etc/sudoers.d/user" >>"$scratch/$user.administrator.txt" 2>&1
  fi

  local block lines=0 typed began=$EPOCHSECONDS code picture="" longest=0 silence
  : >"$log"
  for block in "$blocks"/*; do
    if [[ $block = *.save ]]; then
      tail -n +2 "$block" >"$root$(cat "$root/srv/folder")/$(head -n 1 "$block")"
      continue
    fi
    typed=$(grep -cvE '^ *(#|$)' "$block") || true
    lines=$((lines + typed))
    {
      if [[ $user = root ]]; then echo 'sudo() { "$@"; }'; fi  # root has no sudo
      echo "trap 'pwd >/srv/folder' EXIT; set -e; cd '$(cat "$root/srv/folder")'; set -v"
      cat "$block"
    } >"$root/srv/block"
    code=0
    inside "$root" "$login" "bash -o pipefail /srv/block" 2>&1 | watch "$scratch/silence" 2>&1 |
      tee -a "$log" || code=$?
    ((code == 0)) || give_up "as $user, exit code $code of
$(cat "$block")"
    silence=$(<"$scratch/silence")
    echo "Longest silence of this block: $silence"
    if ! grep -qE '^ *(sudo )?([a-z+-]*(g|clang)\+\+|c\+\+|cmake|apt-get)' "$block" &&
      ((${silence%% *} > longest_silence * 1000)); then
      give_up "as $user, a silence of $silence"
    fi
    if ((${silence%% *} > longest)); then longest=${silence%% *}; fi
    if [[ -z $picture ]]; then
      picture=$(first_picture "$root")
      if [[ -n $picture ]]; then
        echo "As $user, the first picture, ${picture##*/}, came after" \
          "$(((${picture%%.*} - began + 30) / 60)) minutes and $lines lines typed" | tee -a "$scratch/found"
      fi
    fi
  done
  # The log also contains the commands themselves.
  if sed 's/^\[ *[0-9]* s\] //' "$log" | grep -vxF "$(cat "$blocks"/*.sh)" |
    grep -v '^invoke-rc.d: ' | grep -iw warning; then  # Debian's packages miss an init system here
    give_up "as $user, there were warnings"
  fi
  [[ -n $picture ]] || give_up "as $user, no picture was drawn"
  echo "As $user, README took $(((EPOCHSECONDS - began + 30) / 60)) minutes and $lines lines; the" \
    "longest silence was $((longest / 1000)) s" | tee -a "$scratch/found"
  rm -rf "$root"
}

rm -f "$scratch/found"
trap 'for name in "${names[@]}"; do rm -rf "${scratch:?}/$name"; done' EXIT
for name in "${names[@]}"; do follow_readme "$name"; done
echo "== Results"
cat "$scratch/found"
