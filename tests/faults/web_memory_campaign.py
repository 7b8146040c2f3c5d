#!/usr/bin/env python3
"""Does dyncal-web's memory follow what is shown, over many runs with visitors?

    web_memory_campaign.py PROGRAMS [--runs 1000] [--vendors cyclonedds,...]
                           [--max-mb 60] [--max-growth-kb 25]

PROGRAMS is the folder of the built programs, with played_runs among them. Runs of 36 steps are
played one after the other over DDS as a conductor and an analysis send them; three visitors listen
to the events, and each run's results, figures (with all bars) and state are asked for until they
are whole. Held: dyncal-web never takes more than --max-mb, and from the first fifth of the runs on
grows by less than --max-growth-kb a run. Exit status 1 if something did not hold.
"""

import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import urllib.error
import urllib.request

from bench_laboratory import VENDORS, Failure, Program, reserve_dds_domain, wait_until
from process_figures import figures

BENCH = "played"
STEPS = 36
VISITORS = 3


def listen(port):
    address = f"http://127.0.0.1:{port}/events?bench={BENCH}"
    try:
        with urllib.request.urlopen(address, timeout=60.0) as answer:
            for _ in answer:
                pass
    except OSError:
        pass  # dyncal-web has ended


def ask(port, what):
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/{what}", timeout=30.0) as answer:
            return json.load(answer)
    except urllib.error.HTTPError:
        return {}


def look_at(port, run):
    """As a page does that shows the run; its size in bytes."""
    place = f"bench/{BENCH}"
    shown = {}

    def is_whole():
        shown["run"] = ask(port, f"{place}/run?run={run}")
        return len(shown["run"].get("points", [])) == STEPS

    wait_until(is_whole, f"the {STEPS} values of {run}", patience_s=60.0)
    for bars in ("U", "u", "none"):
        figure = ask(port, f"{place}/figures?run={run}&channel=dau/acceleration_z&bars={bars}")
        if not figure:
            raise Failure(f"{run} has no figures")
    ask(port, place)
    ask(port, "laboratory")
    return len(json.dumps(shown["run"]))


def play(players, web, port, arguments):
    first = max(1, arguments.runs // 5)
    at_first = 0.0
    for number in range(1, arguments.runs + 1):
        run = f"R{number}.20261122T101530.125Z.{number:08x}"
        players.stdin.write(run + "\n")
        players.stdin.flush()
        if players.stdout.readline().strip() != run:
            raise Failure("played_runs has ended")
        size = look_at(port, run)
        now = figures(web.process.pid)
        at_first = now.resident_mb if number == first else at_first
        if number % max(1, arguments.runs // 10) == 0:
            took = f"{now.resident_mb:.1f} MB, at most {now.peak_mb:.1f} MB"
            print(f"    {number} runs: {took}", flush=True)
        if now.peak_mb > arguments.max_mb:
            raise Failure(f"dyncal-web took {now.peak_mb:.1f} MB at run {number}")
    growth_kb = 1024.0 * (now.resident_mb - at_first) / max(1, arguments.runs - first)
    print(f"    a run is {size / 1e3:.0f} kB of JSON; {growth_kb:.1f} kB more a run", flush=True)
    if growth_kb > arguments.max_growth_kb:
        raise Failure(f"dyncal-web grew by {growth_kb:.1f} kB a run")


def campaign(arguments, vendors):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-web-memory-"))
    domain, keeper = reserve_dds_domain()
    vendor = VENDORS[vendors]
    web = Program(
        [arguments.programs / "dyncal-web", "--dds", vendor["dyncal-web"], "--domain", str(domain)]
        + ["--listen", "127.0.0.1:0"],
        folder / "web.log",
    )
    players = subprocess.Popen(
        [arguments.programs / "played_runs", str(domain), vendor["dyncal-analysis"]],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )
    try:
        begin = "page at http://127.0.0.1:"
        web.wait_for_text(begin)
        port = int(web.errors().split(begin)[1].split("/")[0])
        for _ in range(VISITORS):
            threading.Thread(target=listen, args=(port,), daemon=True).start()
        play(players, web, port, arguments)
    except Failure as failure:
        print(f"{vendors}: {failure} (logs in {folder})", flush=True)
        return False
    finally:
        players.stdin.close()
        players.wait()
        web.end()
        keeper.close()
    shutil.rmtree(folder)
    print(f"{vendors}: {arguments.runs} runs hold")
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--max-mb", type=float, default=60.0)
    parser.add_argument("--max-growth-kb", type=float, default=25.0)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=["cyclonedds"])
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    held = [campaign(arguments, vendors) for vendors in arguments.vendors]
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
