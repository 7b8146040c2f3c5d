#!/usr/bin/env bash
# Installs what is missing of the packages of Debian 12 or 13 for the named purposes:
#
#   deploy/install-packages.sh [build] [test] [package]        (no name: build)
#
#   build    compile dyncal
#   package  make Debian packages of it, on top of `build`
#   test     what the tests need on top of `build`
#
# Looks first and calls apt-get only when something is missing; nothing that is installed is
# upgraded or removed.
set -euo pipefail

build_packages=(
  g++ cmake ninja-build ccache mold pkgconf
  python3-minimal # C++ types from the IDL
  libfastrtps-dev # Fast DDS 2.9; on Debian 13 it brings version 3.1
  cyclonedds-dev cyclonedds-tools
  libeigen3-dev libceres-dev
  libcli11-dev libtomlplusplus-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libexpected-dev
  libprotobuf-dev protobuf-compiler libssl-dev libsndfile1-dev liblxi-dev libtirpc-dev
  zlib1g-dev libsqlite3-dev
)
# dyncal is built without what these are for where they cannot be had.
optional_build_packages=(
  libsystemd-dev     # daemons tell systemd that they are ready
  prometheus-cpp-dev # --metrics of the daemons
  libzstd-dev        # smaller recordings
  liblz4-dev         # recordings that others have compressed with LZ4
  libpqxx-dev        # results of runs in PostgreSQL
  libasound2-dev     # sound devices as measuring instruments: driver "alsa"
  libhdf5-dev        # recordings as HDF5, files of the SmartUp receiver
  libxml2-dev libxmlsec1-dev # certificates: dyncal certify, dyncal verify
  libxlsxwriter-dev          # dyncal means: XLSX
  cmark-gfm python3          # the guide as HTML
  help2man                   # manual pages
  libcpp-httplib-dev # dyncal-web
)
test_packages=(
  fastddsgen                                   # programs of others, made from the IDL
  libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev libtinyxml2-dev
  clang libclang-rt-dev                        # libFuzzer
  git python3
  nftables iproute2                            # packet loss between network namespaces
  faketime                                     # clocks of hosts that are wrong
  python3-numpy python3-scipy python3-mpmath   # independent reference values
  python3-canmatrix                            # independent DBC decoder
  python3-venv                                 # the rules for digital certificates, from PyPI
  python3-jsonschema                           # results against their schema
  python3-h5py                                 # exports, read by others
  postgresql                                   # a server of the test's own, on a socket
  libxml2-utils openssl                        # certificates: independent validator, keys
  softhsm2 libengine-pkcs11-openssl            # keys in tokens
  man-db groff-base zsh fish                   # manual pages, completion of the command line
  weasyprint poppler-utils                     # reports as PDF, and their text
  chromium libjs-dygraphs                      # the page in a browser
  nginx-light                                  # the page behind a proxy
  mosquitto mosquitto-clients                  # a broker and a subscriber beside dyncal-bridge
  user-mode-linux busybox-static can-utils     # a kernel with CAN where this one has none
)
package_packages=(build-essential debhelper dpkg-dev fakeroot lintian)
# How the code is written is looked at by one version, which Debian 12 alone has: elsewhere these
# tests say that they are skipped.
if grep -qsx 'VERSION_CODENAME=bookworm' /etc/os-release; then
  test_packages+=(clang-format-14 clang-tidy-14)
fi

wanted=()
optional=()
[[ $# -gt 0 ]] || set -- build
for purpose in "$@"; do
  case $purpose in
    build)
      wanted+=("${build_packages[@]}")
      optional+=("${optional_build_packages[@]}")
      ;;
    test) wanted+=("${test_packages[@]}") ;;
    package) wanted+=("${package_packages[@]}") ;;
    *)
      echo "install-packages.sh: '$purpose' is not one of build, test, package" >&2
      exit 2
      ;;
  esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install-packages.sh: this is not a Debian system; install by hand what these Debian" \
    "packages hold: ${wanted[*]}" >&2
  exit 1
fi

# dpkg-query fails for names it has never seen, which are missing like the others.
missing_of() {
  local installed package
  installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null |
    sed -n 's/^installed //p' || true)
  for package in "$@"; do
    grep -qxF -- "$package" <<<"$installed" || echo "$package"
  done
}
mapfile -t missing < <(missing_of "${wanted[@]}")
missing_optional=()
[[ ${#optional[@]} -eq 0 ]] || mapfile -t missing_optional < <(missing_of "${optional[@]}")
[[ $((${#missing[@]} + ${#missing_optional[@]})) -gt 0 ]] || exit 0

as_root=()
if [[ $EUID -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "install-packages.sh: neither root nor sudo; as root:" \
      "apt-get install --no-install-recommends ${missing[*]} ${missing_optional[*]}" >&2
    exit $((${#missing[@]} > 0))
  fi
  as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT

install_once() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes \
    --no-install-recommends --no-remove --no-upgrade -o DPkg::Lock::Timeout=300 \
    -o Dpkg::Use-Pty=0 "$@" >"$log" 2>&1
}

# The usual reasons for a failure are package lists that were never fetched or have aged: fetch them
# only then.
install() {
  echo "Installing from Debian: $*"
  install_once "$@" && return
  "${as_root[@]}" apt-get update -o DPkg::Lock::Timeout=300 -qq || true
  install_once "$@"
}

if [[ ${#missing[@]} -gt 0 ]] && ! install "${missing[@]}"; then
  tail -n 20 "$log" >&2
  echo "install-packages.sh: apt-get could not install ${missing[*]};" \
    "its last lines are above" >&2
  exit 1
fi
if [[ ${#missing_optional[@]} -gt 0 ]] && ! install "${missing_optional[@]}"; then
  echo "install-packages.sh: dyncal will be built without ${missing_optional[*]}," \
    "which apt-get could not install" >&2
fi
