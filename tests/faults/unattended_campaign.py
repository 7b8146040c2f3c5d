#!/usr/bin/env python3
"""Lets operator, guard, path and generator fail in drawn order, and holds that nothing stays on.

    unattended_campaign.py PROGRAMS [--draws 60] [--seed 1] [--vendors mixed] [--watch-s 60]
                           [--slack-s 0.5] [--healthy 3]

PROGRAMS is the folder of the built programs. Bench (instruments, sources, guard), analysis and
operator are on a host each. In each draw a run is in its first step; then, within 4 s, the
operator's host loses its power, or its path loses all of its datagrams; the guard dies in half of
the draws, at any time around that, and is back after up to 10 s; the generator is sound, ignores
OFF, answers late, or falls mute. Held: from the moment when the run is not attended and the guard
is there, the output is off after 2.1 s where the guard heard the run die, else 3.5 s, and stays off
for --watch-s; or the guard says MAY BE ON.

The opposite, --healthy times: a run, and after it a person who uses the generator with settings of
their own: nothing is switched off, and the run is whole.
Exit status 1 if a draw did not hold, 77 where there are no network namespaces.
"""

import argparse
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

import hosts
from bench_laboratory import VENDORS, Failure, wait_until
from generator_proxy import FAULTS, GeneratorProxy
from link_campaign import SpreadLaboratory

HEARD_S = 2.1  # idl/README.md, deploy/README.md
ASKED_S = 3.5
LOOK_S = 0.05
MAY_BE_ON = "MAY BE ON"
NO_DATAGRAMS = """
table ip unattended {
  chain lost { type filter hook output priority 0; meta l4proto udp drop; }
}
"""


class GuardedLaboratory(SpreadLaboratory):
    """Its generator is reached through a proxy, and asked directly by the campaign."""

    proxy = None
    link = None

    def bench_text(self):
        place = (self.generator_host(), self.ports["generator"])
        self.proxy = GeneratorProxy(
            place,
            lambda function: self.hosts.call("bench", function),
            lambda: self.hosts.enter("bench"),
        )
        text = super().bench_text()
        return text.replace(f":{place[1]}", f":{self.proxy.port}").replace(
            "duration_s = 1.5", f"duration_s = {self.duration_s}"
        )

    duration_s = 1.5

    def ask_generator(self, line):
        """Directly, over one connection."""

        def ask():
            if self.link is None:
                place = (self.generator_host(), self.ports["generator"])
                self.link = socket.create_connection(place, 10.0).makefile("rw")
            self.link.write(line + "\n")
            self.link.flush()
            return self.link.readline().strip()

        return self.hosts.call("bench", ask)

    def output_is_on(self):
        return self.ask_generator(":OUTPut1?") == "ON"

    def set_by_person(self, frequency_hz):
        for line in (f":SOURce1:FREQuency {frequency_hz}", ":OUTPut1 ON"):
            self.ask_generator(f"{line}\n:SYSTem:ERRor?")

    def lose_datagrams(self):
        nft = [*self.hosts.command("operator"), "nft", "-f", "-"]
        subprocess.run(nft, check=True, input=NO_DATAGRAMS, text=True)

    def close(self):
        if self.proxy:
            self.proxy.close()
        super().close()


class LongSteps(GuardedLaboratory):
    duration_s = 300.0


def guard_words(laboratory):
    return "".join(
        one.errors() for one in laboratory.started if "dyncal-guard" in str(one.log)
    )


def expect_off(laboratory, limit_s, since_s, fault, watch_s):
    """Off within `limit_s`, and then for `watch_s`; or said to be on."""
    last_on_s = None
    until_s = since_s + limit_s + watch_s
    while time.monotonic() < until_s:
        now_s = time.monotonic()
        if laboratory.output_is_on():
            last_on_s = now_s
            if now_s - since_s > limit_s and MAY_BE_ON not in guard_words(laboratory):
                raise Failure(f"{fault}: on {now_s - since_s:.2f} s after, and nobody says so")
        time.sleep(LOOK_S)  # between two looks
    return (last_on_s or since_s) - since_s


def draw(arguments, number):
    chance = random.Random(f"{arguments.seed} {number}")
    fault = FAULTS[number % len(FAULTS)]
    death = chance.choice(("power", "datagrams"))
    guard_dies = chance.random() < 0.5
    dies_s, guard_dies_s = chance.uniform(0.5, 4.0), chance.uniform(0.5, 4.0)
    guard_away_s = chance.uniform(0.0, 10.0)
    case = f"{fault}, {death} after {dies_s:.1f} s"
    if guard_dies:
        case += f", guard away from {guard_dies_s:.1f} s on for {guard_away_s:.1f} s"
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-unattended-"))
    try:
        with LongSteps(arguments.programs, folder, arguments.vendors) as laboratory:
            run = laboratory.run()
            run.wait_for_text("step 1 of")
            wait_until(laboratory.output_is_on, "the output to be on")
            laboratory.services["dyncal-guard"].wait_for_text("watching over run", 10.0)
            began_s = time.monotonic()

            def operator_dies():
                if death == "power":
                    laboratory.hosts.set_cable("operator", "down")
                    run.send(signal.SIGKILL)
                else:
                    laboratory.lose_datagrams()

            def guard_is_killed():
                laboratory.services["dyncal-guard"].send(signal.SIGKILL)

            events = [(dies_s, operator_dies), (dies_s, lambda: laboratory.proxy.begin(fault))]
            if guard_dies:
                events.append((guard_dies_s, guard_is_killed))
            for due_s, event in sorted(events, key=lambda one: one[0]):
                time.sleep(max(0.0, began_s + due_s - time.monotonic()))  # the drawn instants
                event()
            since_s, limit_s = time.monotonic(), HEARD_S
            if guard_dies:
                back_s = began_s + guard_dies_s + guard_away_s
                time.sleep(max(0.0, back_s - time.monotonic()))
                laboratory.restart("dyncal-guard")
                since_s, limit_s = time.monotonic(), ASKED_S
            took_s = expect_off(
                laboratory, limit_s + arguments.slack_s, since_s, fault, arguments.watch_s
            )
            said = ", said to be on" if MAY_BE_ON in guard_words(laboratory) else ""
            print(f"{number:3} {case}: off after {took_s:.2f} s{said}", flush=True)
    except Failure as failure:
        print(f"{number:3} {case}: {failure} (logs in {folder})", flush=True)
        return False
    shutil.rmtree(folder)
    return True


def healthy(arguments, number):
    """A run with a person's use after it."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-attended-"))
    try:
        with GuardedLaboratory(arguments.programs, folder, arguments.vendors) as laboratory:
            run = laboratory.run()
            status = run.wait(60.0)
            if status != 0:
                raise Failure(f"exit status {status}: {run.errors()[-300:]}")
            laboratory.expect_whole_result()
            laboratory.set_by_person(100)
            laboratory.services["dyncal-guard"].wait_for_text("it is left on", 20.0)
            until_s = time.monotonic() + arguments.watch_s
            while time.monotonic() < until_s:
                if not laboratory.output_is_on():
                    raise Failure("a person's output was switched off")
                time.sleep(LOOK_S)  # between two looks
            words = guard_words(laboratory)
            if "switched off" in words or "it is left on" not in words:
                raise Failure(f"the guard says: {words[-300:]}")
            print(f"healthy {number}: holds", flush=True)
    except Failure as failure:
        print(f"healthy {number}: {failure} (logs in {folder})", flush=True)
        return False
    shutil.rmtree(folder)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--draws", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--healthy", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--vendors", choices=VENDORS, default="mixed")
    parser.add_argument("--watch-s", type=float, default=60.0)
    parser.add_argument("--slack-s", type=float, default=0.5, help="of a busy machine")
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    numbers = range(arguments.first, arguments.first + arguments.draws)
    held = [draw(arguments, number) for number in numbers]
    held += [healthy(arguments, number) for number in range(arguments.healthy)]
    print(f"{sum(held)} of {len(held)} hold")
    return 0 if held and all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
