#!/usr/bin/env python3
"""Runs whose programs are on hosts with clocks that are far apart, or step in the middle of a run.

    host_clocks_campaign.py PROGRAMS [--vendors cyclonedds,...] [--runs 3] [--short]

PROGRAMS is the folder of the built programs. Each program has a clock of its own by libfaketime
(Debian's package), which shifts UTC and leaves the monotonic clock as it is. Recorded files are
played; held: every run ends with 0, and its results are those of `dyncal analyse`, bit for bit.
And a live bench, whose steps are announced by one clock while dyncal-acs, whose clock is another,
is stopped for 2.6 s from the beginning of a step, so that its samples come late; held: the run ends
with 0 and every value, valid, without loss and flag, at the first attempt.
--short: three of the ten cases. Exit status 1 if one is not, 77 where libfaketime is not installed.
"""

import argparse
import functools
import glob
import pathlib
import shutil
import signal
import sys
import tempfile
import time

from bench_laboratory import VENDORS, BenchLaboratory, Failure
from played_laboratory import PlayedLaboratory

PROGRAMS = ("dyncal-analysis", "dyncal-acs", "dyncal")
FAR_APART = (
    {"dyncal-analysis": "-300", "dyncal-acs": "+3600", "dyncal": "+0"},
    {"dyncal-analysis": "+3600", "dyncal-acs": "+0", "dyncal": "-300"},
    {"dyncal-analysis": "+0", "dyncal-acs": "-300", "dyncal": "+3600"},
)
STEP_AFTER_S = 4.0
LATE_S = 2.6
APART_BY_AN_HOUR = {"dyncal-acs": "+3600", "dyncal": "-300"}


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


def one_live_run(programs, library, vendors, offsets, late_s):
    """With the samples of dyncal-acs late by this from the beginning of the second step."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-clocks-"))
    clocks = {one: FakedClock(library, folder, one) for one in offsets}
    for program, offset in offsets.items():
        clocks[program].set(offset)
    environments = {one: clock.environment for one, clock in clocks.items()}
    with BenchLaboratory(programs, folder, vendors, environments=environments) as laboratory:
        run = laboratory.run()
        run.wait_for_text("step 2 of")
        laboratory.services["dyncal-acs"].send(signal.SIGSTOP)
        time.sleep(late_s)
        laboratory.services["dyncal-acs"].send(signal.SIGCONT)
        status = run.wait()
        if status != 0:
            raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
        again = [one for one in laboratory.expect_whole_result() if "attempt" in one]
        if again:
            raise Failure(f"step {again[0]['step']} was excited again")
    shutil.rmtree(folder)


def cases():
    for offsets in FAR_APART:
        name = " ".join(f"{program} {offset} s," for program, offset in offsets.items())
        yield name, offsets, None
    for program in PROGRAMS:
        for step in ("+10", "-10"):
            yield f"{program} steps by {step} s", {}, (program, step)


def held_runs(arguments, name, vendors, one):
    """Whether all runs held; `one` is one of them."""
    held = 0
    for _ in range(arguments.runs):
        try:
            one()
            held += 1
        except Failure as failure:
            print(f"{name} {vendors}: {failure}", flush=True)
    print(f"{name} {vendors}: {held} of {arguments.runs} held", flush=True)
    return held == arguments.runs


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
    programs = arguments.programs.resolve()
    all_held = True
    chosen = list(cases())
    for name, offsets, stepping in chosen[:: len(chosen) - 1] if arguments.short else chosen:
        for vendors in arguments.vendors:
            run = functools.partial(one_run, programs, library, vendors, offsets, stepping)
            all_held &= held_runs(arguments, name, vendors, run)
    for vendors in arguments.vendors:
        run = functools.partial(
            one_live_run, programs, library, vendors, APART_BY_AN_HOUR, LATE_S
        )
        all_held &= held_runs(arguments, "live, dyncal-acs an hour ahead and late", vendors, run)
    return 0 if all_held else 1


if __name__ == "__main__":
    sys.exit(main())
