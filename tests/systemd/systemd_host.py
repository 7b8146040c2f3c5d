"""A host with systemd as its first process, in namespaces of its own: dyncal is installed there.

Its files are those of this machine, with the installation in /usr/local; what is written there is
gone when it ends, but for the folder that it shares. It has a loopback interface and no other
network, and starts none of this machine's services. Needs root, overlayfs, a cgroup hierarchy of
version 2 and Debian's systemd; why_not() tells what is missing.
"""

import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from bench_laboratory import Failure, wait_until  # noqa: E402

SYSTEMD = "/lib/systemd/systemd"
BOOT = """
set -e
mount --make-rprivate /
mkdir -p "$1/layers" "$1/root"
mount -t tmpfs tmpfs "$1/layers"
mkdir "$1/layers/upper" "$1/layers/work"
mount -t overlay overlay "$1/root" \
  -o "lowerdir=/,upperdir=$1/layers/upper,workdir=$1/layers/work"
cd "$1/root"
mount --bind "$1/installed/usr/local" usr/local
mount -t proc proc proc
mount -t sysfs sysfs sys
mount -t cgroup2 cgroup2 sys/fs/cgroup
mount -t tmpfs tmpfs run
mount -t tmpfs tmpfs tmp
mount -t tmpfs tmpfs dev
mkdir dev/pts dev/shm
for device in null zero full random urandom tty; do
  touch "dev/$device"
  mount --bind "/dev/$device" "dev/$device"
done
ln -s /proc/self/fd dev/fd
ln -s pts/ptmx dev/ptmx
mkdir -p "./$2" etc/dyncal
mount --bind "$2" "./$2"
rm -rf etc/systemd/system/*.wants etc/systemd/system/*.requires etc/fstab
: > etc/machine-id
mkdir -p machine
pivot_root . machine
umount --lazy machine
export container=dyncal-test
exec "$3" --system --unit=basic.target --log-target=journal --show-status=0
"""
NAMESPACES = ("--pid", "--mount", "--uts", "--ipc", "--net", "--cgroup")


def why_not():
    """One sentence if such a host cannot be made here, else nothing."""
    if os.geteuid() != 0:
        return "needs root"
    for program in (SYSTEMD, "unshare", "nsenter", "systemctl"):
        if shutil.which(program) is None:
            return f"there is no {program}"
    tried = subprocess.run(
        ["unshare", *NAMESPACES, "--fork", "sh", "-c", "mount -t cgroup2 cgroup2 /sys/fs/cgroup"],
        check=False,
        capture_output=True,
        text=True,
    )
    return "this machine makes no such namespaces" if tried.returncode else ""


class SystemdHost:
    """`folder` keeps its files; `build` is what `cmake` installs to /usr/local."""

    def __init__(self, folder, build, cmake):
        self.shared = folder / "shared"
        self.shared.mkdir(parents=True)
        subprocess.run(
            [cmake, "--install", build, "--prefix", "/usr/local", "--component", "programs"],
            check=True,
            capture_output=True,
            env={**os.environ, "DESTDIR": str(folder / "installed")},
        )
        self.holder = subprocess.Popen(
            ["unshare", *NAMESPACES, "--fork", "--kill-child", "bash", "-c", BOOT, "boot"]
            + [str(folder), str(self.shared), SYSTEMD],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.first_process = ""
        try:
            wait_until(self.has_booted, "systemd to start basic.target", 60.0)
        except Failure:
            self.close()
            raise

    def has_booted(self):
        if self.holder.poll() is not None:
            raise Failure(f"the host has ended: {self.holder.stderr.read().strip()}")
        pid = self.holder.pid
        children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="utf-8")
        self.first_process = children.strip()
        if not self.first_process or self.name_of_first_process() != "systemd":
            return False
        return self.call("systemctl", "is-active", "basic.target").returncode == 0

    def name_of_first_process(self):
        comm = pathlib.Path(f"/proc/{self.first_process}/comm")
        return comm.read_text(encoding="utf-8").strip() if comm.exists() else ""

    def command(self, *command):
        """The same, in this host."""
        entered = ("--mount", "--pid", "--net", "--uts", "--ipc", "--cgroup", "--root", "--wd")
        return ["nsenter", "--target", self.first_process, *entered, *map(str, command)]

    def call(self, *command):
        return subprocess.run(
            self.command(*command), check=False, capture_output=True, text=True, timeout=120.0
        )

    def systemctl(self, *arguments):
        done = self.call("systemctl", *arguments)
        if done.returncode != 0:
            raise Failure(f"systemctl {' '.join(arguments)}: {done.stderr.strip()}")
        return done.stdout.strip()

    def show(self, unit, name):
        return self.systemctl("show", unit, "--value", "--property", name)

    def journal(self, unit):
        return self.call("journalctl", "--unit", unit, "--output", "cat", "--no-pager").stdout

    def write(self, path, text):
        place = pathlib.Path(f"/proc/{self.first_process}/root/{path}")
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")

    def signal_unit(self, unit, number):
        self.systemctl("kill", "--kill-whom", "main", "--signal", number.name, unit)

    def close(self):
        with contextlib.suppress(ProcessLookupError, ValueError):
            os.kill(int(self.first_process), signal.SIGKILL)
        self.holder.kill()
        self.holder.wait()
