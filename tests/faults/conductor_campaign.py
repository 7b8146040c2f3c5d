#!/usr/bin/env python3
"""Lets conductors die at drawn instants, and holds that no run takes anything of another one.

    conductor_campaign.py PROGRAMS [--draws 60] [--resumes 20] [--begins 20] [--at-once 3]
                          [--seed 1] [--slack-s 0]

PROGRAMS is the folder of the built programs. Bench (instruments, sources, guard), analysis and two
operators are on a host each, with vendors that are drawn. In each draw `dyncal run --run R1` dies
at a drawn instant: SIGKILL, SIGHUP, Ctrl-C, or its terminal is closed. Then one of these is drawn:

- the same command again at once, on the same or the other host; with the same sensor and bench
  file, with another sensor, or with a bench file whose recipe turns the phase by 0.25 rad and more;
- `--resume R1` with another sensor or with that bench file.

Held: a run that is begun is whole, and every value is that of its own sensor and recipe within five
standard uncertainties of the truth; its own recording gives the same. A resume with another sensor
or recipe is refused by name, and excites nothing; of a run that has ended it may collect what that
one measured.
--resumes: as many runs killed and resumed honestly are whole. --begins: as many times, while a run
conducts, another is refused within 3 s, naming who and where; then the run is killed, and one of a
new name begins within 5 s. --slack-s: more for both, on a busy machine.
Exit status 1 if a draw did not hold, 77 where there are no network namespaces.
"""

import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import pty
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import hosts
from bench_laboratory import READY, VENDORS, BenchLaboratory, Failure, wait_until
from kill_campaign import AGREEMENT_U, expect_off
from link_campaign import HOSTS, SpreadLaboratory

OTHER_OPERATOR = "operator2"
SENSORS = {"mpu9250-ptb": "MPU 9250", "bma280": "BMA 280"}  # presets with the names they send
OTHER_DELAY_S = 1e-3
REFUSED_S = 3.0
RESUME_REFUSED_S = 12.0  # 3 s of listening for another conductor, 3 s to refuse; a busy machine
BEGUN_S = 5.0
RESUMED_S = 60.0  # of a run of some seconds: it waits for nobody who is there
WAYS = ("kill", "hangup", "ctrl-c", "terminal")
NEXT = (
    "again",
    "again, other sensor",
    "again, other recipe",
    "resume, other sensor",
    "resume, other recipe",
)
IN_USE = r"in use by run '\w+' of \S+:\d+"
HAS_ENDED = "has ended at the analysis service"
NOTHING_THERE = ("nothing was measured", "no analysis service holds run")


class ConductorLaboratory(SpreadLaboratory):
    """Its sensor can be exchanged, and there are two operators."""

    places = (*HOSTS, OTHER_OPERATOR)
    operator = "operator"
    delay_s = 0.0
    run_s = 6.0

    def host_of(self, program):
        return self.operator if program == "dyncal" else super().host_of(program)

    def bench_text(self):
        text = super().bench_text().replace("settling_s = 0.5", "settling_s = 0.4")
        text = text.replace("duration_s = 1.5", "duration_s = 0.8")
        return text + f"[corrections]\nreference_delay_s = {self.delay_s}\n"

    def start_program(self, program, arguments):
        if program == "dyncal-virtual-bench":
            self.bench_arguments = list(map(str, arguments))
        return super().start_program(program, arguments)

    def mount(self, preset):
        """Another sensor, at the same addresses; waits until it has told its name."""
        bench = next(one for one in self.started if "dyncal-virtual-bench" in str(one.log))
        bench.end()
        self.started.remove(bench)
        self.preset = preset
        arguments = [*self.bench_arguments, "--acs-listen", f"127.0.0.1:{self.ports['acs']}"]
        arguments += ["--generator-listen", f"{self.generator_host()}:{self.ports['generator']}"]
        arguments[arguments.index("--preset") + 1] = preset
        command = self.hosts.command("bench")
        bench = BenchLaboratory.start_program(self, "dyncal-virtual-bench", arguments, command)
        bench.wait_for_text(READY["dyncal-virtual-bench"])
        self.wait_for_sensor()

    def wait_for_sensor(self):
        name = SENSORS[self.preset]
        wait_until(lambda: name in self.list(), f"{name} to be there", 60.0)

    def list(self):
        command = [*self.hosts.command("operator"), str(self.programs / "dyncal"), "list"]
        command += ["--domain", str(self.domain), "--dds", self.vendors["dyncal"]]
        command += ["--interface", "lab"]
        return subprocess.run(command, check=False, capture_output=True, text=True).stdout

    def turn_recipe(self):
        self.delay_s = OTHER_DELAY_S
        self.bench_file.write_text(self.bench_text(), encoding="utf-8")

    def conduct(self, *arguments, folder="runs"):
        return self.run(*arguments, "--folder", self.folder / folder, "--store", "none")

    def die(self, run, way):
        """Of a run that conduct() has started; `way` "terminal" needs one."""
        if way == "terminal":
            os.close(self.master)
        else:
            numbers = {"kill": signal.SIGKILL, "hangup": signal.SIGHUP, "ctrl-c": signal.SIGINT}
            run.send(numbers[way])

    def open_terminal(self):
        self.master, self.terminal = pty.openpty()

    def leave_terminal(self):
        os.close(self.terminal)
        self.terminal = None

    def truth(self):
        """Of the sensor that is mounted: H by channel and frequency."""
        truth = json.loads((self.folder / "truth.json").read_text(encoding="utf-8"))
        return {
            (f"dau/{one['channel']}", one["frequency_text_hz"]): one
            for one in truth["transfer_function"]
        }

    def expect_own_values(self, preset, truth, whole=True):
        """Every value is of this sensor and this bench file. A host that collects what another one
        has measured does not know with which sensor, and names none."""
        result = self.result()
        named = {one["source"]: one["device"] for one in result["sources"]}
        valid = [point for point in result["points"] if point["valid"]]
        is_unknown = not whole and self.operator == OTHER_OPERATOR and not named
        if valid and named.get("dau") != SENSORS[preset] and not is_unknown:
            raise Failure(f"the result names {named.get('dau')}, not {SENSORS[preset]}")
        if whole:
            self.expect_whole_result()
        for point in valid:
            self.expect_truth(point, truth[point["channel"], point["frequency_text_hz"]])

    def expect_truth(self, point, true):
        phase_rad = true["phase_rad"] - 2.0 * math.pi * true["frequency_hz"] * self.delay_s
        off_rad = math.remainder(point["phase_rad"] - phase_rad, 2.0 * math.pi)
        off = {
            "magnitude": (point["magnitude"] - true["magnitude"]) / point["u_magnitude"],
            "phase": off_rad / point["u_phase_rad"],
        }
        for name, distance_u in off.items():
            if not abs(distance_u) <= AGREEMENT_U:
                raise Failure(f"{point['channel']} step {point['step']}: {name} {distance_u:.1f} u")


def expect_confirmed(run, status):
    """Ended with 0, and with its own recording."""
    if status != 0:
        raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
    if "the recording of the run, evaluated once more, gives the same" not in run.errors():
        raise Failure(f"not confirmed: {run.errors().strip().splitlines()[-1:]}")


def expect_refused(laboratory, run, name, first):
    """By this name, or the run had ended and only what it measured is collected.

    `first`: preset and truth of the sensor that it began with.
    """
    began_s = time.monotonic()
    status = run.wait()
    took_s = time.monotonic() - began_s
    said = run.errors()
    if re.search(r"step \d+ of", said):
        raise Failure(f"resumed, exit status {status}: {said[-300:]}")
    if HAS_ENDED in said and name not in said:
        laboratory.expect_own_values(*first, whole=False)
        return "ended before, collected"
    if status == 0 or not any(one in said for one in (name, *NOTHING_THERE)):
        raise Failure(f"exit status {status}: {said[-300:]}")
    if name in said and took_s > RESUME_REFUSED_S:
        raise Failure(f"refused only after {took_s:.1f} s: {said[-300:]}")
    return f"refused after {took_s:.1f} s"


def next_run(laboratory, what, has_begun):
    """What comes after a death; returns what came out.

    A run that has not begun its first step has no sensor yet: it may be resumed with any.
    """
    first = laboratory.preset, laboratory.truth()
    if "sensor" in what:
        laboratory.mount("bma280")
    if "recipe" in what:
        laboratory.turn_recipe()
    if what.startswith("resume"):
        # Another host has another folder: what the run began with, only the analysis knows.
        elsewhere = laboratory.operator == OTHER_OPERATOR
        run = laboratory.conduct("--resume", "R1", folder="elsewhere" if elsewhere else "runs")
        if not has_begun and "sensor" in what and run.wait() == 0:
            laboratory.expect_own_values(laboratory.preset, laboratory.truth())
            return "whole, for it had not begun"
        if "recipe" in what:
            return expect_refused(laboratory, run, "another bench file", first)
        return expect_refused(laboratory, run, "another instrument", first)
    run = laboratory.conduct("--run", "R1")
    expect_confirmed(run, run.wait())
    laboratory.expect_own_values(laboratory.preset, laboratory.truth())
    return "whole"


def in_laboratory(arguments, name, vendors, judge):
    """judge(laboratory) in one of its own, what came out in a line; whether it held."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-conductor-"))
    began_s = time.monotonic()
    try:
        with ConductorLaboratory(arguments.programs, folder, vendors) as laboratory:
            laboratory.wait_for_sensor()
            came_out = judge(laboratory)
            expect_off(laboratory)
    except (Failure, OSError, KeyError) as failure:
        print(f"{name}: {failure} (logs in {folder})", flush=True)
        return None
    shutil.rmtree(folder, ignore_errors=True)
    print(f"{name}: {came_out} ({time.monotonic() - began_s:.0f} s)", flush=True)
    return came_out


def draw(arguments, number):
    chance = random.Random(f"{arguments.seed} {number}")
    way, what = WAYS[number % len(WAYS)], NEXT[number % len(NEXT)]
    vendors = chance.choice(list(VENDORS))
    other_host = chance.random() < 0.5
    instant_s = chance.uniform(0.3, ConductorLaboratory.run_s)
    place = "other host" if other_host else "same host"
    name = f"draw {number:3} {vendors:10} {way} after {instant_s:.1f} s, {what}, {place}"

    def judge(laboratory):
        if way == "terminal":
            laboratory.open_terminal()
        run = laboratory.conduct("--run", "R1")
        if way == "terminal":
            laboratory.leave_terminal()
        time.sleep(instant_s)  # the drawn instant
        laboratory.die(run, way)
        run.wait(60.0)
        has_begun = "step 1 of" in run.errors()
        (laboratory.folder / "run.json").unlink(missing_ok=True)
        laboratory.operator = OTHER_OPERATOR if other_host else "operator"
        return next_run(laboratory, what, has_begun)

    return in_laboratory(arguments, name, vendors, judge) is not None


def resume(arguments, number):
    chance = random.Random(f"{arguments.seed} resume {number}")
    vendors = chance.choice(list(VENDORS))
    instant_s = chance.uniform(0.1, 4.0)
    name = f"resume {number:3} {vendors:10} killed {instant_s:.1f} s after the first step began"

    def judge(laboratory):
        run = laboratory.conduct("--run", "R1")
        run.wait_for_text("step 1 of")
        time.sleep(instant_s)  # the drawn instant
        laboratory.die(run, "kill")
        run.wait()
        laboratory.operator = chance.choice(("operator", OTHER_OPERATOR))
        if number % 2 == 0:
            expect_off(laboratory)  # its guard has noticed, and says that it hears nothing
        again = laboratory.conduct("--resume", "R1")
        status = again.wait(RESUMED_S)
        if status != 0:
            raise Failure(f"exit status {status}: {again.errors().strip().splitlines()[-1:]}")
        laboratory.expect_own_values(laboratory.preset, laboratory.truth())
        return "whole; " + again.errors().strip().splitlines()[-1][:120]

    return in_laboratory(arguments, name, vendors, judge) is not None


def begins(arguments, vendors, count):
    """All in one laboratory; whether each was refused, and begun, in time."""
    took = {"refused": [], "begun": []}

    def judge(laboratory):
        chance = random.Random(f"{arguments.seed} begin {vendors}")
        run = laboratory.conduct("--run", "first")
        run.wait_for_text("step 1 of")
        for number in range(count):
            laboratory.operator = OTHER_OPERATOR
            began_s = time.monotonic()
            other = laboratory.conduct("--run", "other", folder="others")
            if other.wait() == 0 or not re.search(IN_USE, other.errors()):
                raise Failure(f"not refused: {other.errors()[-300:]}")
            took["refused"].append(time.monotonic() - began_s)
            laboratory.operator = "operator"
            time.sleep(chance.uniform(0.0, 1.0))  # the drawn instant
            run.send(signal.SIGKILL)
            began_s = time.monotonic()
            laboratory.started.remove(run)
            run = laboratory.conduct("--run", f"new{number}")
            run.wait_for_text("step 1 of", 60.0)
            took["begun"].append(time.monotonic() - began_s)
        run.send(signal.SIGINT)
        run.wait()
        return ", ".join(
            f"{what} after {min(one):.2f} to {max(one):.2f} s" for what, one in took.items()
        )

    name = f"{count} beginnings, {vendors}"
    if in_laboratory(arguments, name, vendors, judge) is None:
        return False
    late = sum(one > REFUSED_S + arguments.slack_s for one in took["refused"])
    late += sum(one > BEGUN_S + arguments.slack_s for one in took["begun"])
    if late:
        print(f"{name}: {late} later than {REFUSED_S:g} s and {BEGUN_S:g} s", flush=True)
    return late == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--draws", type=int, default=60)
    parser.add_argument("--first", type=int, default=0, help="of the draws")
    parser.add_argument("--resumes", type=int, default=20)
    parser.add_argument("--first-resume", type=int, default=0)
    parser.add_argument("--begins", type=int, default=20, help="over all vendors")
    parser.add_argument("--at-once", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--slack-s", type=float, default=0.0)
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    held = []
    names = list(VENDORS)
    for place, vendors in enumerate(names):  # alone: they are about seconds
        count = arguments.begins // len(names) + (place < arguments.begins % len(names))
        if count > 0:
            held.append(begins(arguments, vendors, count))
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        numbers = range(arguments.first, arguments.first + arguments.draws)
        draws = [pool.submit(draw, arguments, number) for number in numbers]
        numbers = range(arguments.first_resume, arguments.first_resume + arguments.resumes)
        resumes = [pool.submit(resume, arguments, number) for number in numbers]
        held += [one.result() for one in draws + resumes]
        print(f"{sum(one.result() for one in draws)} of {len(draws)} draws hold")
        print(f"{sum(one.result() for one in resumes)} of {len(resumes)} resumes are whole")
    return 0 if held and all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
