#!/usr/bin/env python3
"""Takes the link of a host down at drawn instants of a run, and judges what the run became.

    link_campaign.py PROGRAMS [--hosts bench,analysis,operator] [--down-s 5,20,60]
                     [--vendors cyclonedds,...] [--draws 4] [--at-once 4] [--seed 1]

PROGRAMS is the folder of the built programs. Bench (instruments, sources, guard), analysis and
operator are on a host each; the instruments are reached over the network by `dyncal run` and over
the bench's own loopback by its services. Held is what kill_campaign.py holds; and while the link
between conductor and bench is down, the output is off after four seconds (two for the guard to
notice that nobody attends, and what the network and the generator take) and stays off.
Exit status 1 if a draw did not hold, 77 where there are no network namespaces.
"""

import argparse
import concurrent.futures
import itertools
import pathlib
import random
import shutil
import sys
import tempfile
import time

import hosts
from bench_laboratory import VENDORS, BenchLaboratory, Failure
from kill_campaign import expect_off, judge

HOSTS = ("bench", "analysis", "operator")
UNATTENDED_S = 4.0
EXCITED_S = 7.0  # about what the three steps take
HOST_OF = {"dyncal-analysis": "analysis", "dyncal": "operator"}


class SpreadLaboratory(BenchLaboratory):
    """A live bench whose programs are on hosts of their own."""

    places = HOSTS

    def __init__(self, programs, folder, vendors, **options):
        self.hosts = hosts.Hosts(self.places)
        super().__init__(programs, folder, vendors, **options)

    def host_of(self, program):
        return HOST_OF.get(program, "bench")

    def start_program(self, program, arguments):
        host = self.host_of(program)
        if program == "dyncal-virtual-bench":
            arguments = [*arguments, "--generator-listen", f"{self.hosts.address['bench']}:0"]
        return super().start_program(program, arguments, self.hosts.command(host))

    def on_bus(self, program, arguments):
        return super().on_bus(program, [*arguments, "--interface", "lab"])

    def generator_host(self):
        return self.hosts.address["bench"]

    def output_is_on(self):
        return self.hosts.call("bench", super().output_is_on)

    def close(self):
        super().close()
        self.hosts.close()


def watch_output(laboratory, until_s):
    """Fails if the output is on UNATTENDED_S from now on or later, up to `until_s`."""
    began_s = time.monotonic()
    time.sleep(min(UNATTENDED_S, until_s))
    while time.monotonic() - began_s < until_s:
        if laboratory.output_is_on():
            raise Failure(f"on {time.monotonic() - began_s:.1f} s after the link went down")
        time.sleep(0.1)  # between two looks


def draw(arguments, host, down_s, vendors, number, undisturbed):
    chance = random.Random(f"{arguments.seed} {host} {down_s} {vendors} {number}")
    instant_s = chance.uniform(0.0, EXCITED_S)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-link-"))
    problem, result, repeated = "", undisturbed, 0
    try:
        with SpreadLaboratory(arguments.programs, folder, vendors) as laboratory:
            run = laboratory.run()
            if host:
                run.wait_for_text("step 1 of")
                time.sleep(instant_s)  # the drawn instant
                laboratory.hosts.set_cable(host, "down")
                try:
                    watch_output(laboratory, down_s if host != "analysis" else 0.0)
                    time.sleep(down_s if host == "analysis" else 0.0)
                finally:
                    laboratory.hosts.set_cable(host, "up")
            status = run.wait()
            expect_off(laboratory)
            if status != 0:
                raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
            result = laboratory.result()
            repeated = judge(laboratory, undisturbed or result)
    except Failure as failure:
        problem = str(failure)
        print(f"{host} down {down_s:g} s, {vendors} draw {number}: {problem}")
        print(f"    ({instant_s:.2f} s after the first step began; logs in {folder})", flush=True)
    else:
        shutil.rmtree(folder)
    return {"problem": problem, "result": result, "repeated": repeated}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--hosts", type=lambda text: text.split(","), default=list(HOSTS))
    parser.add_argument(
        "--down-s", type=lambda text: [float(one) for one in text.split(",")], default=[5, 20, 60]
    )
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    parser.add_argument("--draws", type=int, default=4)
    parser.add_argument("--at-once", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    undisturbed = draw(arguments, "", 0.0, "cyclonedds", 0, None)
    if undisturbed["problem"]:
        return 1
    held = True
    cells = list(itertools.product(arguments.hosts, arguments.down_s, arguments.vendors))
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        draws = {
            cell: [
                pool.submit(draw, arguments, *cell, number, undisturbed["result"])
                for number in range(arguments.draws)
            ]
            for cell in cells
        }
        for (host, down_s, vendors), of_cell in draws.items():
            good = [one.result() for one in of_cell if not one.result()["problem"]]
            repeated = sum(one["repeated"] > 0 for one in good)
            print(
                f"{host:9} down {down_s:3g} s {vendors:11} {len(good)} of {len(of_cell)} hold, "
                f"{repeated} with a repeated step",
                flush=True,
            )
            held &= len(good) == len(of_cell)
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
