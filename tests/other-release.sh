#!/usr/bin/env bash
# The first command of the README, and the tests of the bus, on the other release of Debian:
#
#   tests/other-release.sh [trixie|bookworm]
#
# The long form of what is tested, outside the test command: the release is installed into a folder
# ($DYNCAL_RELEASES, else /var/tmp/dyncal-releases, 4 GB) and what is committed is built there, a
# quarter of an hour of processor time for the first time. Kept: the system, the build, ccache.
# Exit status 77 where such a system cannot be made.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$top/tests/release_root.sh"

skip_without_root
codename=${1:-trixie}
if [[ $# -eq 0 ]] && grep -qsx 'VERSION_CODENAME=trixie' /etc/os-release; then
  codename=bookworm
fi
root=$releases/$codename
make_root "$root" "$codename"

in_root "$root" apt-get install --yes -qq --no-install-recommends git ccache
if [[ ! -d $root/dyncal ]]; then
  git clone --quiet --no-hardlinks "$top" "$root/dyncal"
fi
git -C "$root/dyncal" fetch --quiet "$top" HEAD
git -C "$root/dyncal" checkout --quiet --detach FETCH_HEAD

# As the README has it.
in_root "$root" nice -n "${DYNCAL_NICE:-19}" /dyncal/deploy/demo.sh

tests=(bus_parts_test rtps_screen_test bus_exchange_test bus_discovery_test bus_native_test
  full_reader_test lost_fragment_test stopped_participant_test)
in_root "$root" apt-get install --yes -qq --no-install-recommends \
  libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev fastddsgen
in_root "$root" nice -n "${DYNCAL_NICE:-19}" bash -c '
  cd /dyncal && cmake --preset programs -DDYNCAL_BUILD_TESTS=ON >/dev/null &&
    cmake --build build --target "$@"' build "${tests[@]}"
failed=()
for test in "${tests[@]}"; do
  in_root_alone "$root" "/dyncal/build/bin/$test" | tee "$root.$test.log" | tail -n 3
  grep -q '^\[  PASSED  \] [1-9]' "$root.$test.log" || failed+=("$test")
done
if [[ ${#failed[@]} -gt 0 ]]; then
  echo "other-release.sh: on $codename ${failed[*]} failed; see $root.*.log" >&2
  exit 1
fi
echo "other-release.sh: demo and ${#tests[@]} programs of bus tests passed on $codename"
