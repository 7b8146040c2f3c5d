#!/usr/bin/env bash
# Makes Debian packages of the commit that is checked out, for the release that this runs on:
#
#   deploy/package.sh [FOLDER]        (no name: build-packages)
#
# Installs what is missing for that. The packages lie in FOLDER; their version is that of dyncal, if
# the commit has its tag, else one before it with the instant of the commit, so that each replaces
# those of older commits. lintian looks at them; its errors are a failure.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
folder=$(realpath -m "${1:-$top/build-packages}")

"$top/deploy/install-packages.sh" build package
. /etc/os-release

version=$(sed -n 's/^project(dyncal VERSION \([0-9.]*\) .*/\1/p' "$top/CMakeLists.txt")
commit=$(git -C "$top" rev-parse --short HEAD)
instant=$(git -C "$top" show -s --format=%ct HEAD)
package_version=$version
if ! git -C "$top" describe --exact-match --match "v$version" >/dev/null 2>&1; then
  package_version=$version~$(date --utc --date="@$instant" +%Y%m%d.%H%M%S)
fi

# A clone, so that --version knows the commit and nothing is packaged that is not committed.
source=$folder/source
rm -rf "$folder"
mkdir -p "$folder"
git clone --quiet --shared "$top" "$source"
cp -a "$source/deploy/debian" "$source/debian"
cat >"$source/debian/changelog" <<END
dyncal ($package_version-1+deb$VERSION_ID) $VERSION_CODENAME; urgency=medium

  * Commit $commit. What has changed since older versions: changelog.gz.

 -- dyncal developers <dyncal@example.org>  $(date --utc --date="@$instant" -R)
END

# debhelper builds with another home.
CCACHE_DIR=$(ccache --get-config cache_dir)
export CCACHE_DIR
if ! (cd "$source" &&
  DEB_BUILD_OPTIONS="noautodbgsym ${DEB_BUILD_OPTIONS:-}" \
    dpkg-buildpackage --build=binary --no-sign) >"$folder/build.log" 2>&1; then
  tail -n 40 "$folder/build.log" >&2
  echo "package.sh: the packages could not be built; see $folder/build.log" >&2
  exit 1
fi
lintian --fail-on error "$folder"/*.changes
ls -l "$folder"/*.deb
