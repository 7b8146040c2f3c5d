#!/usr/bin/env python3
"""Kills and stops programs of a live bench at drawn instants, and judges what the runs became.

    kill_campaign.py PROGRAMS [--cases run,dyncal-analysis,...] [--vendors cyclonedds,...]
                     [--draws 100] [--at-once 4] [--seed 1] [--stop-s 30]

PROGRAMS is the folder of the built programs. A case is a service that is killed and restarted, as
systemd does, `run` (`dyncal run` killed, and resumed), `host` (both it and the analysis at once, as
when the host dies that they share), or `stop:SERVICE` (SIGSTOP for --stop-s).
Every draw is a laboratory of its own: a run of three steps of which the fault meets one instant.

Held: the run ends with 0, has every value, valid, without loss and without flag, within five
standard uncertainties of the undisturbed run's; the output is off in the end, and is never on for
more than two seconds while its conductor is dead. A run that missed the analysis or a source at its
start, and said so before anything was excited, counts as refused. Exit status 1 if a draw did not
hold.
"""

import argparse
import concurrent.futures
import math
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

from bench_laboratory import CHANNELS, SERVICES, VENDORS, BenchLaboratory, Failure, wait_until

RUN_S = 11.0  # about what an undisturbed run takes, from its first word to its last
MAX_UNATTENDED_S = 2.0
AGREEMENT_U = 5.0
REFUSALS = (
    "no analysis service answers for bench",
    "does not answer in its sample stream",
    "is not on the network",
    "or the run had not begun yet, so it cannot be taken over",
)


def values(result):
    return {
        (point["channel"], point["step"]): point for point in result["points"] if point["valid"]
    }


def judge(result, undisturbed, steps):
    expected = values(undisturbed)
    got = values(result)
    if len(expected) != steps * CHANNELS or set(got) != set(expected):
        raise Failure(f"{len(got)} of {len(expected)} values are there and valid")
    for key, point in got.items():
        if point["lost"] or point["flags"]:
            raise Failure(f"{key}: {point['lost']} samples lost, flags {point['flags']}")
        reference = expected[key]
        for name in ("magnitude", "phase_rad"):
            difference = abs(point[name] - reference[name])
            u = math.hypot(point["u_" + name], reference["u_" + name])
            if not difference <= AGREEMENT_U * u:
                raise Failure(f"{key}: {name} differs by {difference / u:.1f} u")
    return sum("attempt" in point for point in got.values())


def expect_off(laboratory):
    wait_until(lambda: not laboratory.output_is_on(), "the output to be off", 20.0)


def killed_service(laboratory, service, instant_s, away_s, run):
    time.sleep(instant_s)  # the drawn instant
    laboratory.services[service].send(signal.SIGKILL)
    time.sleep(away_s)  # drawn as well
    laboratory.restart(service)
    return run


def stopped_service(laboratory, service, instant_s, stop_s, run):
    time.sleep(instant_s)
    laboratory.services[service].send(signal.SIGSTOP)
    time.sleep(stop_s)
    laboratory.services[service].send(signal.SIGCONT)
    return run


def killed_run(laboratory, instant_s, run, with_analysis_for_s=None):
    time.sleep(instant_s)
    if with_analysis_for_s is not None:
        laboratory.services["dyncal-analysis"].send(signal.SIGKILL)
    if not run.runs():
        return run
    run.send(signal.SIGKILL)
    killed_s = time.monotonic()
    wait_until(lambda: not laboratory.output_is_on(), "the output to be switched off", 20.0, 0.005)
    unattended_s = time.monotonic() - killed_s
    if unattended_s > MAX_UNATTENDED_S:
        raise Failure(f"the output was on for {unattended_s:.2f} s without a conductor")
    if with_analysis_for_s is not None:
        time.sleep(with_analysis_for_s)
        laboratory.restart("dyncal-analysis")
    return laboratory.run("--resume", "campaign")


def draw(arguments, case, vendors, number, undisturbed):
    chance = random.Random(f"{arguments.seed} {case} {vendors} {number}")
    instant_s = chance.uniform(0.0, RUN_S)
    away_s = chance.choice((0.1, 1.0, chance.uniform(0.0, 8.0)))
    folder = pathlib.Path(tempfile.mkdtemp(prefix=f"dyncal-{case.replace(':', '-')}-"))
    begin_s = time.monotonic()
    repeated = 0
    problem = ""
    refused = False
    try:
        with BenchLaboratory(arguments.programs, folder, vendors) as laboratory:
            first = run = laboratory.run("--run", "campaign")
            if case == "run":
                run = killed_run(laboratory, instant_s, run)
            elif case == "host":
                run = killed_run(laboratory, instant_s, run, away_s)
            elif case.startswith("stop:"):
                service = case.removeprefix("stop:")
                run = stopped_service(laboratory, service, instant_s, arguments.stop_s, run)
            elif case != "undisturbed":
                run = killed_service(laboratory, case, instant_s, away_s, run)
            status = run.wait()
            expect_off(laboratory)
            refused = "step 1 of" not in first.errors() + run.errors() and any(
                one in run.errors() for one in REFUSALS
            )
            if status != 0 and not refused:
                raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
            if not refused:
                result = laboratory.result()
                undisturbed = undisturbed or result
                repeated = judge(result, undisturbed, len(laboratory.frequencies))
    except Failure as failure:
        problem = str(failure)
    took_s = time.monotonic() - begin_s
    if problem:
        print(f"{case} {vendors} draw {number}: {problem} (killed {instant_s:.2f} s after the")
        print(f"    start, away {away_s:.2f} s; logs in {folder})", flush=True)
    else:
        shutil.rmtree(folder)
    return {
        "problem": problem,
        "repeated": repeated,
        "refused": refused,
        "took_s": took_s,
        "result": undisturbed,
    }


def campaign(arguments, case, vendors, pool, undisturbed):
    draws = list(
        pool.map(
            lambda number: draw(arguments, case, vendors, number, undisturbed),
            range(arguments.draws),
        )
    )
    held = sum(not one["problem"] for one in draws)
    repeated = sum(one["repeated"] > 0 for one in draws)
    longest_s = max(one["took_s"] for one in draws)
    print(
        f"{case:22} {vendors:11} {held:4} of {len(draws)} hold, "
        f"{repeated} with a repeated step, {sum(one['refused'] for one in draws)} refused, "
        f"longest {longest_s:.0f} s",
        flush=True,
    )
    return held == len(draws)


def main():
    cases = ["run", "host", *SERVICES, "stop:dyncal-analysis"]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--cases", type=lambda text: text.split(","), default=cases)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--at-once", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--stop-s", type=float, default=30.0)
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    undisturbed = draw(arguments, "undisturbed", "cyclonedds", 0, None)
    if undisturbed["problem"]:
        return 1
    held = True
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        for case in arguments.cases:
            for vendors in arguments.vendors:
                held &= campaign(arguments, case, vendors, pool, undisturbed["result"])
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
