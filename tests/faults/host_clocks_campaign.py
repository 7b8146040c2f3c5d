#!/usr/bin/env python3
"""Runs whose programs are on hosts with clocks that are far apart, or step in the middle of a run.

    host_clocks_campaign.py PROGRAMS [--vendors cyclonedds,...] [--runs 3] [--short]

PROGRAMS is the folder of the built programs. Each program has a clock of its own by libfaketime
(Debian's package), which shifts UTC and leaves the monotonic clock as it is. Recorded files are
played; held: every run ends with 0, and its results are those of `dyncal analyse`, bit for bit.
--short: two of the nine cases. Exit status 1 if one is not, 77 where libfaketime is not installed.
"""

import argparse
import glob
import pathlib
import shutil
import sys
import tempfile
import time

from bench_laboratory import VENDORS, Failure
from played_laboratory import PlayedLaboratory

PROGRAMS = ("dyncal-analysis", "dyncal-acs", "dyncal")
FAR_APART = (
    {"dyncal-analysis": "-300", "dyncal-acs": "+3600", "dyncal": "+0"},
    {"dyncal-analysis": "+3600", "dyncal-acs": "+0", "dyncal": "-300"},
    {"dyncal-analysis": "+0", "dyncal-acs": "-300", "dyncal": "+3600"},
)
STEP_AFTER_S = 4.0


def faketime_library():
    found = glob.glob("/usr/lib/*/faketime/libfaketimeMT.so.1")
    return found[0] if found else None


class FakedClock:
    """What UTC is for one program: `offset` seconds off, from the last set() on."""

    def __init__(self, library, folder, program):
        self.file = folder / f"{program}.clock"
        self.set("+0")
        self.environment = {
            "LD_PRELOAD": library,
            "FAKETIME_TIMESTAMP_FILE": str(self.file),
            "FAKETIME_NO_CACHE": "1",
            "DONT_FAKE_MONOTONIC": "1",
        }

    def set(self, offset):
        beside = self.file.with_suffix(".new")
        beside.write_text(offset + "\n", encoding="utf-8")
        beside.rename(self.file)


def one_run(programs, library, vendors, offsets, stepping):
    """`offsets` by program; `stepping` a program and by how much, or nothing."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-clocks-"))
    with PlayedLaboratory(programs, folder, vendors) as laboratory:
        clocks = {one: FakedClock(library, folder, one) for one in PROGRAMS}
        for program, offset in offsets.items():
            clocks[program].set(offset)
        for service in ("dyncal-analysis", "dyncal-acs"):
            laboratory.service(service, clocks[service].environment)
        run = laboratory.run(clocks["dyncal"].environment)
        if stepping:
            time.sleep(STEP_AFTER_S)  # into the run
            if not run.runs():
                raise Failure(f"the run ended before the clock stepped: {run.errors()}")
            clocks[stepping[0]].set(stepping[1])
        laboratory.expect_same_bits(run)
    shutil.rmtree(folder)


def cases():
    for offsets in FAR_APART:
        name = " ".join(f"{program} {offset} s," for program, offset in offsets.items())
        yield name, offsets, None
    for program in PROGRAMS:
        for step in ("+10", "-10"):
            yield f"{program} steps by {step} s", {}, (program, step)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--short", action="store_true")
    arguments = parser.parse_args()
    library = faketime_library()
    if library is None:
        print("skipped: libfaketime is not installed (Debian package: faketime)")
        return 77
    all_held = True
    chosen = list(cases())
    for name, offsets, stepping in chosen[:: len(chosen) - 1] if arguments.short else chosen:
        for vendors in arguments.vendors:
            held = 0
            for _ in range(arguments.runs):
                try:
                    one_run(arguments.programs.resolve(), library, vendors, offsets, stepping)
                    held += 1
                except Failure as failure:
                    print(f"{name} {vendors}: {failure}", flush=True)
            print(f"{name} {vendors}: {held} of {arguments.runs} with the same bits", flush=True)
            all_held &= held == arguments.runs
    return 0 if all_held else 1


if __name__ == "__main__":
    sys.exit(main())
