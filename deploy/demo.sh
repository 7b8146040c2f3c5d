#!/usr/bin/env bash
# Installs what is missing, builds, and runs a whole calibration on a virtual bench:
#
#   deploy/demo.sh [options of `dyncal demo`]
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

"$top/deploy/install-packages.sh" build
"$top/deploy/build.sh" release programs
exec "$top/build/bin/dyncal" demo "$@"
