#!/usr/bin/env python3
"""Lets another program describe itself as a source and go, and judges the runs afterwards.

    twin_campaign.py PROGRAMS [--draws 30] [--seed 1] [--vendors cyclonedds,...] [--at-once 3]
                     [--kinds twin,older,replay] [--secured]

PROGRAMS is the folder of the built programs. The other is a `twin`, a second dyncal-dau of the same
name with a sensor of another type and range, that lives for 2 to 8 s; an `older` program of the
first contract, that describes the source once with another channel (older_source); or a `replay` of
an earlier run as this bench, which is refused while the bench is live, and otherwise goes on when
its services come. The other ends or is killed before a run begins, 0 to 4 s before it or while the
run waits; or it comes in the run. Secured, a twin has a certificate of the same role.

Held: a run that begins after it has gone is in its first step within 15 s, and is whole: every
value, valid, without loss and flag, those of an undisturbed run. What comes in a run may pause it
or end it, and is named then; the run after it is whole. Of two services that send in a run, `dyncal
doctor` and what the page shows name both processes in one sentence.
Exit status 1 if a draw did not hold.
"""

import argparse
import concurrent.futures
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from bench_laboratory import VENDORS, BenchLaboratory, Failure, free_udp_port, wait_until
from kill_campaign import expect_off, judge, undisturbed_result

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "security"))
from secured_bench import SecuredBench  # noqa: E402

FIRST_STEP_S = 15.0
NAMES_IT = ("two services", "send as source", "no channel", "describes itself", "goes on")
SEEN = ("that described itself as this source has gone", "two services", "two programs")
IS_LIVE = "is live in this domain"
OTHER_PRESET = "bma280"


class Described:
    """Of a live bench that another program takes for its own."""

    def look(self, *words):
        """What a command that looks at the laboratory prints."""
        place = ["--domain", self.domain, "--dds", self.vendors["dyncal"]]
        command = [self.programs / "dyncal", *words, *place, "--seconds", 4]
        environment = {**os.environ, **self.environments.get("dyncal", {})}
        return subprocess.run(
            [*map(str, command)], capture_output=True, text=True, env=environment, check=False
        ).stdout

    def wait_for_source(self):
        """Others have found it by then; so has the analysis, which is there for longer."""
        wait_until(lambda: "source dau  running" in self.look("list"), "source dau", 60.0)

    def expect_named(self, other):
        """Two that send as the source, in one sentence."""
        both = [f":{one.process.pid}" for one in (self.services["dyncal-dau"], other)]
        self.services["dyncal-analysis"].wait_for_text("two services", 30.0)
        for words in (("doctor",), ("list", "--json")):
            said = [line for line in self.look(*words).splitlines() if "two services" in line]
            if not any(all(pid in line for pid in both) for line in said):
                raise Failure(f"{words[0]} does not name {both}: {said[:2]}")

    def start_twin(self, vendor):
        """A second dyncal-dau of the same source, with a unit and a bench file of its own."""
        unit = f"127.0.0.1:{free_udp_port()}"
        self.start_program("dyncal-virtual-bench", ["--preset", OTHER_PRESET, "--dau", unit])
        bench_file = self.folder / "twin.toml"
        text = self.bench_file.read_text(encoding="utf-8")
        bench_file.write_text(text.replace(self.dau, unit), encoding="utf-8")
        place = [bench_file, "--domain", self.domain, "--dds", vendor]
        twin = self.start_program("dyncal-dau", place)
        twin.wait_for_text("listening at UDP")
        return twin

    def start_replay(self, vendor):
        """Of the run before, with its results."""
        recording = next((self.folder / "runs").rglob("*.mcap"))
        words = ["replay", recording, "--domain", self.domain, "--dds", vendor]
        if isinstance(self, SecuredBench):
            words += ["--security", self.security / "source"]
        return self.start_program("dyncal", words)

    def expect_refused(self, replay):
        if replay.wait() != 1 or IS_LIVE not in replay.errors():
            raise Failure(f"the replay ended otherwise: {replay.errors()[-300:]}")

    def replay_before_services(self, vendor, chance):
        """Its sources come while it plays; it is stopped or has ended when this returns."""
        for service in ("dyncal-dau", "dyncal-acs"):
            self.services[service].end()
        wait_until(lambda: "source dau" not in self.look("list"), "the sources to be gone", 60.0)
        replay = self.start_replay(vendor)
        self.wait_for_source()  # the replay's
        for service in ("dyncal-dau", "dyncal-acs"):
            self.restart(service)
        run = self.run("--run", "replayed-beside")
        time.sleep(chance.uniform(0.0, 4.0))  # drawn
        replay.send(chance.choice((signal.SIGTERM, signal.SIGKILL)))
        replay.wait(20.0)
        return run

    def start_older(self, vendor, lives_s):
        place = [vendor, self.domain, self.name, "dau", lives_s]
        return self.start_program("older_source", place)


class PlainLaboratory(Described, BenchLaboratory):
    pass


class SecuredLaboratory(Described, SecuredBench):
    pass


def other_program(laboratory, kind, chance, in_run=False):
    """Comes, lives and has gone."""
    vendor = chance.choice(("cyclonedds", "fastdds"))
    lives_s = chance.uniform(2.0, 8.0)
    if kind == "twin":
        other = laboratory.start_twin(vendor)
        if in_run:
            laboratory.expect_named(other)
    elif kind == "replay":
        laboratory.expect_refused(laboratory.start_replay(vendor))
        return
    else:
        other = laboratory.start_older(vendor, 60.0)
        other.wait_for_text("described")
    time.sleep(lives_s)  # drawn
    if not other.runs():
        raise Failure(f"the other program has failed: {other.errors()[-300:]}")
    other.send(chance.choice((signal.SIGTERM, signal.SIGKILL)))
    other.wait(20.0)


def whole_run(laboratory, undisturbed, slack_s):
    began_s = time.monotonic()
    run = laboratory.run()
    run.wait_for_text("step 1 of", FIRST_STEP_S + slack_s)
    first_s = time.monotonic() - began_s
    status = run.wait()
    expect_off(laboratory)
    if status != 0:
        raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
    judge(laboratory, undisturbed)
    return first_s


def disturbed_run(laboratory, kind, chance, undisturbed):
    """The other program comes in the run, which is whole or says what is wrong."""
    run = laboratory.run("--run", "disturbed")
    run.wait_for_text("step 1 of")
    other_program(laboratory, kind, chance, in_run=True)
    judge_disturbed(laboratory, run, undisturbed)


def judge_disturbed(laboratory, run, undisturbed):
    if run.wait() == 0:
        judge(laboratory, undisturbed)
    elif not any(one in run.errors() for one in NAMES_IT):
        raise Failure(f"a wrong cause: {run.errors().strip().splitlines()[-1:]}")


def draw(arguments, number, undisturbed):
    vendors = arguments.vendors[number % len(arguments.vendors)]
    chance = random.Random(f"{arguments.seed} {number} {vendors}")
    kind = arguments.kinds[number // len(arguments.vendors) % len(arguments.kinds)]
    in_run = chance.random() < 0.3
    pause_s = chance.choice((0.0, chance.uniform(0.0, 4.0)))
    what = f"{number:3} {vendors:11} {kind:6} {'in a run' if in_run else 'between'}"
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-twin-"))
    bench = SecuredLaboratory if arguments.secured else PlainLaboratory
    try:
        with bench(arguments.programs, folder, vendors) as laboratory:
            laboratory.wait_for_source()
            if kind == "replay" and laboratory.run("--folder", folder / "runs").wait() != 0:
                raise Failure("the run that is to be replayed has failed")
            if in_run:
                disturbed_run(laboratory, kind, chance, undisturbed)
            else:
                other_program(laboratory, kind, chance)
            if kind == "replay" and not arguments.secured:
                vendor = chance.choice(("cyclonedds", "fastdds"))
                run = laboratory.replay_before_services(vendor, chance)
                judge_disturbed(laboratory, run, undisturbed)
            time.sleep(pause_s)  # drawn
            first_s = whole_run(laboratory, undisturbed, arguments.slack_s)
            log = laboratory.services["dyncal-analysis"].errors()
            if kind != "replay" and not any(one in log for one in SEEN):
                raise Failure("the analysis has not seen the other program")
    except Failure as failure:
        print(f"{what}: {failure} (logs in {folder})", flush=True)
        return False
    shutil.rmtree(folder)
    print(f"{what}: holds, first step {first_s:.1f} s after the run began", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--draws", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    parser.add_argument("--at-once", type=int, default=3)
    parser.add_argument("--kinds", type=lambda text: text.split(","), default=None)
    parser.add_argument("--secured", action="store_true")
    parser.add_argument("--slack-s", type=float, default=3.0, help="of a busy machine")
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    # A program of the first contract is not secured, and not heard.
    usual = ("twin", "replay") if arguments.secured else ("twin", "older", "replay")
    arguments.kinds = arguments.kinds or usual
    undisturbed = undisturbed_result(arguments, BenchLaboratory)
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        held = list(
            pool.map(lambda number: draw(arguments, number, undisturbed), range(arguments.draws))
        )
    print(f"{sum(held)} of {len(held)} hold")
    return 0 if held and all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
