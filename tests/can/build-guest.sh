#!/usr/bin/env bash
# Builds a small User-Mode-Linux kernel for the CAN tests from Debian's kernel source:
#
#   build-guest.sh            # -> ${XDG_CACHE_HOME:-~/.cache}/dyncal/linux-can, found by the tests
#   build-guest.sh FOLDER     # -> FOLDER/linux-can; set DYNCAL_CAN_KERNEL=FOLDER/linux-can
#
# Beyond Debian's package user-mode-linux it has gs_usb over USB/IP (adapters with hardware stamps),
# isotp and simulated time (time-travel=inf-cpu). Needs: linux-source-6.1 gcc make flex bison bc
# xz-utils; about 2 GB while it builds and 3 to 5 min on two processors. A kernel of 7 MB remains;
# one that was built from the same source package with the same configuration is kept.
set -euo pipefail

if [[ $# -gt 1 ]]; then
  echo "usage: $0 [FOLDER]" >&2
  exit 2
fi
here=$(dirname "$(realpath "$0")")
config=$here/guest/kernel.config
folder=${1:-${XDG_CACHE_HOME:-$HOME/.cache}/dyncal}
mkdir -p "$folder"
folder=$(realpath "$folder")

source=$(find /usr/src -maxdepth 1 -name 'linux-source-*.tar.xz' | sort -V | tail -1)
if [[ -z $source ]]; then
  echo "build-guest: no kernel source in /usr/src; 'apt-get install linux-source-6.1'" >&2
  exit 1
fi
for needed in gcc make flex bison bc xz; do
  if ! command -v "$needed" >/dev/null; then
    echo "build-guest: $needed is not there; 'apt-get install gcc make flex bison bc xz-utils'" >&2
    exit 1
  fi
done

name=$(basename "$source" .tar.xz)
hash=$({ sha256sum <"$source"; sha256sum <"$config"; } | sha256sum | cut -c1-12)
kernel=$folder/linux-can-${name#linux-source-}-$hash
if [[ -x $kernel ]]; then
  echo "build-guest: $kernel is up to date"
  ln -sfn "$(basename "$kernel")" "$folder/linux-can"
  exit 0
fi

work=$(mktemp -d "$folder/build.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/source" "$work/build"
tar -xf "$source" -C "$work/source" --strip-components=1
build=(make -s -C "$work/source" ARCH=um O="$work/build")
"${build[@]}" KCONFIG_ALLCONFIG="$config" allnoconfig >/dev/null
missing=$(grep -oE '^CONFIG_[A-Z0-9_]+' "$config" | while read -r option; do
  grep -q "^$option=" "$work/build/.config" || echo "$option"
done)
if [[ -n $missing ]]; then
  echo "build-guest: this source does not have" $missing >&2
  # No CAN tests without these; the others are for some of them.
  grep -qE '^CONFIG_(CAN|HOSTFS)' <<<"$missing" && exit 1
fi
"${build[@]}" -j"$(nproc)" linux
strip "$work/build/linux"
mv "$work/build/linux" "$kernel"
ln -sfn "$(basename "$kernel")" "$folder/linux-can"
echo "build-guest: $kernel"
