#!/usr/bin/env python3
"""Programs of other stacks, made from idl/dyncal.idl alone, against dyncal's: each reads the
results of a run, while it runs and afterwards, and publishes a source that dyncal records.

    run_stacks.py PROGRAMS FOLDER [--stacks NAME,...] [--loss PERCENT,...] [--quick] [--write PAGE]

PROGRAMS: dyncal's; FOLDER: what is made for a stack is kept there. --loss: of the packets, each in
turn (default 0,3). --quick: the stacks whose packages are on every machine that builds dyncal.
--write: the table into PAGE, between the lines <!-- foreign stacks --> and <!-- end -->.

Verdicts: PASS; EXPECTED_NEGATIVE (it cannot, as stacks.py says, and indeed does not); PRODUCT_FAIL
(a wrong value, a lost sample, or an end that nobody expects); TIMEOUT (something never came);
SETUP_FAIL (it was not tried). Leaves with 1 if any is PRODUCT_FAIL or TIMEOUT, with 77 and a line
if nothing can be tried.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import time

import verdicts
from laboratory import DOMAIN, CannotBeSetUp, Laboratory
from stacks import SETTINGS, STACKS

READING_S, WRITING_S, WRITTEN_S = 60, 60, 6
FAILURES = ("PRODUCT_FAIL", "TIMEOUT")


class Trial:
    """All stacks over one link."""

    def __init__(self, options, made, loss):
        self.options, self.made, self.loss = options, made, loss
        self.verdicts = {}  # by stack and action

    def say(self, stack, action, verdict, why):
        expected = stack.cannot.get(action.split()[0])
        if expected and verdict == "PASS":
            verdict, why = "PRODUCT_FAIL", f"it can, other than stacks.py says: {expected}"
        elif expected:
            verdict, why = "EXPECTED_NEGATIVE", expected
        self.verdicts[stack.name, action] = verdict
        print(f"{stack.name}, {self.loss} % lost, {action}: {verdict}: {why}", flush=True)

    def start(self, lab, stack, action, bench, *counts):
        command = self.made[stack.name]
        partition = bench if stack.partitions else ""
        words = [*command, action, DOMAIN, partition, bench, *counts]
        name = f"{stack.name}-{action}-{time.monotonic_ns()}"
        return lab.start(name, lab.other, words, environment=SETTINGS)

    def wait(self, lab, process, patience_s):
        """Whether it has ended by itself, and well."""
        try:
            process.wait(patience_s)
        except subprocess.TimeoutExpired:
            lab.end(process)
            return True  # what is missing is judged
        return process.returncode == 0

    def judge_reader(self, lab, stack, action, process, result, patience_s):
        ended = self.wait(lab, process, patience_s)
        verdict, why = verdicts.judge_reading(process.log, result)
        if not ended and verdict != "PASS":
            last = pathlib.Path(f"{process.log}.err").read_text(errors="replace").strip()
            verdict, why = "PRODUCT_FAIL", f"ended with {process.returncode}: {last[-200:]}"
        self.say(stack, action, verdict, why)

    def read(self, lab):
        live = {
            stack.name: self.start(lab, stack, "read", "interop", 3, 1)
            for stack in self.stacks()
            if not self.options.quick
        }
        result = lab.run()
        for stack in self.stacks():
            if stack.name in live:
                process = live[stack.name]
                self.judge_reader(lab, stack, "read live", process, result, READING_S / 4)
        for stack in self.stacks():
            process = self.start(lab, stack, "read", "interop", 3, 1)
            self.judge_reader(lab, stack, "read late", process, result, READING_S)

    def write(self, lab):
        recordings = lab.folder / "recordings"
        words = ["--folder", recordings, "--domain", DOMAIN, "--interface", "lab"]
        recorder = lab.start(
            *("recorder", lab.own, [self.options.programs / "dyncal-recorder", *words]),
            ready="recorder ready",
        )
        listing = ["list", "--domain", DOMAIN, "--interface", "lab"]
        writers, listed = {}, ""
        for stack in self.stacks():
            writers[stack.name] = self.start(lab, stack, "write", stack.name, WRITTEN_S)
            if not self.options.quick:
                listed += lab.dyncal(*listing)[1]
                self.wait(lab, writers[stack.name], WRITING_S)
        while self.options.quick and any(one.poll() is None for one in writers.values()):
            listed += lab.dyncal(*listing)[1]
        for process in writers.values():
            self.wait(lab, process, WRITING_S)
        lab.end(recorder)
        for stack in self.stacks():
            found = sorted((recordings / stack.name).glob("*.mcap"))
            if not found:
                self.say(stack, "write", "TIMEOUT", "the recorder has nothing of it")
                continue
            dyncal = self.options.programs / "dyncal"
            verdict, why = verdicts.judge_writing(found[0], dyncal, WRITTEN_S)
            if verdict == "PASS" and stack.name not in listed:
                verdict, why = "PRODUCT_FAIL", f"dyncal list does not have it: {listed[-300:]}"
            self.say(stack, "write", verdict, why)

    def stacks(self):
        return [stack for stack in STACKS if stack.name in self.made]

    def run(self):
        folder = self.options.folder / f"with-{self.loss}-percent-loss"
        shutil.rmtree(folder, ignore_errors=True)
        with Laboratory(self.options.programs, folder, self.loss) as lab:
            lab.serve()
            self.read(lab)
            self.write(lab)
            lost = lab.lost_packets()
        print(f"{lost} packets to the stacks were lost on the way", flush=True)
        if self.loss and not lost:
            raise CannotBeSetUp("the link lost nothing")


def table_of(tried, versions, reasons, trials):
    columns = [f"{what}, {trial.loss} % lost" for what in ("reads", "writes") for trial in trials]
    lines = [f"| stack | version | {' | '.join(columns)} |", f"|{'---|' * (2 + len(columns))}"]
    for stack in tried:
        if stack.name not in versions:
            cells = ["SETUP_FAIL"] * len(columns)
            lines.append(f"| {stack.label} | - | {' | '.join(cells)} |")
            continue
        cells = []
        for action in ("read", "write"):
            for trial in trials:
                said = {
                    verdict
                    for (name, what), verdict in trial.verdicts.items()
                    if name == stack.name and what.startswith(action)
                }
                cells.append(", ".join(sorted(said)) or "SETUP_FAIL")
        lines.append(f"| {stack.label} | {versions[stack.name]} | {' | '.join(cells)} |")
    untried = [
        f"- {stack.label}: {reasons[stack.name]}" for stack in tried if stack.name in reasons
    ]
    return "\n".join([*lines, "", *untried] if untried else lines) + "\n"


def write_table(page, table):
    begin, end = "<!-- foreign stacks -->\n", "<!-- end -->\n"
    before, rest = page.read_text().split(begin)
    page.write_text(f"{before}{begin}{table}{end}{rest.split(end, 1)[1]}")


def options_of_command():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("folder", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--stacks", type=lambda text: text.split(","))
    parser.add_argument("--loss", default="0,3")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--write", type=pathlib.Path)
    return parser.parse_args()


def main():
    options = options_of_command()
    tried = [
        stack
        for stack in STACKS
        if (stack.name in options.stacks if options.stacks else options.quick in stack.forms)
    ]
    made, versions, reasons = {}, {}, {}
    for stack in tried:
        folder = options.folder / stack.name
        folder.mkdir(parents=True, exist_ok=True)
        try:
            made[stack.name], versions[stack.name] = stack.make(folder)
        except CannotBeSetUp as error:
            reasons[stack.name] = str(error)
            print(f"{stack.name}: SETUP_FAIL: {error}", flush=True)
    trials = [Trial(options, made, int(loss)) for loss in options.loss.split(",")]
    try:
        for trial in trials:
            if made:
                trial.run()
    except CannotBeSetUp as error:
        print(f"SKIPPED: other stacks are not tried: {error}")
        return 77
    if not made:
        print("SKIPPED: no stack can be set up")
        return 77
    table = table_of(tried, versions, reasons, trials)
    print(table)
    if options.write:
        write_table(options.write, table)
    said = [verdict for trial in trials for verdict in trial.verdicts.values()]
    print({verdict: said.count(verdict) for verdict in sorted(set(said))})
    return int(any(verdict in FAILURES for verdict in said))


if __name__ == "__main__":
    sys.exit(main())
