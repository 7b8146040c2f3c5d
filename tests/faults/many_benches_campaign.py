#!/usr/bin/env python3
"""Many benches on one network and one analysis: do they disturb each other, what do they cost?

    many_benches_campaign.py PROGRAMS [--benches 8] [--acs-rate-hz 50000] [--warm-s 60]
                             [--rounds 2] [--vendors cyclonedds,...]

PROGRAMS is the folder of the built programs. The services of all benches run for --warm-s; then
every bench begins a run in the same instant, --rounds times. Held: every run ends with 0 and every
value valid, without loss and without flag; the analysis takes less than 30 % of a core and 200 MB.
Printed: how long arming took, what the analysis used, the memory of the largest source.
Exit status 1 if something did not hold.
"""

import argparse
import json
import pathlib
import shutil
import sys
import tempfile
import time

from bench_laboratory import SERVICES, VENDORS, BenchLaboratory, Failure
from process_figures import figures

ALONE = tuple(one for one in SERVICES if one != "dyncal-analysis")
MAX_CORE = 0.3
MAX_RESIDENT_MB = 200.0
CHANNELS = 3


def seconds_to_first_step(runs, began_s):
    """Of each run, as its first step is announced."""
    waits = dict.fromkeys(range(len(runs)))
    while None in waits.values():
        for number, run in enumerate(runs):
            if waits[number] is None and ("step 1 of" in run.errors() or not run.runs()):
                waits[number] = time.monotonic() - began_s
        time.sleep(0.01)  # between two looks
    return list(waits.values())


def judge(bench, run):
    status = run.wait()
    if status != 0:
        raise Failure(f"{bench.name}: exit status {status}: {run.errors().strip()[-300:]}")
    result = json.loads((bench.folder / "run.json").read_text(encoding="utf-8"))
    points = result["points"]
    if len(points) != len(bench.frequencies) * CHANNELS:
        raise Failure(f"{bench.name}: {len(points)} values")
    for point in points:
        if not point["valid"] or point["lost"] or point["flags"]:
            raise Failure(f"{bench.name}: {point['problem'] if not point['valid'] else point}")
    return sum("attempt" in point for point in points)


def round_of(benches, analysis):
    before, began_s = figures(analysis.process.pid), time.monotonic()
    runs = [bench.run() for bench in benches]
    arming_s = seconds_to_first_step(runs, began_s)
    repeated = sum(judge(bench, run) for bench, run in zip(benches, runs))
    after, took_s = figures(analysis.process.pid), time.monotonic() - began_s
    sources = [
        figures(bench.services[one].process.pid).resident_mb
        for bench in benches
        for one in ("dyncal-dau", "dyncal-acs")
    ]
    core = (after.cpu_s - before.cpu_s) / took_s
    print(
        f"    {len(benches)} runs in {took_s:.1f} s, first step after {min(arming_s):.2f} to "
        f"{max(arming_s):.2f} s; analysis {100 * core:.0f} % of a core, "
        f"{100 * core / len(benches):.2f} % a bench, {after.resident_mb:.0f} MB; "
        f"sources up to {max(sources):.0f} MB; {repeated} values of repeated steps",
        flush=True,
    )
    if core > MAX_CORE or after.resident_mb > MAX_RESIDENT_MB:
        raise Failure("the analysis used more than it may")


def campaign(arguments, vendors):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-benches-"))
    benches = []
    try:
        for number in range(arguments.benches):
            benches.append(
                BenchLaboratory(
                    arguments.programs,
                    folder / f"b{number}",
                    vendors,
                    name=f"b{number}",
                    domain=benches[0].domain if benches else None,
                    services=ALONE if benches else SERVICES,
                    acs_rate_hz=arguments.acs_rate_hz,
                )
            )
        analysis = benches[0].services["dyncal-analysis"]
        time.sleep(arguments.warm_s)
        for _ in range(arguments.rounds):
            round_of(benches, analysis)
    except Failure as failure:
        print(f"{vendors}: {failure} (logs in {folder})", flush=True)
        return False
    finally:
        for bench in reversed(benches):
            bench.close()
    shutil.rmtree(folder)
    print(f"{vendors}: {arguments.benches} benches hold", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--benches", type=int, default=8)
    parser.add_argument("--acs-rate-hz", type=int, default=50000)
    parser.add_argument("--warm-s", type=float, default=60.0)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    held = [campaign(arguments, vendors) for vendors in arguments.vendors]
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
