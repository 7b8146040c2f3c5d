#!/usr/bin/env bash
# Runs a command as root on a kernel that has CAN:
#
#   on_can_kernel.sh [-s XSAVE_SHIM] [-m MEGABYTES] [-t SECONDS] [-w WRITABLE_FOLDER] [-g|-i]
#                    COMMAND ARGUMENTS...
#
# On this kernel, in a network namespace of its own, where it has vcan and we may; otherwise in a
# User-Mode-Linux guest that sees the files of this machine read-only: DYNCAL_CAN_KERNEL, else the
# one that build-guest.sh has built, else /usr/bin/linux.uml of Debian's package user-mode-linux.
# -g: only in the guest that build-guest.sh has built (USB adapters), and in simulated time:
# sleeping costs nothing, computing takes no time, the clock starts at the same instant every time.
# -i: in simulated time if the guest has it. Exit status: the command's; 77 with a line "skipped:
# ..." where there is neither; 125 when the guest did not come to an end.
set -uo pipefail

shim= memory=512 limit=120 writable= built_only= simulated=
while getopts s:m:t:w:gi option; do
  case $option in
    s) shim=$OPTARG ;;
    m) memory=$OPTARG ;;
    t) limit=$OPTARG ;;
    w) writable=$(realpath "$OPTARG") ;;
    g) built_only=yes simulated=yes ;;
    i) simulated=yes ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))

if [[ -z $built_only && $EUID -eq 0 ]] &&
  unshare --net ip link add probe0 type vcan 2>/dev/null; then
  exec unshare --net bash -c 'ip link set lo up
    ip link set lo multicast on
    ip route add 224.0.0.0/4 dev lo
    exec "$@"' - "$@"
fi

built=${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/dyncal/linux-can
[[ -x $built ]] || built=
kernel=${DYNCAL_CAN_KERNEL:-${built:-/usr/bin/linux.uml}}
# A kernel lists its options in its file; that of the package has no simulated time.
clock=()
if [[ -n $simulated && -x $kernel ]] && grep -q 'time-travel=inf-cpu' "$kernel"; then
  clock=(time-travel=inf-cpu time-travel-start=1700000000000000000)
elif [[ -n $built_only ]]; then
  echo "skipped: needs a guest kernel with USB adapters and simulated time;" \
    "tests/can/build-guest.sh builds it"
  exit 77
fi
for needed in "$kernel" /usr/bin/busybox; do
  if [[ ! -x $needed && ! -x ${needed/usr\//} ]]; then
    echo "skipped: this kernel has no vcan that this user may make, and $needed is not there" \
      "(apt-get install user-mode-linux busybox-static)"
    exit 77
  fi
done

folder=$(mktemp -d "${TMPDIR:-/tmp}/can-guest.XXXXXX")
trap 'rm -rf "$folder"' EXIT
printf '%q ' "$@" >"$folder/command"
printf '%s' "$writable" >"$folder/writable"
printf '%s' "$PWD" >"$folder/directory"
export -p | grep -E ' (PATH|DYNCAL_[A-Z_]*|GTEST_[A-Z_]*|HOME)=' >"$folder/environment"

cat >"$folder/init" <<'INIT'
#!/bin/bash
# First program of the guest. $1: the folder of the host with the command, where the exit status
# goes.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t tmpfs tmpfs /run
mount -t devtmpfs devtmpfs /dev 2>/dev/null
mkdir -p /dev/pts /dev/shm /run/host
mount -t devpts devpts /dev/pts
mount -t tmpfs tmpfs /dev/shm
mount_host() { # folder, place; by newer kernels it has a name
  mount -t hostfs -o "$1" none "$2" 2>/dev/null || mount -t hostfs -o "hostfs=$1" none "$2"
}
mount_host "$1" /run/host
writable=$(cat /run/host/writable)
[[ -z $writable ]] || mount_host "$writable" "$writable"
modules=/usr/lib/uml/modules/$(uname -r)/kernel
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan \
  drivers/net/can/vxcan \
  drivers/net/can/slcan/slcan net/sched/sch_netem; do
  [[ ! -e $modules/$module.ko ]] || busybox insmod "$modules/$module.ko"
done
ip link set lo up
ip link set lo multicast on
ip route add 224.0.0.0/4 dev lo
(
  . /run/host/environment
  export TMPDIR=/run
  cd "$(cat /run/host/directory)"
  eval "$(cat /run/host/command)"
) </dev/null
echo $? >/run/host/status
sync
exec busybox poweroff -f
INIT
chmod +x "$folder/init"

# The guest's console is our output; its memory is a file that is gone when it ends.
memory_folder=/dev/shm
[[ -w $memory_folder ]] || memory_folder=$folder
# Every system call of the guest is handed from one process of the host to another: several times
# faster when both have one processor. Not the same for every guest.
mapfile -t processors < <(taskset -cp $$ | sed 's/.*: //' | tr ',' '\n' |
  while IFS=- read -r first last; do seq "$first" "${last:-$first}"; done)
processor=${processors[$(($$ % ${#processors[@]}))]}
timeout --kill-after=5 "$limit" taskset -c "$processor" \
  env -i HOME="$folder" PATH="$PATH" TMPDIR="$memory_folder" ${shim:+LD_PRELOAD="$shim"} \
  "$kernel" "mem=${memory}M" quiet loglevel=1 "${clock[@]}" \
  root=/dev/root rootfstype=hostfs rootflags=/ ro "init=$folder/init" \
  con=null con0=null,fd:1 -- "$folder" </dev/null 2>&1 |
  grep --line-buffered -vE '^reboot: System halted|^$' | tr -d '\r'
if [[ -s $folder/status ]]; then
  exit "$(cat "$folder/status")"
fi
echo "the guest did not come to an end within $limit s" >&2
exit 125
