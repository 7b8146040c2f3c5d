#!/usr/bin/env python3
"""Lets operator, guard, path and generator fail in drawn order, and holds that nothing stays on.

    unattended_campaign.py PROGRAMS [--draws 60] [--held 4] [--calibrations 8] [--healthy 200]
                           [--seed 1] [--vendors mixed] [--watch-s 60] [--at-once 3]

PROGRAMS is the folder of the built programs. Bench (instruments, sources, guard), analysis and
operator are on a host each.

Draws: a run is in its first step; within 4 s the operator's host loses its power, its program is
killed or stands still, or the path fails: both ways, one way, for datagrams, for the generator's
TCP, or with the very ON of the step, before or after the guard has heard of it. The guard dies in
half of the draws, at any time around that, and is back after up to 10 s. The generator is sound,
ignores OFF, answers late, or falls mute. Held: from the moment when nobody attends and the guard is
there, the output is off after 2.1 s where the guard heard the run, 3.5 s where it has to ask, and
stays off for --watch-s; or MAY BE ON is said of a generator that ignores OFF or is mute. Where no
guard ever heard that the run drives, a late or mute generator is waited for beyond that.

Held packets: the path fails with ON in flight, and is back after 5 or 18 s. That ON never arrives.

Calibrations: `dyncal calibrate dso-delay` is killed or its terminal closed.

The opposite, in one laboratory: runs one after the other, some of which pause, are interrupted and
begun anew, or are followed by a person who uses the generator. Nothing is switched off, and every
run is whole.

Limits are extended by three times the worst delay with which this machine let a program go on in
the draw, which is said. Exit status 1 if one did not hold, 77 where there are no namespaces.
"""

import argparse
import concurrent.futures
import contextlib
import json
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import hosts
from bench_laboratory import VENDORS, Failure, Program, wait_until
from generator_proxy import FAULTS, LATE_S, GeneratorProxy
from guarded_laboratory import GuardedLaboratory, SchedulingDelay

HEARD_S = 2.1  # idl/README.md, deploy/README.md
ASKED_S = 3.5
# Of a run that no guard heard drive. A guard asks 2.5 s after the last word of it, no sooner: until
# then its conductor may be connecting to an instrument of one connection (exciter_watch.hpp), which
# leaves one second of the 3.5. A person may use the generator: frequency and voltage tell the run's
# ON from hers, and come with the third answer; and one question without an answer may be the
# conductor's own connecting. So 3.5 s hold where the generator answers at once. Of a run that was
# heard, or is in the guard's record, OFF goes out before anything is asked, or one question tells.
BEGINS_S = {"late": 3 * LATE_S, "mute": 2 * 2.0}
HEARD = "watching over run"
WITHIN_S = 4.0
LOOK_S = 0.05
MAY_BE_ON = "MAY BE ON"
PATHS = ("path", "to-bench", "from-bench", "datagrams", "generator-tcp")
WITH_ON = ("with-on", "with-on-unheard")  # before the run begins
DEATHS = ("power", "killed", "stands", *PATHS, *WITH_ON)
HEALTHY = ("plain", "person", "paused", "interrupted")


class LongSteps(GuardedLaboratory):
    duration_s = 300.0


class ShortSteps(GuardedLaboratory):
    duration_s = 0.5


class Output:
    """Looks at the output from now on, until it is closed."""

    def __init__(self, is_on, words):
        self.is_on = is_on
        self.words = words
        self.looks = []  # (s, whether it was on, whether that was said)
        self.ends = threading.Event()
        threading.Thread(target=self.look, daemon=True).start()

    def look(self):
        while not self.ends.wait(LOOK_S):
            now_s = time.monotonic()
            try:
                self.looks.append((now_s, self.is_on(), MAY_BE_ON in self.words()))
            except (OSError, RuntimeError):
                return  # the laboratory ends

    def expect_off(self, limit_s, since_s, watch_s, delay):
        """Off within the limit, and then for `watch_s`, or said to be on; returns when it was seen
        on for the last time, nothing where it was said to be on."""
        end_s = since_s + limit_s + watch_s
        wait_until(lambda: self.looks and self.looks[-1][0] >= end_s, "looks", interval_s=0.2)
        slack_s = LOOK_S + 3.0 * delay.worst_s
        last_s = 0.0
        for at_s, is_on, is_said in self.looks:
            if is_on and not is_said and at_s - since_s > limit_s + slack_s:
                raise Failure(f"on {at_s - since_s:.2f} s after, and nobody says so")
            last_s = max(last_s, at_s - since_s if is_on else 0.0)
        return None if self.looks[-1][2] and last_s > limit_s else last_s

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ends.set()


def laboratory_folder():
    return pathlib.Path(tempfile.mkdtemp(prefix="dyncal-unattended-"))


class Row:
    """One draw: what was drawn, what became of it."""

    def __init__(self, name):
        self.name = name
        self.problem = ""
        self.figures = ""
        self.took_s = None
        self.kind = ""

    def run(self, function):
        folder = laboratory_folder()
        try:
            with SchedulingDelay() as delay:
                function(self, folder, delay)
                self.figures += f" (machine late by up to {delay.worst_s:.2f} s)"
        except (Failure, OSError, subprocess.SubprocessError) as failure:
            self.problem = f"{failure} (logs in {folder})"
        else:
            shutil.rmtree(folder)
        print(f"{self.name}: {self.problem or 'holds' + self.figures}", flush=True)
        return self


def off_after(took_s):
    return ", on" if took_s is None else f", off after {took_s:.2f} s"


def draw_events(chance):
    """What fails when, from the beginning of the step on."""
    drawn = {
        "death": chance.choice(DEATHS),
        "dies_s": chance.uniform(0.0, WITHIN_S),
        "fault_s": chance.uniform(0.0, WITHIN_S),
        "guard_dies_s": chance.uniform(0.0, WITHIN_S) if chance.random() < 0.5 else None,
        "guard_away_s": chance.uniform(0.0, 10.0),
    }
    if drawn["death"] in WITH_ON:
        drawn["dies_s"] = 0.0
    if drawn["death"] == "with-on-unheard":
        drawn["guard_dies_s"] = None  # a guard that was never told has no record of it
    return drawn


def die(laboratory, run, death):
    if death == "power":
        laboratory.hosts.set_cable("operator", "down")
        run.send(signal.SIGKILL)
    elif death == "killed":
        run.send(signal.SIGKILL)
    elif death == "stands":
        run.send(signal.SIGSTOP)
    elif death in PATHS:
        laboratory.lose_path(death)


def unattended(arguments, number):
    chance = random.Random(f"{arguments.seed} {number}")
    fault = FAULTS[number % len(FAULTS)]
    drawn = draw_events(chance)
    case = f"{number:3} {fault}, {drawn['death']} after {drawn['dies_s']:.1f} s"
    if drawn["guard_dies_s"] is not None:
        case += f", guard away from {drawn['guard_dies_s']:.1f} s for {drawn['guard_away_s']:.1f} s"

    def one(row, folder, delay):
        place = (arguments.programs, folder, arguments.vendors)
        with LongSteps(*place) as laboratory, contextlib.ExitStack() as watching:
            guard = laboratory.services["dyncal-guard"]
            if drawn["death"] in WITH_ON:
                laboratory.lose_path_with_on(drawn["death"] == "with-on", delivered=True)
            run = laboratory.run()

            def words():  # of those who cannot switch off; where it can be, it must be off
                can = fault in ("sound", "late")
                return "" if can else laboratory.guard_words() + run.errors()

            output = watching.enter_context(Output(laboratory.output_is_on, words))
            wait_until(laboratory.output_is_on, "the output to be on")
            began_s = time.monotonic()
            if drawn["death"] not in WITH_ON:
                guard.wait_for_text(HEARD, 10.0)
                began_s = time.monotonic()
            events = [
                (drawn["dies_s"], lambda: die(laboratory, run, drawn["death"])),
                (drawn["fault_s"], lambda: laboratory.proxy.begin(fault)),
            ]
            if drawn["guard_dies_s"] is not None:
                events.append((drawn["guard_dies_s"], lambda: guard.send(signal.SIGKILL)))
            for due_s, event in sorted(events, key=lambda one: one[0]):
                time.sleep(max(0.0, began_s + due_s - time.monotonic()))  # the drawn instants
                event()
            unattended_s = drawn["dies_s"]
            if fault == "mute":
                unattended_s = min(unattended_s, drawn["fault_s"])
            since_s = began_s + unattended_s
            row.kind, limit_s = "heard", HEARD_S
            if HEARD not in laboratory.guard_words():
                row.kind, limit_s = "asked", ASKED_S + BEGINS_S.get(fault, 0.0)
            if fault == "ignores-off":  # that it is on after OFF is found by asking
                limit_s = max(limit_s, ASKED_S)
            has_own_guard = drawn["death"] == "killed" and drawn["fault_s"] >= drawn["dies_s"]
            if drawn["guard_dies_s"] is not None:
                back_s = began_s + drawn["guard_dies_s"] + drawn["guard_away_s"]
                time.sleep(max(0.0, back_s - time.monotonic()))
                laboratory.restart("dyncal-guard")
                if not has_own_guard:  # a process beside the conductor's, on a sound path
                    since_s = max(since_s, time.monotonic())
                    row.kind, limit_s = "asked", max(limit_s, ASKED_S)
            row.took_s = output.expect_off(limit_s, since_s, arguments.watch_s, delay)
            row.figures = off_after(row.took_s)
            own = re.findall(r"for ([\d.]+) s while its exciter was", words())
            row.figures += f", by the guard's clock {own[0]} s" if own else ""
            row.figures += ", said to be on" if MAY_BE_ON in words() else ""

    return Row(case).run(one)


def held_packet(arguments, number):
    is_killed, back_s = number % 2 == 0, (5.0, 18.0)[number // 2 % 2]
    run_does = "is killed" if is_killed else "goes on"
    name = f"held packet {number}: run {run_does}, path back after {back_s:g} s"

    def one(row, folder, delay):
        with GuardedLaboratory(arguments.programs, folder, arguments.vendors) as laboratory:
            laboratory.lose_path_with_on(heard=True, delivered=False)
            run = laboratory.run()
            wait_until(laboratory.path_is_lost, "the path to fail with ON in flight")
            laboratory.lose_path_to_operator()
            lost_s = time.monotonic()
            wait_until(lambda: time.monotonic() - lost_s > 1.0, "a second")
            if is_killed:
                run.send(signal.SIGKILL)
            wait_until(lambda: time.monotonic() - lost_s > back_s, "the drawn time")
            before = {connection for _, connection, _ in laboratory.proxy.heard}
            laboratory.restore_path()
            if not is_killed:
                status = run.wait(180.0)
                row.figures = f", run ended with {status}"
            ended_s = time.monotonic()
            while time.monotonic() < ended_s + arguments.watch_s:
                if laboratory.output_is_on():
                    raise Failure(f"on {time.monotonic() - ended_s:.1f} s after the run")
                time.sleep(LOOK_S)  # between two looks
            old = [line for _, number, line in laboratory.proxy.heard if number in before]
            if any(line == ":OUTPut1 ON" for line in old):
                raise Failure("the ON of the old connection has arrived")

    return Row(name).run(one)


def calibration(arguments, number):
    fault = FAULTS[number % len(FAULTS)]
    end = (signal.SIGHUP, signal.SIGKILL)[number // len(FAULTS) % 2]

    def one(row, folder, delay):
        programs = arguments.programs
        bench = Program(
            [programs / "dyncal-virtual-bench", "--preset", "tss", "--ports-file", "ports.json"],
            folder / "bench.txt",
        )
        proxy = calibrate = None
        try:
            bench.wait_for_text("ports")
            ports = json.loads((folder / "ports.json").read_text(encoding="utf-8"))
            place = ("127.0.0.1", ports["generator"])
            proxy = GeneratorProxy(place, lambda function: function(), lambda: None)
            command = [programs / "dyncal", "calibrate", "dso-delay", "--shots", "100000"]
            command += ["--oscilloscope", f"127.0.0.1:{ports['dso']}", "--output", "delay.json"]
            command += ["--generator", f"127.0.0.1:{proxy.port}"]
            calibrate = Program(command, folder / "calibrate.txt")

            def is_on():
                return proxy.ask_instrument(":OUTPut1?") == "ON"

            wait_until(is_on, "the output to be on")
            proxy.begin(fault)
            calibrate.send(end)
            since_s = time.monotonic()
            limit_s = HEARD_S if fault != "ignores-off" else ASKED_S
            row.kind = "heard"
            with Output(is_on, calibrate.errors) as output:
                watch_s = min(10.0, arguments.watch_s)
                row.took_s = output.expect_off(limit_s, since_s, watch_s, delay)
            row.figures = off_after(row.took_s)
            row.figures += ", said to be on" if MAY_BE_ON in calibrate.errors() else ""
            if not calibrate.guards:
                raise Failure("no process was seen that guards the output")
            proxy.begin("sound")
            wait_until(lambda: not calibrate.is_guarded(), "the guard of the output to end", 30.0)
            if is_on():
                raise Failure("the process that guards the output has ended, and it is on")
        finally:
            for program in (calibrate, bench):
                if program:
                    program.end()
            if proxy:
                proxy.close()

    return Row(f"calibrate dso-delay, {fault}, {end.name}").run(one)


def expect_left_on(laboratory, chance):
    laboratory.set_by_person(chance.choice((25, 100, 160)))
    until_s = time.monotonic() + chance.uniform(2.5, 5.0)
    while time.monotonic() < until_s:
        if not laboratory.output_is_on():
            raise Failure("a person's output was switched off")
        time.sleep(LOOK_S)  # between two looks
    laboratory.switch_off_by_person()


def healthy_run(laboratory, kind, number, chance):
    run = laboratory.run()
    if kind in ("paused", "interrupted"):
        wait_until(laboratory.output_is_on, "the output to be on")
    if kind == "paused":
        analysis = laboratory.services["dyncal-analysis"]
        analysis.send(signal.SIGSTOP)
        stopped_s = time.monotonic()
        wait_until(lambda: time.monotonic() - stopped_s > 4.5, "the analysis to be missed")
        analysis.send(signal.SIGCONT)
    if kind == "interrupted":
        run.send(signal.SIGINT)
        run.wait(60.0)
        run = laboratory.run()
    status = run.wait(90.0)
    if status != 0:
        raise Failure(f"run {number}, {kind}: exit status {status}: {run.errors()[-300:]}")
    laboratory.expect_whole_result()
    if kind == "person":
        expect_left_on(laboratory, chance)
    if "switched off" in laboratory.guard_words() or MAY_BE_ON in laboratory.guard_words():
        raise Failure(f"run {number}, {kind}: the guard says {laboratory.guard_words()[-300:]}")


def healthy(arguments):
    """One after the other in one laboratory; how many held before the first that did not."""
    chance = random.Random(f"{arguments.seed} healthy")
    counts = dict.fromkeys(HEALTHY, 0)

    def all_of_them(row, folder, _):
        place = (arguments.programs, folder, arguments.vendors)
        with ShortSteps(*place, frequencies=("40", "80")) as laboratory:
            for number in range(arguments.healthy):
                kind = chance.choice(HEALTHY) if arguments.healthy > 1 else "person"
                healthy_run(laboratory, kind, number, chance)
                counts[kind] += 1
            row.figures = ": " + ", ".join(f"{count} {kind}" for kind, count in counts.items())

    row = Row(f"{arguments.healthy} healthy runs").run(all_of_them)
    if row.problem:
        print(f"  before that held: {counts}", flush=True)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--draws", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--held", type=int, default=4)
    parser.add_argument("--calibrations", type=int, default=8)
    parser.add_argument("--healthy", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--vendors", choices=VENDORS, default="mixed")
    parser.add_argument("--watch-s", type=float, default=60.0)
    parser.add_argument("--at-once", type=int, default=3)
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        rows = [pool.submit(healthy, arguments)] if arguments.healthy else []
        numbers = range(arguments.first, arguments.first + arguments.draws)
        rows += [pool.submit(unattended, arguments, number) for number in numbers]
        rows += [pool.submit(held_packet, arguments, number) for number in range(arguments.held)]
        rows += [pool.submit(calibration, arguments, one) for one in range(arguments.calibrations)]
    done = [row.result() for row in rows]
    for kind in ("heard", "asked"):
        times = [row.took_s for row in done if row.kind == kind and row.took_s is not None]
        if times:
            print(f"{kind}: {len(times)} draws, off after {max(times):.2f} s at the worst")
    held = sum(not row.problem for row in done)
    print(f"{held} of {len(done)} hold")
    return 0 if held == len(done) > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
