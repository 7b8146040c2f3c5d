#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test:
#
#   tests/run.sh [--sanitize | --thread-sanitize | --changed] [options of ctest, e.g. -R sine]
#
# --sanitize         with the address and undefined-behaviour sanitizers
# --thread-sanitize  with the thread sanitizer, without what measures load, waits for packet loss
#                    or computes for minutes
# --changed          builds and runs only what is reached by changes since the branch left its
#                    upstream, committed or not (tests/changed/changed_tests.py)
#
# Sanitizers have build directories of their own. Tests that must have the machine to themselves
# carry ctest's RUN_SERIAL. The exit status is that of ctest; the last lines name every test that
# was skipped and why, and show how the output of each failed one ends.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
directory=build
left_out=()
chosen=
case ${1:-} in
  --sanitize)
    shift
    preset=sanitize
    # Fast DDS deletes some objects through a type of another size than they were made with, by
    # design. A test of host clocks loads a library before the sanitizer's.
    ASAN_OPTIONS=new_delete_type_mismatch=0:detect_leaks=1:detect_stack_use_after_return=1
    export ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0
    # Leaks of the libraries that we do not build; a leak of our own is a failure.
    export LSAN_OPTIONS=suppressions=$PWD/tests/sanitize/leaks.supp:print_suppressions=0
    export UBSAN_OPTIONS=print_stacktrace=1
    # The sanitizer writes the names of source files into programs.
    left_out=(--exclude-regex '^Install\.Files$')
    ;;
  --thread-sanitize)
    shift
    preset=thread-sanitize
    # Libraries that we do not build (both DDS implementations, libstdc++) are not compiled with the
    # sanitizer. What they do to memory by malloc, memcpy and the like is not looked at: what orders
    # it, atomics for instance, cannot be seen. Their locks and threads are seen and order what we
    # do in their callbacks, so that a race of our own there is found; no suppression is needed. One
    # by library (called_from_lib) would lose their locks, and find races where there are none.
    export TSAN_OPTIONS=ignore_noninstrumented_modules=1:second_deadlock_stack=1
    # Programs run ten times slower: what depends on keeping up says nothing here, and what computes
    # for minutes would take hours.
    slow='dau_load|analyse_speed|bus_netns_test|progress_cost|Coverage|Style|Install'
    left_out=(--exclude-regex "^(($slow)\\.|CommandLine\\.progress)")
    ;;
  --changed)
    shift
    chosen=$(mktemp)
    ;;
esac
[[ $preset == release ]] || directory=build-$preset

output=$(mktemp)
trap 'rm -f "$output" $chosen' EXIT
if [[ $chosen ]]; then
  tests/changed/changed_tests.py --build "$directory" --chosen "$chosen"
  left_out=(-I "$chosen")
else
  deploy/install-packages.sh build test
  deploy/build.sh "$preset" with-tests
fi
status=0
# Tests wait more than they compute: five at once do not fill two processors.
ctest --test-dir "$directory" --parallel 5 --output-on-failure --no-tests=error "${left_out[@]}" \
  "$@" 2>&1 | tee "$output" || status=${PIPESTATUS[0]}
tests/summary.sh "$output" "$directory/Testing/Temporary/LastTest.log"
exit "$status"
