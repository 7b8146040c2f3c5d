#!/usr/bin/env python3
"""Do closures close? Clean calibrations of every method through `dyncal analyse`: at most one open
closure in all of them.

    closures.py BUILD/bin/dyncal                        short: 10 of each class (test command)
    closures.py BUILD/bin/dyncal --draws 300 --seed 7   long: 20 minutes of processor time

Prints how many of each kind close, are open and are not possible. Exit status 1: too many are open,
or a kind never closes although the classes allow it; 77: numpy is not installed.
"""

import argparse
import collections
import multiprocessing
import os
import pathlib
import shutil
import sys
import tempfile

from analysed_folder import PROCESSES, analysed
from bench_simulator import Calibration
from coverage import SEED, seed_of
from fault_classes import CLASSES

CLEAN = (
    "clean",
    "clean, analogue",
    "clean, absolute time",
    "clean, series",
    "mean of 3",
    "mean of 3, runs scatter",
)
# What the simulated benches do not have: several channels, the first step once more, a rate that
# the sensor states, UTC of both clocks.
NEVER = {"channel_delays", "channel_clocks", "clock_links", "first_repeated"}
MOST_OPEN = 1


def closures_of_draw(work):
    program, top, seed, name, draw = work
    folder = pathlib.Path(top) / f"{CLEAN.index(name)}-{draw}"
    folder.mkdir()
    try:
        Calibration(CLASSES[name], seed_of(seed, name, draw)).write(folder)
        result, complaint = analysed(program, folder)
        if not result:
            return [(name, draw, "no result", "open", complaint)]
        return [
            (name, draw, one["kind"], one["verdict"], one["sentence"])
            for channel in result["channels"]
            for one in channel["closures"]
        ]
    finally:
        shutil.rmtree(folder)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--draws", type=int, default=10)
    parser.add_argument("--seed", type=int, default=SEED)
    options = parser.parse_args()
    counts = collections.defaultdict(collections.Counter)
    open_ones = []
    with tempfile.TemporaryDirectory(prefix="dyncal-closures-") as top:
        program = os.path.abspath(options.program)
        work = [(program, top, options.seed, name, draw)
                for name in CLEAN for draw in range(options.draws)]  # fmt: skip
        with multiprocessing.Pool(PROCESSES) as pool:
            for found in pool.imap_unordered(closures_of_draw, work):
                for name, draw, kind, verdict, sentence in found:
                    counts[kind][verdict] += 1
                    if verdict == "open":
                        open_ones.append(f"open: {name}, draw {draw}: {kind}: {sentence}")
    for kind, verdicts in sorted(counts.items()):
        print(f"{kind:22}" + "".join(
            f"{verdicts[verdict]:7} {verdict}" for verdict in ("closes", "open", "not_possible")
        ))  # fmt: skip
    print("\n".join(open_ones))
    idle = sorted(
        kind for kind, verdicts in counts.items() if not verdicts["closes"] and kind not in NEVER
    )
    if idle or not counts:
        print("never closed:", ", ".join(idle) or "there are none at all")
    print(f"{len(open_ones)} open in {options.draws} calibrations of each of {len(CLEAN)} classes")
    return 1 if len(open_ones) > MOST_OPEN or idle or not counts else 0


if __name__ == "__main__":
    sys.exit(main())
