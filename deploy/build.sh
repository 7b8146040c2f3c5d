#!/usr/bin/env bash
# Builds dyncal with a preset of CMakePresets.json; nearly silent when there is nothing to do:
#
#   deploy/build.sh PRESET with-tests|programs
#
# Programs alone are built by the preset "programs" in place of "release": quickest from nothing.
# CMake is called only for a build directory that is new, or that lacks the tests now asked for;
# ninja sees to the rest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=$1
directory=build
[[ $preset == release ]] || directory=build-$preset

has_tests() { grep -qx 'DYNCAL_BUILD_TESTS:BOOL=ON' "$directory/CMakeCache.txt"; }

case $2 in
  with-tests)
    if [[ ! -f $directory/build.ninja ]] || ! has_tests; then
      cmake --preset "$preset" -DDYNCAL_BUILD_TESTS=ON
    fi
    targets=(all)
    ;;
  programs)
    [[ $preset != release ]] || preset=programs
    [[ -f $directory/build.ninja ]] || cmake --preset "$preset" -DDYNCAL_BUILD_TESTS=OFF
    targets=(dyncal dyncal-acs dyncal-analysis dyncal-can dyncal-dau dyncal-dso dyncal-guard
      dyncal-recorder dyncal-virtual-bench guide
      dyncal_described        # manual pages, completion
      dyncal_analysis_models) # which no program links, but is installed
    if grep -q 'bin/dyncal-web' "$directory/build.ninja"; then # not without cpp-httplib
      targets+=(dyncal-web)
    fi
    ;;
  *)
    echo "build.sh: '$2' is neither with-tests nor programs" >&2
    exit 2
    ;;
esac
cmake --build "$directory" --parallel "$(nproc)" --target "${targets[@]}"
