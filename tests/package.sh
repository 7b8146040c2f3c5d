#!/usr/bin/env bash
# The Debian packages in a clean release of Debian, from `apt install` to a calibration, and away
# again:
#
#   tests/package.sh [bookworm|trixie] [FOLDER [OLDER]]
#
# The long form of what is tested, outside the test command. Without FOLDER, which has the packages,
# deploy/package.sh makes them: here, if this machine runs that release (the one of this machine if
# none is named), else in the system of tests/other-release.sh, which is then to be run before.
# OLDER has those of an older version, which the upgrade begins with.
#
# Held: what is installed beside the dependencies and the result of the demo are there in less than
# 60 s; every program tells its version; units are right and have little exposure; an upgrade keeps
# what is in /etc/dyncal and what was recorded, and restarts what runs under systemd; removing stops
# it; purging leaves no other file and no user, and names
# what it leaves; what deploy/Containerfile runs serves its page without root, in a system that
# cannot be written to, and ends when it is told. Exit status 77 where such a system cannot be made.
set -euo pipefail
if [[ $EUID -eq 0 && ! ${DYNCAL_OWN_MOUNTS:-} ]]; then
  DYNCAL_OWN_MOUNTS=1 exec unshare --mount "$0" "$@"
fi
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
. "$top/tests/release_root.sh"

skip_without_root
here=$(. /etc/os-release && echo "$VERSION_CODENAME")
codename=${1:-$here}
folder=${2:-}
older=${3:-}
if [[ -z $folder && $codename == "$here" ]]; then
  folder=$top/build-packages
  "$top/deploy/package.sh" "$folder"
elif [[ -z $folder ]]; then
  folder=$releases/$codename/dyncal/build-packages
  in_root "$releases/$codename" /dyncal/deploy/package.sh
fi

# A clean system, and in it what the packages depend on, which is not counted.
clean=$releases/$codename-clean
make_root "$clean" "$codename"
rm -f "$clean"/opt/*.deb
cp "$folder"/*.deb "$clean/opt/"
packages=()
for package in "$clean"/opt/*.deb; do
  packages+=("/opt/$(basename "$package")")
done
mapfile -t needed < <(in_root "$clean" apt-get install --simulate --no-install-recommends \
  "${packages[@]}" | sed -n 's/^Inst \([^ ]*\) .*/\1/p' | grep -v dyncal)
[[ ${#needed[@]} -eq 0 ]] ||
  in_root "$clean" apt-get install --yes -qq --no-install-recommends "${needed[@]}" >/dev/null

root=$(mktemp -d "$releases/package.XXXXXX")
mount -t tmpfs tmpfs "$root" # also holds what is written: nothing is left behind
trap 'umount --recursive "$root" && rmdir "$root"' EXIT
# A system like the clean one, that can be written to.
make_system() {
  mkdir "$root/$1" "$root/$1-written" "$root/$1-work"
  mount -t overlay overlay \
    -o "lowerdir=$clean,upperdir=$root/$1-written,workdir=$root/$1-work" "$root/$1"
}
make_system system
system=$root/system

fail() {
  echo "package.sh: $*" >&2
  exit 1
}
run() { in_root "$system" "$@"; }
apt() { run apt-get --yes -qq --no-install-recommends "$@" >"$root/apt.log" 2>&1 ||
  fail "apt-get $*: $(tail -n 5 "$root/apt.log")"; }
# Files, users and groups, without what apt itself keeps.
state() {
  run find / -xdev \( -path /proc -o -path /dev -o -path /sys -o -path /run -o -path /tmp \
    -o -path /opt -o -path /var/cache -o -path /var/log -o -path /var/lib/apt \
    -o -path /var/lib/dpkg -o -path /root \) -prune -o -print | sort
  run find /var/cache -path '*dyncal*'
  run find /var/lib/dpkg -name '*dyncal*'
  run cut -d : -f 1 /etc/passwd /etc/group
}

state >"$root/before"

begin=$(date +%s%N)
apt install "${packages[@]}"
in_root_alone "$system" sh -c 'cd /root && dyncal demo' >"$root/demo.log" 2>&1 ||
  fail "dyncal demo: $(tail -n 5 "$root/demo.log")"
milliseconds=$((($(date +%s%N) - begin) / 1000000))
tail -n 4 "$root/demo.log"
find "$system/root" -name '*.svg' | grep -q . || fail "the demo has made no figure"
echo "from apt install to the demo's figure: $milliseconds ms"
[[ $milliseconds -lt 60000 ]] || fail "that is more than 60 s"

commit=$(git -C "$top" rev-parse --short HEAD)
for program in "$system"/usr/bin/dyncal*; do
  version=$(run "/usr/bin/$(basename "$program")" --version | head -n 1)
  [[ $version == *"$commit"* || -n ${2:-} ]] || fail "$(basename "$program"): $version"
done
echo "$version"

mapfile -t units < <(cd "$system" && run sh -c 'dpkg -L dyncal-daemons dyncal-web' |
  grep '\.service$')
[[ ${#units[@]} -eq 8 ]] || fail "8 units expected: ${units[*]}"
for unit in "${units[@]}"; do
  run systemd-analyze verify "$unit" || fail "$unit is not right"
  most=15
  [[ $unit != *dyncal-can@* ]] || most=20
  run systemd-analyze security --offline=true --threshold=$most "$unit" | tail -n 1
done
run getent passwd dyncal >/dev/null || fail "there is no user dyncal"
run getent group dyncal >/dev/null || fail "there is no group dyncal"

# As the container of deploy/Containerfile: what it has, and the user that it runs as.
run install -d -o dyncal -g dyncal /var/lib/dyncal
cp "$top/deploy/container-host.sh" "$system/usr/local/bin/dyncal-host"
cat >"$system/opt/ask.sh" <<'END'
dyncal-host >/var/lib/dyncal/log 2>&1 &
host=$!
for ((tries = 0; tries < 300; ++tries)); do
  exec 3<>/dev/tcp/127.0.0.1/8080 && break
  read -rt 0.1 <> <(:)
done 2>/dev/null
printf 'GET / HTTP/1.0\r\nHost: localhost\r\n\r\n' >&3 && head -n 1 <&3
kill "$host"
wait "$host"
echo "ended with $?"
END
unshare --mount --pid --net --fork --kill-child bash -c '
  set -e
  ip link set lo up
  mount --bind "$1" "$1"
  mount -o remount,bind,ro "$1"
  mount --bind "$2" "$1/var/lib/dyncal"
  mount -t proc proc "$1/proc"
  mount --bind /dev "$1/dev"
  exec chroot --userspec=dyncal:dyncal "$1" env -i PATH=/usr/local/bin:/usr/bin:/bin \
    DYNCAL_RUNS=/var/lib/dyncal/runs bash /opt/ask.sh
' container "$system" "$root/system-written/var/lib/dyncal" >"$root/container.log" 2>&1 || true
grep -q ' 200 ' "$root/container.log" && grep -qx 'ended with 0' "$root/container.log" ||
  fail "the container: $(cat "$root/container.log" "$system/var/lib/dyncal/log")"
rm -r "$system/var/lib/dyncal" "$system/usr/local/bin/dyncal-host"
echo "what the container runs serves its page, and ends"

# What a laboratory has there.
mkdir -p "$system/var/lib/private/dyncal-recorder" "$system/var/lib/private/dyncal-guard" \
  "$system/var/cache/private/dyncal-dau-acc-1" "$system/etc/systemd/system/multi-user.target.wants"
ln -s private/dyncal-recorder private/dyncal-guard "$system/var/lib/"
ln -s "${units[0]%@.service}@.service" \
  "$system/etc/systemd/system/multi-user.target.wants/dyncal-acs@acc-1.service"
for file in etc/dyncal/acc-1.toml etc/dyncal/options etc/dyncal/dyncal-web.options \
  var/lib/private/dyncal-recorder/run.mcap var/lib/private/dyncal-guard/driven; do
  echo kept >"$system/$file"
done
apt install --reinstall "${packages[@]}"
for file in etc/dyncal/acc-1.toml etc/dyncal/options var/lib/dyncal-recorder/run.mcap; do
  [[ $(cat "$system/$file") == kept ]] || fail "an upgrade changes $file"
done

apt remove $(run sh -c 'dpkg-query -W -f "\${Package} " "*dyncal*"')
[[ -f $system/etc/dyncal/options ]] || fail "removing takes settings away"
apt purge $(run sh -c 'dpkg-query -W -f "\${Package} " "*dyncal*"')
grep 'left in' "$root/apt.log" || fail "purging does not say what it leaves"
state >"$root/after"
printf '%s\n' /etc/dyncal /etc/dyncal/acc-1.toml /etc/systemd/system/multi-user.target.wants \
  /var/lib/dyncal-recorder /var/lib/private /var/lib/private/dyncal-recorder \
  /var/lib/private/dyncal-recorder/run.mcap | sort >"$root/meant"
left=$({ diff "$root/before" "$root/after" || true; } | sed -n 's/^[<>] //p' | sort |
  comm -23 - "$root/meant")
[[ -z $left ]] || fail "purging leaves, or takes away:"$'\n'"$left"
# Under systemd.
make_system booted
. "$top/tests/booted_root.sh"
run_booted() { in_booted_root "$root/booted" "$@"; }
begin=("${packages[@]}")
if [[ $older ]]; then
  mkdir "$root/booted/opt/older"
  cp "$older"/*.deb "$root/booted/opt/older/"
  mapfile -t begin < <(cd "$root/booted" && printf '/%s\n' opt/older/*.deb)
fi
in_root "$root/booted" apt-get --yes -qq --no-install-recommends install "${begin[@]}" \
  >"$root/apt.log" 2>&1 || fail "installing what is upgraded: $(tail -n 5 "$root/apt.log")"
sed '/^interface/d' "$top/deploy/example-lab/acc-1.toml" >"$root/booted/etc/dyncal/acc-1.toml"
cp "$top/tests/upgraded_daemons.sh" "$root/booted/opt/"
run_booted bash /opt/upgraded_daemons.sh "${packages[@]}" || fail "the upgrade under systemd"

echo "package.sh: packages and ${#units[@]} units are right on $codename"
