#!/usr/bin/env python3
"""What a program says where the system gives it too few threads, or too little memory.

    scarce_threads_test.py PROGRAMS VENDOR...

Starts each program with few threads allowed, up to those it has when it runs, and within
some sizes of address space: it runs, or ends with status 1 and a last line that names the remedy;
never by a signal, never with "terminate". A user's limit of threads does not count for root, who
starts the programs as another user; without that right and as root the test is skipped.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

USER = 54_321  # that nobody has: its processes are those of this test
SKIPPED = 77
PATIENCE_S = 60.0
PROGRAMS = {  # what they say when they run
    "dyncal-analysis": ([], "analysis ready"),
    "dyncal-web": (["--listen", "127.0.0.1:0"], "web ready"),
}
MEGABYTES = (60, 100, 150, 200, 300, 400)
REMEDIES = {"threads": "TasksMax", "memory": "MemoryMax"}


def can_be_another_user():
    if os.geteuid() != 0 or not shutil.which("setpriv") or not shutil.which("prlimit"):
        return False
    return subprocess.run(
        ["setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups", "true"], check=False,
        stderr=subprocess.DEVNULL,
    ).returncode == 0


def as_user(limit, command):
    return (
        ["setpriv", f"--reuid={USER}", f"--regid={USER}", "--clear-groups", "prlimit", limit]
        + command
    )


class Start:
    """Until the program says that it runs, has ended, or for PATIENCE_S."""

    def __init__(self, programs, name, vendor, limit):
        options, ready = PROGRAMS[name]
        command = [programs / name, "--dds", vendor, "--domain", str(own_dds_domain()), *options]
        with tempfile.NamedTemporaryFile() as log:
            process = subprocess.Popen(
                as_user(limit, command), stderr=log, stdout=log, stdin=subprocess.DEVNULL, cwd="/"
            )
            deadline = time.monotonic() + PATIENCE_S
            text = ""
            while process.poll() is None and ready not in text and time.monotonic() < deadline:
                time.sleep(0.02)  # between two looks at the condition
                text = pathlib.Path(log.name).read_text(encoding="utf-8", errors="replace")
            self.runs = process.poll() is None and ready in text
            self.hangs = process.poll() is None and not self.runs
            if process.poll() is None:
                status = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
                self.threads = int(status.split("Threads:")[1].split()[0])
                process.terminate()
            self.status = process.wait(PATIENCE_S)
            self.text = pathlib.Path(log.name).read_text(encoding="utf-8", errors="replace")

    def fault(self, remedy):
        if self.hangs:
            return "hangs"
        if self.runs:
            return ""
        last = self.text.strip().splitlines()[-1:]
        if self.status != 1 or "terminate" in self.text:
            return f"ended with {self.status}"
        if not last or remedy not in last[0]:
            return "names no remedy"
        return ""


def check(programs, name, vendor, limits, kind):
    faults, ran, refused = [], 0, 0
    for limit, what in limits:
        start = Start(programs, name, vendor, limit)
        fault = start.fault(REMEDIES[kind])
        ran, refused = ran + start.runs, refused + (not start.runs)
        if fault:
            faults.append(f"{name}, {vendor}, {what}: {fault}: {start.text[-400:]}")
    print(f"{name}, {vendor}, {kind}: {ran} ran, {refused} ended", flush=True)
    return faults if ran and refused else faults + [f"{name}, {vendor}, {kind}: no limit was met"]


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    if not can_be_another_user():
        print("SKIPPED: no right to start a program as another user, whose threads are limited")
        return SKIPPED
    faults = []
    for vendor in sys.argv[2:]:
        for name in PROGRAMS:
            whole = Start(programs, name, vendor, "--core=0")
            if not whole.runs:
                return f"{name} does not run without a limit either: {whole.text}"
            # DDS makes its threads first; those of the page's visitors are alike.
            few = [n for n in range(1, whole.threads + 1) if n <= 16 or n % 20 == 0]
            counts = [
                (f"--nproc={n}:{n}", f"{n} threads") for n in {*few, whole.threads}
            ]
            faults += check(programs, name, vendor, counts, "threads")
            sizes = [(f"--as={n << 20}", f"{n} MB") for n in (*MEGABYTES, 64_000)]
            faults += check(programs, name, vendor, sizes, "memory")
    return "\n".join(faults) if faults else 0


if __name__ == "__main__":
    sys.exit(main())
