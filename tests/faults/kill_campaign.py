#!/usr/bin/env python3
"""Kills and stops programs of a live bench at drawn instants, and judges what the runs became.

    kill_campaign.py PROGRAMS [--cases run,dyncal-analysis,...] [--vendors cyclonedds,...]
                     [--draws 100] [--at-once 4] [--seed 1] [--stop-s 30]

PROGRAMS is the folder of the built programs. A case is a service that is killed and restarted, as
systemd does, `run` (`dyncal run` killed, and resumed), `host` (both it and the analysis at once, as
when the host dies that they share), `stop:SERVICE` (SIGSTOP for --stop-s), or `end:SERVICE` (killed
beside the end of what is evaluated of a step, or of the step itself).
Every draw is a laboratory of its own: a run of three steps of which the fault meets one instant.
dyncal-dso has a bench of its own, with a sensor that it triggers; the recorder and the web page are
started for their own draws alone.

Held: the run ends with 0, has every value, valid, without loss and without flag (but for the start
of a series, which a run of few shots may leave undecided), within five standard uncertainties of
the undisturbed run's; the output is off in the end, and is never on for more than two seconds while
its conductor is dead. Who only looks on, the recorder and the web page, disturbs no step; the
recording of a recorder that is there again before the run ends gives the run's values to the last
bit, that of another says what it lacks. So does the recording that every run keeps of itself where
a source was killed beside the end of a step, and that step is only repeated where its planned
samples had not come. A run that missed the analysis or a source at its start,
and said so before anything was excited, counts as refused. Exit status 1 if a draw did not hold, or
if all draws of a cell were refused.
"""

import argparse
import concurrent.futures
import json
import math
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

from bench_laboratory import SERVICES, VENDORS, BenchLaboratory, Failure, wait_until
from series_laboratory import SeriesLaboratory

SPECTATORS = ("dyncal-recorder", "dyncal-web")
MAX_UNATTENDED_S = 2.0
AGREEMENT_U = 5.0
PLANNED_S = 2.0  # of a step of BenchLaboratory
BESIDE_END_S = (-0.1, 0.4)  # of the planned end: frames of the search, and the end of the step
ALL_HAVE_COME_S = 0.3  # behind it: the same, and the last block
# Few shots do not always tell, whoever was killed; u allows for both.
FLAGS_OF_ANY_RUN = ("start of the series: undecided, taken as with the trigger",)
REFUSALS = (
    "no analysis service answers for bench",
    "does not answer in its sample stream",
    "is not on the network",
    "or nothing was measured, so it cannot be taken over",
)


def values(result):
    return {
        (point["channel"], point["step"]): point for point in result["points"] if point["valid"]
    }


def judge(laboratory, undisturbed):
    """Returns how many values are of a repeated step."""
    expected = values(undisturbed)
    got = values(laboratory.result())
    wanted = len(laboratory.frequencies) * laboratory.channels
    if len(expected) != wanted or set(got) != set(expected):
        raise Failure(f"{len(got)} of {len(expected)} values are there and valid")
    for key, point in got.items():
        flags = [one for one in point["flags"] if one not in FLAGS_OF_ANY_RUN]
        if point["lost"] or flags:
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


def killed_beside_end(laboratory, service, step, after_s, away_s, run):
    for place in range(step + 1):
        wait_until(laboratory.output_is_on, f"step {place + 1}", interval_s=0.005)
        began_s = time.monotonic()
        if place < step:
            wait_until(lambda: not laboratory.output_is_on(), "the end of a step")
    time.sleep(max(0.0, began_s + after_s - time.monotonic()))  # to the drawn instant
    return killed_service(laboratory, service, 0.0, away_s, run)


def judge_beside_end(run, step, after_s):
    is_repeated = f"step {step + 1} is excited again" in run.errors()
    if is_repeated and after_s > PLANNED_S + ALL_HAVE_COME_S:
        raise Failure(f"step {step + 1} is repeated although its planned samples had come")
    if "evaluated once more, gives the same" not in run.errors():
        raise Failure(f"its own recording: {run.errors().splitlines()[-1:]}")


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


def judge_recording(laboratory):
    """The newest recording of the run, begun before or after the kill, gives its values.

    Where the run ended before the recorder was there again, it says what it lacks.
    """
    recordings = laboratory.recordings().glob(f"{laboratory.name}/campaign*.mcap")
    newest = max(recordings, key=lambda path: path.stat().st_mtime_ns, default=None)
    if newest is None:
        raise Failure("there is no recording of the run")
    second = newest.name != "campaign.mcap"
    recorder = laboratory.services["dyncal-recorder"]
    if second:
        recorder.wait_for_text(f"{newest.name} has ")
    recorder.end()
    result = laboratory.folder / "recorded.json"
    analyse = laboratory.start_program("dyncal", ["analyse", newest, "--output", result])
    status = analyse.wait()
    recorded = json.loads(result.read_text(encoding="utf-8"))["points"]
    given = laboratory.result()["points"]
    unsaid = [one for one in recorded if one not in given and one["valid"] and not one["flags"]]
    if unsaid:
        raise Failure(f"{newest.name} gives other values than the run: {unsaid[0]}")
    if not recorded or (status == 0 and len(recorded) != len(given)):
        raise Failure(f"{newest.name} gives {len(recorded)} of {len(given)} values")
    if second and recorded != given:
        raise Failure(f"{newest.name} lacks some of the run, and says so")


def bench_of(case):
    return SeriesLaboratory if case.endswith("dyncal-dso") else BenchLaboratory


def disturbed_run(arguments, case, laboratory, instant_s, away_s):
    """The run's programs in their order: one, or with the one that resumed it two."""
    service = case.removeprefix("stop:").removeprefix("end:")
    if service in SPECTATORS:
        laboratory.restart(service)
    run = laboratory.run("--run", "campaign")
    if case == "run":
        return [run, killed_run(laboratory, instant_s, run)]
    if case == "host":
        return [run, killed_run(laboratory, instant_s, run, away_s)]
    if case.startswith("end:"):
        step, after_s = beside_end(laboratory, instant_s)
        return [killed_beside_end(laboratory, service, step, after_s, away_s, run)]
    if case != service:
        return [stopped_service(laboratory, service, instant_s, arguments.stop_s, run)]
    return [killed_service(laboratory, service, instant_s, away_s, run)]


def beside_end(laboratory, instant_s):
    """A step, and the time since its begin, drawn by the instant in the run."""
    first, last = BESIDE_END_S
    after_s = PLANNED_S + first + (last - first) * (instant_s / PLANNED_S % 1.0)
    return int(instant_s / PLANNED_S) % len(laboratory.frequencies), after_s


def was_refused(runs):
    said = "".join(run.errors() for run in runs)
    return "step 1 of" not in said and any(one in runs[-1].errors() for one in REFUSALS)


def draw(arguments, case, vendors, number, undisturbed):
    chance = random.Random(f"{arguments.seed} {case} {vendors} {number}")
    instant_s = chance.uniform(0.0, bench_of(case).run_s)
    away_s = chance.choice((0.1, 1.0, chance.uniform(0.0, 8.0)))
    folder = pathlib.Path(tempfile.mkdtemp(prefix=f"dyncal-{case.replace(':', '-')}-"))
    begin_s = time.monotonic()
    repeated = 0
    problem = ""
    refused = False
    try:
        with bench_of(case)(arguments.programs, folder, vendors) as laboratory:
            runs = disturbed_run(arguments, case, laboratory, instant_s, away_s)
            status = runs[-1].wait()
            expect_off(laboratory)
            refused = was_refused(runs)
            if status != 0 and not refused:
                last_line = runs[-1].errors().strip().splitlines()[-1:]
                raise Failure(f"exit status {status}: {last_line}")
            if not refused:
                repeated = judge(laboratory, undisturbed)
            if case.removeprefix("stop:") in SPECTATORS and (repeated or refused):
                raise Failure("who looks on has disturbed the run")
            if case == "dyncal-recorder":
                judge_recording(laboratory)
            if case.startswith("end:"):
                judge_beside_end(runs[-1], *beside_end(laboratory, instant_s))
    except Failure as failure:
        problem = str(failure)
    took_s = time.monotonic() - begin_s
    if problem:
        print(f"{case} {vendors} draw {number}: {problem} (killed {instant_s:.2f} s after the")
        print(f"    start, away {away_s:.2f} s; logs in {folder})", flush=True)
    else:
        shutil.rmtree(folder)
    return {"problem": problem, "repeated": repeated, "refused": refused, "took_s": took_s}


def undisturbed_result(arguments, bench):
    """What an undisturbed run gives; fails where it has not every value."""
    with tempfile.TemporaryDirectory(prefix="dyncal-undisturbed-") as folder:
        with bench(arguments.programs, folder, "cyclonedds") as laboratory:
            run = laboratory.run()
            if run.wait() != 0:
                raise Failure(f"undisturbed: {run.errors().strip().splitlines()[-1:]}")
            judge(laboratory, laboratory.result())
            return laboratory.result()


def campaign(arguments, case, vendors, pool, undisturbed):
    draws = list(
        pool.map(
            lambda number: draw(arguments, case, vendors, number, undisturbed),
            range(arguments.draws),
        )
    )
    held = sum(not one["problem"] for one in draws)
    repeated = sum(one["repeated"] > 0 for one in draws)
    refused = sum(one["refused"] for one in draws)
    longest_s = max(one["took_s"] for one in draws)
    print(
        f"{case:22} {vendors:11} {held:4} of {len(draws)} hold, "
        f"{repeated} with a repeated step, {refused} refused, "
        f"longest {longest_s:.0f} s",
        flush=True,
    )
    return held == len(draws) > refused


def main():
    cases = ["run", "host", *SERVICES, "dyncal-dso", *SPECTATORS]
    cases += ["stop:dyncal-analysis", "end:dyncal-dau"]
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
    undisturbed = {
        bench: undisturbed_result(arguments, bench) for bench in set(map(bench_of, arguments.cases))
    }
    held = True
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        for case in arguments.cases:
            for vendors in arguments.vendors:
                held &= campaign(arguments, case, vendors, pool, undisturbed[bench_of(case)])
    return 0 if held else 1


if __name__ == "__main__":
    sys.exit(main())
