#!/usr/bin/env python3
"""Attacks on live benches, plain and secured, by programs of our own; makes the table of README.md.

    attack_campaign.py PROGRAMS [--draws 6] [--seed 1] [--vendors cyclonedds,fastdds,mixed]
      [--attacks samples,...] [--modes plain,secured] [--at-once 3] [--write README.md]

PROGRAMS is the folder of the built programs. From a drawn step of a run on, a program that uses a
DDS library of its own (forger.cpp, over a drawn implementation) sends, for at most a minute,
`samples` of a source one block ahead and larger by a drawn factor, `results` larger, `statuses` of
an analysis that failed, `measurements` that are aborted, a `command` to abort, or repeats
`excitations` while the conductor stands; or raw packets announce 500 new participants a second
(`flood`), or say that each program that is here is gone (`gone`).

Held plain: every value is there as in an undisturbed run, or is flagged or left out, or the run
ends, and what forges is named; the output is never on for more than 2 s without its conductor;
floods change nothing. Held secured: the forger hears nothing, the run is whole and unflagged, and
`dyncal doctor` says that a program is there that it may not talk to. Exit status 1 if something did
not hold.
"""

import argparse
import concurrent.futures
import math
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from bench_laboratory import VENDORS, BenchLaboratory, Failure, wait_until  # noqa: E402
from crafted_packets import (  # noqa: E402
    PARTICIPANTS,
    SENTINEL,
    announcement,
    data,
    entity,
    packet,
    parameter,
    parameters,
)
from crafted_packets_test import Ear  # noqa: E402
from kill_campaign import AGREEMENT_U, FLAGS_OF_ANY_RUN, judge, undisturbed_result  # noqa: E402
from secured_bench import SecuredBench  # noqa: E402

FREQUENCIES = ("40", "80", "125")
MAX_UNATTENDED_S = 2.0
MAX_ATTACK_S = 60.0  # a run that is held up goes on afterwards
PARTICIPANTS_PER_S = 500
OUTSIDER = "(is|are) here that this program may not talk to"
NAMED = {  # plain, by whom it is said: the run, the analysis, the guard
    "samples": r"two programs send in the name of source '[a-z]+' .* forger:\d+",
    "results": r"forger:\d+ .*publishes about this run and is not its analysis",
    "statuses": r"forger:\d+ .*publishes about this run and is not its analysis",
    "commands": r"ended by a command of forger:\d+",
    "excitations": r"were passed over",
}
ATTACKS = ("samples", "results", "statuses", "measurements", "commands", "excitations")
FLOODS = ("flood", "gone")


class PlainLaboratory(BenchLaboratory):
    def told_by(self, command):
        words = [self.programs / "dyncal", command, "--seconds", 3, "--domain", self.domain]
        environment = {**os.environ, **self.environments.get("watcher", {})}
        told = subprocess.run(
            [*map(str, words), "--dds", self.vendors["dyncal"]],
            capture_output=True,
            text=True,
            check=False,
            env=environment,
        )
        return told.stdout

    def wait_for_sources(self):
        def are_listed():
            listed = self.told_by("list")
            return all(f"source {name}  running" in listed for name in ("dau", "acs"))

        wait_until(are_listed, "both sources in `dyncal list`", 120.0)


class SecuredLaboratory(SecuredBench, PlainLaboratory):
    def __init__(self, programs, folder, vendors):
        super().__init__(programs, folder, vendors, frequencies=FREQUENCIES)
        self.issue(programs, "watcher", "watcher")
        self.environments["watcher"] = {"DYNCAL_SECURITY": str(self.security / "watcher")}


def gone(prefix):
    """That this participant has left, in its own name."""
    guid = prefix + entity(0x000001C1)
    status = parameter(0x71, b"\0\0\0\3") + parameter(0x70, guid) + SENTINEL
    left = data(PARTICIPANTS, parameters(parameter(0x50, guid)), flags=0x0B, inline_qos=status)
    return packet(prefix, left)


class Flood(threading.Thread):
    """Packets to where participants of a domain listen, until stop()."""

    def __init__(self, kind, domain, chance):
        super().__init__(daemon=True)
        first = 7400 + 250 * domain
        of_participants = [("127.0.0.1", first + 10 + 2 * i) for i in range(9)]
        self.places = [("239.255.0.1", first), *of_participants]
        self.kind, self.chance = kind, chance
        self.ear = Ear(range(first, first + 250)) if kind == "gone" else None
        self.ends = threading.Event()
        self.sent = 0

    def packets(self):
        if self.kind == "gone":
            return [gone(prefix) for prefix in sorted(self.ear.prefixes())]
        prefix = self.chance.choice((b"\1\x0f", b"\1\x10")) + self.chance.randbytes(10)
        return [packet(prefix, announcement(prefix))]

    def run(self):
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        pause_s = 0.25 if self.kind == "gone" else 1.0 / PARTICIPANTS_PER_S
        while not self.ends.wait(pause_s):
            for one in self.packets():
                for place in self.places:
                    out.sendto(one, place)
                self.sent += 1

    def stop(self):
        self.ends.set()
        self.join()
        if self.sent < 20:
            raise Failure(f"only {self.sent} packets were sent")


def flags_of(value):
    return [one for one in value.get("flags", []) if one not in FLAGS_OF_ANY_RUN]


def place_of(value):
    return tuple(value.get(key) for key in ("step", "repetition", "channel", "frequency_hz"))


def changed_values(result, undisturbed):
    """Values that say nothing of it."""
    changed = []
    for kind in ("points", "transfer_function"):
        known = {place_of(one): one for one in undisturbed[kind]}
        for value in result.get(kind, []):
            if not value.get("valid", True) or flags_of(value):
                continue
            for name in ("magnitude", "phase_rad"):
                other = known[place_of(value)]
                u = math.hypot(value["u_" + name], other["u_" + name])
                if not abs(value[name] - other[name]) <= AGREEMENT_U * u:
                    changed.append((kind, place_of(value), name))
    return changed


def expect_output_off(laboratory, run):
    """Its conductor stands; returns for how long the output was on."""
    run.send(signal.SIGSTOP)
    stopped_s = time.monotonic()
    wait_until(lambda: not laboratory.output_is_on(), "the output to be off", 20.0, 0.005)
    on_s = time.monotonic() - stopped_s
    if on_s > MAX_UNATTENDED_S + laboratory.slack_s:
        raise Failure(f"the output was on for {on_s:.2f} s")
    run.send(signal.SIGCONT)
    run.send(signal.SIGINT)
    return on_s


def end_of(forger):
    forger.end()
    counts = re.search(r"heard (\d+) forged (\d+)", forger.errors())
    if not counts:
        raise Failure(f"the forger: {forger.errors()}")
    return int(counts[1]), int(counts[2])


def judge_plain(laboratory, attack, run, undisturbed):
    """Returns what became of the run."""
    if attack in FLOODS:
        judge(laboratory, undisturbed)
        return "whole"
    said = "".join(one.errors() for one in laboratory.started)
    if attack in NAMED and not re.search(NAMED[attack], said):
        raise Failure("what forges is not named")
    if attack == "excitations":
        return "output off"
    result = laboratory.result() if (laboratory.folder / "run.json").exists() else {}
    if changed := changed_values(result, undisturbed):
        raise Failure(f"changed without a flag: {changed}")
    missing = len(result.get("points", [])) < len(undisturbed["points"])
    flagged = any(flags_of(one) or not one["valid"] for one in result.get("points", []))
    if not (missing or flagged):
        return "whole"
    return "ended" if missing else "flagged"


def judge_secured(laboratory, attack, run, status, heard, told, undisturbed):
    if heard > 0:
        raise Failure(f"the forger heard {heard} messages")
    if attack != "gone" and not re.search(OUTSIDER, told):
        raise Failure(f"the doctor does not tell of an outsider: {told}")
    if attack == "excitations":
        return "output off"
    if status != 0:
        raise Failure(f"the run ended with {status}: {run.errors().strip().splitlines()[-1:]}")
    judge(laboratory, undisturbed)
    return "whole"


def begun_run(laboratory, step):
    """In this step. On a busy machine it may give up before secured programs know each other."""
    for is_last in (False, False, True):
        run = laboratory.run()
        try:
            run.wait_for_text(f"step {step} of {len(FREQUENCIES)}")
            return run
        except Failure:
            if is_last or "is not on the network" not in run.errors():
                raise
    raise AssertionError


def end_by(run, patience_s):
    try:
        run.wait(patience_s)
    except Failure:
        pass  # it is held up


def start_forger(laboratory, attack, chance):
    source, factor = chance.choice(("dau", "acs")), chance.choice((0.7, 0.9, 1.1, 1.5, 42.0))
    vendor = chance.choice(("cyclonedds", "fastdds"))
    place = [vendor, laboratory.domain, laboratory.name, attack, source, factor]
    forger = laboratory.start_program("forger", place)
    forger.wait_for_text("forging")
    return forger


def under_attack(laboratory, attack, is_secured, chance, undisturbed):
    """Returns what became of the run, and for how long the output was on unattended."""
    flood = Flood(attack, laboratory.domain, chance) if attack in FLOODS else None
    step = chance.randrange(1, len(FREQUENCIES))
    run = begun_run(laboratory, step)
    forger = None if flood else start_forger(laboratory, attack, chance)
    if flood:
        flood.start()
    on_s = 0.0
    if attack == "excitations":
        if not is_secured:
            laboratory.services["dyncal-guard"].wait_for_text("were passed over")
        wait_until(laboratory.output_is_on, "the output to be on", interval_s=0.005)
        on_s = expect_output_off(laboratory, run)
    told = laboratory.told_by("doctor") if is_secured else ""
    end_by(run, MAX_ATTACK_S)
    heard, forged = end_of(forger) if forger else (0, 0)
    if flood:
        flood.stop()
    status = run.wait()
    if is_secured:
        became = judge_secured(laboratory, attack, run, status, heard, told, undisturbed)
        return became, on_s
    if forger and forged == 0:
        raise Failure("nothing was forged")
    return judge_plain(laboratory, attack, run, undisturbed), on_s


def draw(arguments, mode, attack, vendors, number, undisturbed):
    what = f"{mode:7} {attack:12} {vendors:10} {number}"
    chance = random.Random(f"{arguments.seed} {what}")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-attack-"))
    bench = SecuredLaboratory if mode == "secured" else PlainLaboratory
    try:
        with bench(arguments.programs, folder, vendors) as laboratory:
            laboratory.slack_s = arguments.slack_s
            laboratory.wait_for_sources()
            became, on_s = under_attack(laboratory, attack, mode == "secured", chance, undisturbed)
    except Failure as failure:
        print(f"{what}: {failure} (logs in {folder})", flush=True)
        return None
    shutil.rmtree(folder)
    print(f"{what}: holds, {became}{f', on for {on_s:.2f} s' if on_s else ''}", flush=True)
    return became, on_s


def cell(draws):
    """Of one attack over one DDS implementation."""
    if not draws:
        return "-"
    held = [one for one in draws if one]
    became = sorted({one[0] for one in held})
    counts = [f"{sum(one[0] == kind for one in held)} {kind}" for kind in became]
    longest_s = max((one[1] for one in held), default=0.0)
    on = f", at most {longest_s:.1f} s" if longest_s else ""
    return f"{len(held)} of {len(draws)}: {', '.join(counts)}{on}"


def table(results, vendors):
    lines = [f"| | {' | '.join(vendors)} |", "|---" * (len(vendors) + 1) + "|"]
    for mode, attack in dict.fromkeys(key[:2] for key in results):
        cells = [cell(results[mode, attack, one]) for one in vendors]
        lines.append(f"| {mode}: {attack} | {' | '.join(cells)} |")
    return "\n".join(lines)


def write_table(place, text):
    begin, end = "<!-- attack_campaign.py -->\n", "\n<!-- end -->"
    page = place.read_text(encoding="utf-8")
    before, rest = page.split(begin, 1)
    after = rest.split(end, 1)[1]
    place.write_text(before + begin + "\n" + text + "\n" + end + after, encoding="utf-8")


def words(text):
    return text.split(",")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--draws", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--vendors", type=words, default=list(VENDORS))
    parser.add_argument("--attacks", type=words, default=[*ATTACKS, *FLOODS])
    parser.add_argument("--modes", type=words, default=["plain", "secured"])
    parser.add_argument("--at-once", type=int, default=3)
    parser.add_argument("--slack-s", type=float, default=0.3, help="of a busy machine")
    parser.add_argument("--write", type=pathlib.Path, help="the page with the table")
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    undisturbed = undisturbed_result(arguments, PlainLaboratory)
    results = {}
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        for mode in arguments.modes:
            for attack in arguments.attacks:
                for vendors in arguments.vendors:
                    case = (arguments, mode, attack, vendors)
                    results[mode, attack, vendors] = [
                        pool.submit(draw, *case, number, undisturbed)
                        for number in range(arguments.draws)
                    ]
        results = {key: [one.result() for one in draws] for key, draws in results.items()}
    text = table(results, arguments.vendors)
    print(text)
    if arguments.write:
        write_table(arguments.write, text)
    draws = [one for some in results.values() for one in some]
    return 0 if draws and all(draws) else 1


if __name__ == "__main__":
    sys.exit(main())
