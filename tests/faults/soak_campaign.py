#!/usr/bin/env python3
"""Runs one after another for an hour: what the daemons use must not grow.

    soak_campaign.py PROGRAMS [--minutes 60] [--vendors cyclonedds]

PROGRAMS is the folder of the built programs. Held: every run ends with 0, and from the end of the
tenth run (or a quarter of the time) to the last, no daemon gains a descriptor or a thread, and none
more than 5 % and 5 MB of resident memory. What the sources keep of the last ten minutes is memory
that grows for ten minutes and then stays: shorter soaks see that. Exit status 1 if it did not hold.
"""

import argparse
import pathlib
import shutil
import sys
import tempfile
import time

from bench_laboratory import SERVICES, VENDORS, BenchLaboratory, Failure
from process_figures import figures

SETTLED_RUNS = 10
GROWTH_REL = 0.05
GROWTH_MB = 5.0


def used(laboratory):
    return {one: figures(laboratory.services[one].process.pid) for one in SERVICES}


def judge(before, after):
    problems = []
    for service, then in before.items():
        now = after[service]
        print(
            f"    {service:16} {then.resident_mb:6.1f} -> {now.resident_mb:6.1f} MB, "
            f"{then.descriptors} -> {now.descriptors} descriptors, "
            f"{then.threads} -> {now.threads} threads, {now.cpu_s:.0f} s of processor",
            flush=True,
        )
        growth_mb = now.resident_mb - then.resident_mb
        if growth_mb > GROWTH_MB and growth_mb > GROWTH_REL * then.resident_mb:
            problems.append(f"{service} has grown by {growth_mb:.1f} MB")
        if now.descriptors > then.descriptors or now.threads > then.threads:
            problems.append(f"{service} has more descriptors or threads")
    return problems


def soak(arguments, vendors):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-soak-"))
    until_s = time.monotonic() + 60.0 * arguments.minutes
    settled_s = time.monotonic() + 15.0 * arguments.minutes
    settled, runs = None, 0
    with BenchLaboratory(arguments.programs, folder, vendors) as laboratory:
        while time.monotonic() < until_s or runs <= SETTLED_RUNS:
            run = laboratory.run()
            status = run.wait()
            laboratory.started.remove(run)
            if status != 0:
                raise Failure(f"run {runs}: exit status {status}: {run.errors().strip()[-300:]}")
            runs += 1
            if settled is None and runs >= SETTLED_RUNS and time.monotonic() > settled_s:
                settled = used(laboratory)
        problems = judge(settled, used(laboratory))
    if problems:
        raise Failure("; ".join(problems))
    shutil.rmtree(folder)
    print(f"{vendors}: {runs} runs in {arguments.minutes:g} min hold", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=["cyclonedds"])
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    held = True
    for vendors in arguments.vendors:
        try:
            soak(arguments, vendors)
        except Failure as failure:
            print(f"{vendors}: {failure}", flush=True)
            held = False
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
