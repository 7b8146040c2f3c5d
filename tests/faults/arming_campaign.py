#!/usr/bin/env python3
"""How soon a run begins on good and bad networks, and whether a live bench gets through its run.

    arming_campaign.py PROGRAMS [--loss 0,20] [--mbit 0,10] [--warm-s 60] [--runs 10]
                       [--vendors cyclonedds,...] [--acs-rate-hz HZ] [--tcp] [--whole]
                       [--slack 1]

PROGRAMS is the folder of the built programs. Bench (instruments, sources, guard), analysis and
operator are on a host each; the services run for --warm-s before the first run. Time counts from
the start of `dyncal run`, discovery among it, to the announcement of the first step, when the run
is interrupted. With --whole every run goes on to its end and has every value, valid and without
loss; --tcp: the connection to the generator loses as many packets as DDS does. The ACS samples two
channels at --acs-rate-hz: 20 kHz unless told otherwise, and 10 kHz over links below 20 Mbit/s. The
bench sends each sample to two hosts (analysis, and the operator's recording): 4.7 Mbit/s at 10 kHz;
8.4 Mbit/s at 20 kHz, which 20 % of loss makes more than 10 Mbit/s.
Held: the first step within 1 s, within 5 s where packets are lost; --slack times as long, for a
machine that other work keeps busy. Exit status 1 if one was not,
77 where there are no network namespaces.
"""

import argparse
import itertools
import pathlib
import shutil
import signal
import sys
import tempfile
import time

import hosts
from bench_laboratory import VENDORS, Failure
from link_campaign import SpreadLaboratory

NARROW_MBIT = 20
SOON_S = 1.0
SOON_WITH_LOSS_S = 5.0


def run_once(laboratory, whole):
    """Seconds to the first step."""
    began_s = time.monotonic()
    run = laboratory.run()
    run.wait_for_text("step 1 of")
    took_s = time.monotonic() - began_s
    if not whole:
        run.send(signal.SIGINT)
    status = run.wait()
    laboratory.started.remove(run)
    if whole and status != 0:
        raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
    if whole:
        laboratory.expect_whole_result()
    return took_s


def campaign(arguments, vendors, loss, mbit):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-arming-"))
    limit_s = arguments.slack * (SOON_WITH_LOSS_S if loss else SOON_S)
    name = f"{vendors:11} loss {loss:2} %, {mbit or 'unlimited'} Mbit/s"
    acs_rate_hz = arguments.acs_rate_hz or (10000 if 0 < mbit < NARROW_MBIT else 20000)
    try:
        with SpreadLaboratory(
            arguments.programs, folder, vendors, acs_rate_hz=acs_rate_hz
        ) as laboratory:
            laboratory.hosts.disturb(loss, mbit, "udp, tcp" if arguments.tcp else "udp")
            time.sleep(arguments.warm_s)
            took_s = sorted(run_once(laboratory, arguments.whole) for _ in range(arguments.runs))
            late = sum(one > limit_s for one in took_s)
            print(
                f"{name}: {len(took_s)} runs, first step after {took_s[0]:.2f} to "
                f"{took_s[-1]:.2f} s, median {took_s[len(took_s) // 2]:.2f} s; "
                f"{late} later than {limit_s:g} s",
                flush=True,
            )
    except Failure as failure:
        print(f"{name}: {failure} (logs in {folder})", flush=True)
        return False
    shutil.rmtree(folder)
    return late == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    numbers = {"type": lambda text: [int(one) for one in text.split(",")]}
    parser.add_argument("--loss", default=[0, 20], **numbers)
    parser.add_argument("--mbit", default=[0, 10], **numbers)
    parser.add_argument("--warm-s", type=float, default=60.0)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    parser.add_argument("--acs-rate-hz", type=int)
    parser.add_argument("--tcp", action="store_true")
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--slack", type=float, default=1.0)
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    cells = itertools.product(arguments.vendors, arguments.loss, arguments.mbit)
    held = [campaign(arguments, *cell) for cell in cells]
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
