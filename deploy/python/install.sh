#!/usr/bin/env bash
# Installs dyncal-bridge into a Python environment of its own, with its unit:
#
#   deploy/python/install.sh [--prefix DIR] [--plugs foxglove,mqtt,opcua] [--secured]
#                            [--wheels FOLDER]
#   deploy/python/install.sh --make-wheels FOLDER [--plugs ...] [--secured]
#
# The environment is DIR/lib/dyncal-bridge, the program DIR/bin/dyncal-bridge, the unit
# DIR/lib/systemd/system/dyncal-bridge.service; DIR is /usr/local unless given. Packages come from
# PyPI, and the package dyncal is compiled from this tree; --wheels takes all from a folder that
# --make-wheels has filled on another computer (of the same Python and architecture), and needs
# neither network nor compiler. Called again, it does what is missing, and says what it did.
#
# --secured: for a secured laboratory. The package cyclonedds, 0.10, is then compiled on Debian's
# library (its packages cyclonedds-dev and python3-dev), which has the plug-ins that those of PyPI
# lack; where the bridge runs it needs libddsc0debian. A folder that --make-wheels --secured has
# filled needs no word more.
#
# PYTHON names another interpreter than python3; DYNCAL_BUILT a build folder whose analysis library
# is taken instead of compiling one.
set -euo pipefail

top=$(cd "$(dirname "$0")/../.." && pwd)
python=${PYTHON:-python3}
prefix=/usr/local
plugs=foxglove,mqtt,opcua
wheels=
make_wheels=
secured=

fail() {
  echo "install.sh: $*" >&2
  exit 1
}

while [[ $# -gt 0 ]]; do
  case $1 in
    --prefix | --plugs | --wheels | --make-wheels)
      [[ -n ${2:-} ]] || fail "$1 needs a value"
      name=${1#--}
      printf -v "${name//-/_}" %s "$2"
      shift 2
      ;;
    --secured)
      secured=secured
      shift
      ;;
    *)
      echo "install.sh: '$1' is none of --prefix, --plugs, --secured, --wheels, --make-wheels" >&2
      exit 2
      ;;
  esac
done
prefix=$(realpath -m "$prefix")
for plug in ${plugs//,/ }; do
  [[ $plug =~ ^(foxglove|mqtt|opcua)$ ]] ||
    fail "--plugs $plugs: '$plug' is none of foxglove, mqtt, opcua"
done
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
  fail "$python is not Python 3.11 or later; name one by PYTHON=..."
"$python" -c 'import ensurepip, venv' 2>/dev/null ||
  fail "$python cannot make environments; on Debian: apt-get install python3-venv"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1

# Wheels of dyncal and of the bridge, into $work, and where it is to be secured that of cyclonedds.
build_wheels() {
  local settings=()
  [[ -z ${DYNCAL_BUILT:-} ]] ||
    settings=("--config-settings=cmake.define.DYNCAL_BUILT=$DYNCAL_BUILT")
  echo "building the packages dyncal and dyncal-bridge"
  "$1" -m pip wheel -q --no-deps -w "$work" "${settings[@]}" "$top/deploy/python" ||
    fail "the package dyncal cannot be built: it needs a compiler, CMake, Eigen and tl-expected" \
      "(deploy/install-packages.sh build), or --wheels"
  cp -r "$top/deploy/python/bridge" "$work/bridge" # setuptools writes beside its sources
  "$1" -m pip wheel -q --no-deps -w "$work" "$work/bridge" || fail "dyncal-bridge cannot be built"
  [[ -z $secured ]] || build_secured_cyclonedds "$1"
}

# That of PyPI, compiled, into $work: from its cache pip would take one that was compiled before,
# perhaps on another library.
build_secured_cyclonedds() {
  local library
  library=$(find /usr/lib -name libddsc.so -print -quit)
  [[ -n $library ]] || fail "--secured needs Debian's Cyclone DDS: apt-get install cyclonedds-dev"
  mkdir "$work/cyclonedds"
  ln -s /usr/include "$work/cyclonedds/include"
  ln -s /usr/bin "$work/cyclonedds/bin"
  ln -s "$(dirname "$library")" "$work/cyclonedds/lib"
  echo "building the package cyclonedds on $library"
  CYCLONEDDS_HOME=$work/cyclonedds "$1" -m pip wheel -qq --no-deps --no-cache-dir -w "$work" \
    --no-binary cyclonedds cyclonedds==0.10.5 ||
    fail "the package cyclonedds cannot be built: it needs PyPI, a compiler and python3-dev"
}

# Wheels of a folder, as pip takes them, with what they need of packages for $plugs.
own=()
find_own_wheels() {
  own=("$(echo "$1"/dyncal-*.whl)[dds]" "$(echo "$1"/dyncal_bridge-*.whl)[$plugs]")
  ! compgen -G "$1/cyclonedds-0.10.5-*.whl" >/dev/null || own+=("$1"/cyclonedds-0.10.5-*.whl)
}

if [[ -n $make_wheels ]]; then
  "$python" -m venv "$work/environment"
  build_wheels "$work/environment/bin/python3"
  find_own_wheels "$work"
  mkdir -p "$make_wheels"
  "$work/environment/bin/python3" -m pip wheel -q -w "$make_wheels" "${own[@]}" ||
    fail "the packages of $plugs cannot be had from PyPI"
  echo "$make_wheels: $(find "$make_wheels" -name '*.whl' | wc -l) wheels for $plugs;" \
    "elsewhere: deploy/python/install.sh --wheels FOLDER"
  exit 0
fi

# What the environment is made of; the same once more is left as it is.
contents() {
  echo "$plugs $secured $("$python" -c 'import sys; print(sys.version)')"
  if [[ -n $wheels ]]; then
    find "$wheels" -name '*.whl' -exec sha256sum {} +
  else
    find "$top/deploy/python" "$top/analysis" "$top/idl" "$top/services/views/report" -type f \
      -not -path '*/__pycache__/*' -exec sha256sum {} +
  fi | LC_ALL=C sort
}
if [[ -n $wheels ]]; then
  compgen -G "$wheels/dyncal_bridge-*.whl" >/dev/null ||
    fail "--wheels $wheels: holds no wheel of dyncal-bridge; fill it by --make-wheels"
  [[ -z $secured ]] || compgen -G "$wheels/cyclonedds-0.10.5-*.whl" >/dev/null ||
    fail "--secured: $wheels holds no cyclonedds 0.10.5; fill it by --make-wheels --secured"
fi
environment=$prefix/lib/dyncal-bridge
wanted=$(contents | sha256sum)
if [[ $(cat "$environment/contents" 2>/dev/null || true) == "$wanted" ]]; then
  echo "$environment: is as it should be"
else
  rm -f "$environment/contents"
  mkdir -p "$prefix/lib"
  "$python" -m venv --clear "$environment" || fail "$environment cannot be made"
  offline=(--no-index --find-links "$wheels")
  if [[ -z $wheels ]]; then
    build_wheels "$environment/bin/python3"
    offline=()
  fi
  find_own_wheels "${wheels:-$work}"
  "$environment/bin/python3" -m pip install -q "${offline[@]}" "${own[@]}" ||
    fail "the packages of $plugs cannot be installed from ${wheels:-PyPI}"
  echo "$wanted" >"$environment/contents"
  echo "$environment: environment for $plugs"
fi

mkdir -p "$prefix/bin" "$prefix/lib/systemd/system"
program=$prefix/bin/dyncal-bridge
if [[ $(readlink "$program" || true) != "$environment/bin/dyncal-bridge" ]]; then
  ln -sf "$environment/bin/dyncal-bridge" "$program"
  echo "$program: installed"
fi
unit=$prefix/lib/systemd/system/dyncal-bridge.service
sed "s|@bindir@|$prefix/bin|" "$top/deploy/systemd/dyncal-bridge.service.in" >"$work/unit"
if ! cmp -s "$work/unit" "$unit"; then
  install -m 644 "$work/unit" "$unit"
  echo "$unit: installed"
fi
"$program" --help >/dev/null || fail "$program does not start"
# The unit's user has no way into somebody's home, where Pythons of pyenv and conda are.
for place in "$environment" "$(readlink -f "$environment/bin/python3")"; do
  while [[ $place != / && $(stat -c %A "$place") == *[xt] ]]; do
    place=$(dirname "$place")
  done
  [[ $place == / ]] || {
    echo "install.sh: systemd cannot start it, since only $(stat -c %U "$place") may use $place;" \
      "take another --prefix, or Debian's Python by PYTHON=/usr/bin/python3" >&2
    exit 0
  }
done
echo "next: write /etc/dyncal/bridge.toml, then: systemctl enable --now dyncal-bridge"
