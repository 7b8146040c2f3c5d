#!/usr/bin/env bash
# What is committed, built in two folders of other names, must give the same bytes:
#
#   tests/reproducible.sh [TARGET...]     (no name: dyncal_analysis dyncal-dau)
#   tests/reproducible.sh --packages      the Debian packages
#
# The long form of what is tested, outside the test command. Targets are compiled without ccache,
# which would hand out what the first folder has compiled. Packages are made by deploy/package.sh
# with it, so that only the first takes long: there it is what is put into them that is held.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
targets=("$@")
[[ $# -gt 0 ]] || targets=(dyncal_analysis dyncal-dau)

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for place in "$folder/one" "$folder/another/of-a-longer-name"; do
  git clone --quiet --shared "$top" "$place"
  if [[ ${targets[0]} == --packages ]]; then
    "$place/deploy/package.sh" "$place/build" >"$folder/log" 2>&1 ||
      { tail "$folder/log" && exit 1; }
    rm -rf "$place/build/source"
  else
    (cd "$place" && cmake --preset programs >/dev/null &&
      CCACHE_DISABLE=1 cmake --build build --target "${targets[@]}" >"$folder/log") ||
      { tail "$folder/log" && exit 1; }
  fi
  (cd "$place/build" &&
    find . \( -name '*.o' -o -name '*.a' -o -path './bin/*' -o -name '*.deb' \) -type f \
      -exec sha256sum {} + | sort -k 2) >"$place.sums"
done
grep -qE '\.(a|deb)$' "$folder/one.sums" || { echo "nothing was built" && exit 1; }
diff "$folder/one.sums" "$folder/another/of-a-longer-name.sums" ||
  { echo "reproducible.sh: these differ" && exit 1; }
echo "reproducible.sh: $(wc -l <"$folder/one.sums") files have the same bytes in two folders"
