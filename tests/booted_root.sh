# Sourced by tests that need systemd in a system of their own.

# in_booted_root FOLDER COMMAND...: there, with systemd as the first process and a loopback
# interface alone; all ends with the command. FOLDER must be a mount point.
in_booted_root() {
  local root=$1 holder first status=0 tries
  shift
  unshare --mount --pid --uts --ipc --net --cgroup --fork --kill-child bash -c '
    set -e
    ip link set lo up multicast on
    cd "$1"
    mount -t proc proc proc
    mount -t sysfs sysfs sys
    mount -t cgroup2 cgroup2 sys/fs/cgroup
    for folder in run tmp dev; do mount -t tmpfs tmpfs "$folder"; done
    mkdir dev/pts dev/shm
    for device in null zero full random urandom tty; do
      touch "dev/$device"
      mount --bind "/dev/$device" "dev/$device"
    done
    ln -s /proc/self/fd dev/fd
    ln -s pts/ptmx dev/ptmx
    mkdir -p machine
    pivot_root . machine
    umount --lazy machine
    exec env -i container=test PATH=/usr/sbin:/usr/bin:/sbin:/bin /lib/systemd/systemd --system \
      --unit=basic.target --log-target=journal --show-status=0
  ' in_booted_root "$root" </dev/null &
  holder=$!
  for ((tries = 0; tries < 600; ++tries)); do
    first=$(cat "/proc/$holder/task/$holder/children" 2>/dev/null || true)
    [[ ! $first ]] || ! in_host "${first% }" systemctl is-active --quiet basic.target 2>/dev/null ||
      break
    sleep 0.1
  done
  in_host "${first% }" "$@" || status=$?
  kill -9 "${first% }" "$holder" 2>/dev/null || true
  wait "$holder" 2>/dev/null || true
  return "$status"
}

in_host() { # its first process, command
  nsenter --target "$1" --mount --pid --net --uts --ipc --cgroup --root --wd env -i \
    PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive "${@:2}"
}
