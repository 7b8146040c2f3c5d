"""What a process uses of the machine, from /proc."""

import dataclasses
import os
import pathlib

TICKS_PER_S = os.sysconf("SC_CLK_TCK")


@dataclasses.dataclass
class Figures:
    cpu_s: float
    resident_mb: float
    peak_mb: float
    descriptors: int
    threads: int


def figures(pid):
    place = pathlib.Path(f"/proc/{pid}")
    after_name = (place / "stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    status = dict(
        line.split(":", 1) for line in (place / "status").read_text(encoding="utf-8").splitlines()
    )
    return Figures(
        cpu_s=(int(after_name[11]) + int(after_name[12])) / TICKS_PER_S,
        resident_mb=int(status["VmRSS"].split()[0]) / 1024.0,
        peak_mb=int(status["VmHWM"].split()[0]) / 1024.0,
        descriptors=len(os.listdir(place / "fd")),
        threads=int(status["Threads"]),
    )
