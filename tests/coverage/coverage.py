#!/usr/bin/env python3
"""Draws calibrations of every class, has `dyncal analyse` evaluate them, and holds coverage and
flags against expected_outcomes.py.

    coverage.py BUILD/bin/dyncal                 short: 12 calibrations a class (test command)
    coverage.py BUILD/bin/dyncal --draws 60      long: what a claim of 95.45 % needs
    coverage.py BUILD/bin/dyncal --seed 7        other calibrations, a bound for all rows together
    coverage.py BUILD/bin/dyncal --class clean   only classes whose name contains the text
    coverage.py BUILD/bin/dyncal --keep FOLDER   leaves all files there

Prints a line for each class and quantity, and leaves with status 1 when a row of the table is not
as expected: also when one that is known to fail begins to hold. The seed is fixed unless --seed
gives another; then the chance of 1e-3 holds for all rows together, not for each. Needs
python3-numpy; says so and leaves with status 77 without it.
"""

import argparse
import collections
import math
import multiprocessing
import os
import pathlib
import shutil
import sys
import tempfile
import time
import zlib

from analysed_folder import PROCESSES, analysed
from bench_simulator import Calibration
from expected_outcomes import EXPECTED
from expected_row import MEAN
from fault_classes import CLASSES, draws_of
from judgement import CHANCE, Tally, claims_of, refusal

SEED = 2021_07_09
SHORT_DRAWS = 12


def seed_of(seed, fault_class, draw):
    return [seed, zlib.crc32(fault_class.encode()), draw]


def evaluated(program, folder, truth):
    result, complaint = analysed(program, folder)
    return claims_of(result, truth) if result else refusal(truth, complaint)


def claims_of_draw(work):
    program, top, keep, seed, fault_class, draw = work
    place = list(CLASSES).index(fault_class)
    folder = pathlib.Path(top) / f"class-{place:03}-draw-{draw:03}"
    folder.mkdir(parents=True)
    try:
        truth = Calibration(CLASSES[fault_class], seed_of(seed, fault_class, draw)).write(folder)
        return fault_class, evaluated(program, folder, truth)
    finally:
        if not keep:
            shutil.rmtree(folder)


def collect(options, classes, top):
    """Class and quantity to all their claims."""
    common = (os.path.abspath(options.program), top, bool(options.keep), options.seed)
    work = [(*common, name, draw) for name in classes for draw in draws_of(name, options.draws)]
    found = collections.defaultdict(list)
    with multiprocessing.Pool(PROCESSES) as pool:
        for name, claims in pool.imap(claims_of_draw, work):
            for what, claim in claims:
                found[name, what].append(claim)
    return found


def percent(part, whole):
    return f"{100.0 * part / whole:5.1f}" if whole else "    -"


def check(row, found, chance):
    """Prints a line for each quantity; returns what is not as expected."""
    tallies = {
        what: Tally(
            [claim for claim in found[row.fault_class, what] if row.judges(claim)],
            few_repeats=what in MEAN,
        )
        for what in row.judged
    }
    below = f" < {row.below_hz:g} Hz" if math.isfinite(row.below_hz) else ""
    findings = {what: tally.finding(row.wanted, chance) for what, tally in tallies.items()}
    for what, tally in tallies.items():
        n = len(tally.claims)
        state = f"known ({row.fails_at})" if row.fails_at and n else "FAILS"
        print(
            f"{row.fault_class:44} {what + below:15} {n:5} {percent(tally.covered, n)} "
            f"{percent(tally.warned, n)} {percent(len(tally.silent) - tally.silent_covered, n)} "
            f"{tally.width:6.2f}  {row.wanted:18}  "
            f"{f'{state}: {findings[what]}' if findings[what] else 'holds'}"
        )
    return not_as_expected(row, tallies, findings)


def not_as_expected(row, tallies, findings):
    empty = [what for what, tally in tallies.items() if not tally.claims]
    if empty:
        return [f"{row.fault_class}, {' and '.join(empty)}: no claims, nothing was judged"]
    if row.fails_at and not any(findings.values()):
        return [
            f"{row.fault_class}, {' and '.join(row.judged)}: known to fail ({row.fails_at}), "
            "but holds now; take fails_at out of expected_outcomes.py"
        ]
    if row.fails_at:
        return []
    return [
        f"{row.fault_class}, {what}: {finding}; wanted: {row.wanted}"
        for what, finding in findings.items()
        if finding
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="dyncal of the build that is judged")
    parser.add_argument("--draws", type=int, default=SHORT_DRAWS, help="calibrations a class")
    parser.add_argument("--seed", type=int, default=SEED, help="other calibrations than usual")
    parser.add_argument("--class", dest="part", default="", help="only classes with this text")
    parser.add_argument("--keep", help="a new folder for all files; else they are removed")
    options = parser.parse_args()
    rows = [row for row in EXPECTED if options.part in row.fault_class]
    if not rows or options.draws < 1:
        parser.error(f"nothing to judge: no class contains {options.part!r}, or no draws")
    unjudged = set(CLASSES) - {row.fault_class for row in EXPECTED}
    if unjudged:
        sys.exit(f"no expected outcome for: {', '.join(sorted(unjudged))}")
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="dyncal-coverage-") as temporary:
        classes = dict.fromkeys(row.fault_class for row in rows)
        found = collect(options, classes, options.keep or temporary)
    seconds = time.monotonic() - begin
    print(f"{options.draws} calibrations a class, seed {options.seed}, {seconds:.0f} s")
    chance = CHANCE if options.seed == SEED else CHANCE / sum(len(row.judged) for row in rows)
    print(
        f"{'class':44} {'quantity':15} {'n':>5} {'in U':>5} {'flag':>5} {'wrong':>5} "
        f"{'U/rms':>6}  {'wanted':18}  outcome   (in U, flag, wrong without a flag: %)"
    )
    findings = [finding for row in rows for finding in check(row, found, chance)]
    for finding in findings:
        print(f"NOT AS EXPECTED: {finding}")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
