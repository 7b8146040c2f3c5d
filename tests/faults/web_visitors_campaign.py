#!/usr/bin/env python3
"""Many visitors of dyncal-web at many benches: what do they cost, and does a run notice them?

    web_visitors_campaign.py PROGRAMS [--benches 8] [--visitors 10] [--acs-rate-hz 50000]
                             [--warm-s 20] [--vendors cyclonedds,...]

PROGRAMS is the folder of the built programs. All is on loopback, on a DDS domain of its own. Each
visitor listens to the events of one bench and looks at a signal of it; then every bench conducts a
run. Held: every run ends with 0 and every value valid, without loss and without flag; dyncal-web
takes less than 20 % of a core and 150 MB (of 8 benches, 10 visitors) and misses no sample; every
visitor hears of the state at least once a second (within 5 s on this machine) and sees a signal.
Exit status 1 if something did not hold.
"""

import argparse
import json
import pathlib
import shutil
import sys
import tempfile
import threading
import time
import urllib.request

from bench_laboratory import READY, VENDORS, BenchLaboratory, Failure
from many_benches_campaign import judge
from process_figures import figures

MAX_CORE = 0.2
MAX_RESIDENT_MB = 150.0
MAX_SILENCE_S = 5.0
SERVICES = ("dyncal-analysis", "dyncal-dau", "dyncal-acs")


class Visitor(threading.Thread):
    def __init__(self, port, bench, signal):
        super().__init__(daemon=True)
        self.address = f"http://127.0.0.1:{port}/events?bench={bench}&signal={signal}&seconds=10"
        self.events = {}
        self.silence_s = 0.0
        self.seen_columns = 0
        self.ended = False

    def run(self):
        last_s = time.monotonic()
        with urllib.request.urlopen(self.address, timeout=30.0) as answer:
            name = ""
            for line in answer:
                if self.ended:
                    return
                if line.startswith(b"event: "):
                    name = line[7:].strip().decode()
                    self.events[name] = self.events.get(name, 0) + 1
                if name == "laboratory":
                    self.silence_s = max(self.silence_s, time.monotonic() - last_s)
                    last_s = time.monotonic()
                if name == "signal" and line.startswith(b"data: "):
                    self.seen_columns = line.count(b"],[")


def start_web(bench):
    web = bench.on_bus("dyncal-web", ["--listen", "127.0.0.1:0"])
    begin = "page at http://127.0.0.1:"
    web.wait_for_text(begin)
    return web, int(web.errors().split(begin)[1].split("/")[0])


def laboratory_of(port):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/laboratory", timeout=30.0) as answer:
        return json.load(answer)


def check_web(web, port, visitors, before, began_s):
    now, took_s = figures(web.process.pid), time.monotonic() - began_s
    core = (now.cpu_s - before.cpu_s) / took_s
    missed = laboratory_of(port)["daemon"]["samples_missed"]
    print(
        f"    dyncal-web: {100 * core:.1f} % of a core, {now.resident_mb:.0f} MB, at most "
        f"{now.peak_mb:.0f} MB, {now.threads} threads; {missed} samples missed; longest silence of "
        f"a visitor {max(v.silence_s for v in visitors):.2f} s; events of one {visitors[0].events}",
        flush=True,
    )
    if core > MAX_CORE or now.resident_mb > MAX_RESIDENT_MB or missed != "0":
        raise Failure("dyncal-web used more than it may, or missed samples")
    for visitor in visitors:
        if visitor.silence_s > MAX_SILENCE_S or visitor.seen_columns < 100:
            raise Failure(f"a visitor heard {visitor.events}, {visitor.seen_columns} columns")


def campaign(arguments, vendors):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-visitors-"))
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
                    services=(),
                    acs_rate_hz=arguments.acs_rate_hz,
                )
            )
        for name in SERVICES:
            files = [] if name == "dyncal-analysis" else [bench.bench_file for bench in benches]
            benches[0].on_bus(name, files).wait_for_text(READY[name])
        web, port = start_web(benches[0])
        signals = ("acs/reference", "dau/acceleration_z")
        visitors = []
        for number in range(arguments.visitors):
            bench = benches[number % len(benches)].name
            visitors.append(Visitor(port, bench, signals[number // len(benches) % 2]))
            visitors[-1].start()
        time.sleep(arguments.warm_s)
        before, began_s = figures(web.process.pid), time.monotonic()
        runs = [bench.run() for bench in benches]
        for bench, run in zip(benches, runs):
            judge(bench, run)
        check_web(web, port, visitors, before, began_s)
        for visitor in visitors:
            visitor.ended = True
    except Failure as failure:
        print(f"{vendors}: {failure} (logs in {folder})", flush=True)
        return False
    finally:
        for bench in reversed(benches):
            bench.close()
    shutil.rmtree(folder)
    print(f"{vendors}: {arguments.visitors} visitors of {arguments.benches} benches hold")
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--benches", type=int, default=8)
    parser.add_argument("--visitors", type=int, default=10)
    parser.add_argument("--acs-rate-hz", type=int, default=50000)
    parser.add_argument("--warm-s", type=float, default=20.0)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=["cyclonedds"])
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    held = [campaign(arguments, vendors) for vendors in arguments.vendors]
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
