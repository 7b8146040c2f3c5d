#!/usr/bin/env bash
# Run by package.sh, as root of a system with systemd in which dyncal is installed: starts services,
# installs the packages that are named, removes dyncal.
#
#   upgraded_daemons.sh PACKAGE...
set -euo pipefail
services=(dyncal-analysis dyncal-recorder dyncal-web dyncal-dau@acc-1)
programs="dyncal-analysis dyncal-dau dyncal-recorder dyncal-web"

fail() {
  echo "upgraded_daemons.sh: $*" >&2
  exit 1
}
processes() {
  systemctl show --value --property MainPID "${services[@]}" | grep -v '^$' | paste -sd ' '
}
# Names of dyncal's programs that run.
running() {
  local process
  for process in /proc/[0-9]*; do
    readlink "$process/exe" || true
  done 2>/dev/null | sed -n 's|^/usr/bin/dyncal|dyncal|p' | sort | paste -sd ' '
}
apt() { apt-get --yes -qq --no-install-recommends "$@" >/tmp/apt.log 2>&1 ||
  fail "apt-get $*: $(tail -n 5 /tmp/apt.log)"; }

systemctl enable --quiet --now "${services[@]}" || fail "$(journalctl -n 20 -o cat)"
before=$(processes)
[[ $(running) == "$programs" ]] || fail "runs: $(running)"
echo kept >/var/lib/dyncal-recorder/kept
echo 'DYNCAL_OPTIONS=--domain 5' >/etc/dyncal/options
settings=$(sha256sum /etc/dyncal/*)
old_version=$(dyncal --version | head -n 1)

apt install --reinstall "$@"
[[ $(running) == "$programs" ]] ||
  fail "after the upgrade runs: $(running)"
for process in $before; do
  [[ " $(processes) " != *" $process "* ]] || fail "the upgrade leaves an old program running"
done
systemctl is-active --quiet "${services[@]}" || fail "$(systemctl status "${services[@]}")"
[[ $(sha256sum /etc/dyncal/*) == "$settings" ]] || fail "the upgrade changes /etc/dyncal"
[[ $(cat /var/lib/dyncal-recorder/kept) == kept ]] || fail "the upgrade changes recordings"
echo "upgraded under systemd: $old_version, then $(dyncal --version | head -n 1); all run again"

apt remove dyncal dyncal-daemons dyncal-web
[[ -z $(running) ]] || fail "after removing runs: $(running)"
[[ $(sha256sum /etc/dyncal/*) == "$settings" && -f /var/lib/dyncal-recorder/kept ]] ||
  fail "removing takes away settings or recordings"
echo "removing stops every service, and leaves settings and recordings"
