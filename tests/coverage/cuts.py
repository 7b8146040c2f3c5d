#!/usr/bin/env python3
"""Cuts good runs: whole steps, or a record's begin or end, from one record or from both, and holds
what `dyncal analyse` gives of the rest against what it gave of the whole.

    cuts.py BUILD/bin/dyncal                          short: 100 cuts (test command)
    cuts.py BUILD/bin/dyncal --draws 1000 --seed 7    long, of other runs
    cuts.py BUILD/bin/dyncal --keep FOLDER            leaves all files there

A result is of the step whose samples it used, by their stamps: never of two steps.

- A step that was cut in no record has the value of the whole run, to 1e-12; to 0.01 u where its
  budget holds a bound of the hum, which is of the whole record.
- Of steps that were cut at most 1 % are farther from it than
  3 sqrt(u_cut^2 - u_whole^2) + 0.1 u_cut (a finding when more are by the binomial bound), and none
  than 5 / 3 of it. The first two u are those of the noise, which samples left out make larger; rows
  that come and go with what a test of significance finds tell nothing of it.
- A step has no value when a record lacks it, and its problem names no sync cable.
- It has the frequency and the level of its step, and its number; another number of the same
  frequency and level only where both records lack a step of these.
- A value is refused only where steps of one frequency and level are left in both records.

The seed is fixed unless --seed gives another. Needs python3-numpy; says so and leaves with status
77 without it.
"""

import argparse
import dataclasses
import json
import math
import multiprocessing
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}; install python3-numpy")
    sys.exit(77)

from bench_simulator import ACS_EPOCH_NS, DAU_EPOCH_NS, Calibration
from class_presets import bench
from faults.missing_steps import LEVELS, missing
from judgement import CHANCE, MISLEADING, too_few

SEED = 2031_11_26
PROCESSES = 2
CUTS_A_RUN = 10
ANALYSE_TIMEOUT_S = 120
EQUAL = 1e-12
EQUAL_WITH_HUM_U = 0.01
MARGIN_S = 0.15  # beside a step, whose frames of the search a cut may touch
BEYOND = 0.01
# Steps of one frequency and level can be told by their phases alone: some draws leave too few.
REFUSED_OF_ALIKE = 0.15

SHORT = {"duration_s": 0.8, "acs_rate_hz": 2000.0}
WHOLE = {"lacks": "first", "records": ()}
KINDS = {
    "six frequencies": bench(SHORT),
    "three repetitions": bench(SHORT, frequencies=("31.5", "80", "125"), repetitions=3),
    "beside the mains": bench(SHORT, frequencies=("40", "50.2", "125"), repetitions=2),
    "ladder of levels": bench(
        SHORT, frequencies=("80",) * 5, fault=missing(**WHOLE, levels=LEVELS)
    ),
    "equal steps": bench(SHORT, frequencies=("80",), repetitions=6),
    "analogue": bench(SHORT, method="analogue", frequencies=("31.5", "80", "125"), repetitions=2),
    "absolute time": bench(
        SHORT, method="absolute-time", frequencies=("31.5", "80", "125"), repetitions=2
    ),
}


@dataclasses.dataclass
class Finding:
    where: str
    what: str


def analysed(program, folder):
    run = subprocess.run(
        [program, "analyse", folder / "bench.toml", "--json", folder / "result.json"],
        capture_output=True,
        text=True,
        timeout=ANALYSE_TIMEOUT_S,
        check=False,
    )
    if run.returncode not in (0, 1) or not (folder / "result.json").exists():
        raise RuntimeError(f"dyncal analyse ended with {run.returncode}: {run.stderr}")
    return json.loads((folder / "result.json").read_text("utf-8"))["points"]


class Run:
    """A good run in a folder, its files, and its results."""

    def __init__(self, program, folder, settings, seed):
        self.calibration = Calibration(settings, seed)
        self.calibration.write(folder)
        self.steps = self.calibration.steps
        self.end_s = self.calibration.end_s
        utc = settings.method == "absolute-time"
        self.epochs_ns = {"acs": DAU_EPOCH_NS if utc else ACS_EPOCH_NS}
        if settings.method != "analogue":
            self.epochs_ns["dau"] = DAU_EPOCH_NS
        self.rows = {name: np.load(folder / f"{name}.npy") for name in self.epochs_ns}
        self.folder = folder
        self.program = program
        self.whole = {self.step_of(point): point for point in analysed(program, folder)}

    def step_of(self, point):
        """The place of the step that all its samples are of; nothing where it has none, a text
        where they are of several."""
        places = set()
        for samples in point.get("source_samples", []):
            if samples["source"] not in self.epochs_ns:
                continue
            middle_ns = (samples["first_stamp_ns"] + samples["last_stamp_ns"]) / 2
            middle_s = (middle_ns - self.epochs_ns[samples["source"]]) * 1e-9
            inside = [i for i, s in enumerate(self.steps) if s.begin_s < middle_s < s.end_s]
            places.add(inside[0] if inside else "no step")
        return places.pop() if len(places) == 1 else f"steps {sorted(map(str, places))}"

    def times_s(self, name):
        return (self.rows[name]["t_ns"] - self.epochs_ns[name]) * 1e-9


def draw_cut(run, rng):
    """By record, the intervals of true time that are cut from it."""
    names = list(run.epochs_ns)
    chosen = [names, names[:1], names[-1:]][rng.integers(3)]
    alike = rng.random() < 0.5
    cuts = {}
    for name in chosen:
        if cuts and alike:
            cuts[name] = next(iter(cuts.values()))
            continue
        kind = rng.integers(3)
        if kind == 0:
            cuts[name] = [(-math.inf, rng.uniform(0.0, 0.7) * run.end_s)]
        elif kind == 1:
            cuts[name] = [(rng.uniform(0.3, 1.0) * run.end_s, math.inf)]
        else:
            places = rng.choice(len(run.steps), size=rng.integers(1, 3), replace=False)
            quiet_s = 0.4 * run.calibration.settings.pause_s
            cuts[name] = [
                (run.steps[i].begin_s - quiet_s, run.steps[i].end_s + quiet_s) for i in places
            ]
    return cuts


def left_of(step, intervals):
    """Of a step in a record: "whole", "cut" or "gone"."""
    if any(begin <= step.begin_s and step.end_s <= end for begin, end in intervals):
        return "gone"
    touched = any(
        begin < step.end_s + MARGIN_S and step.begin_s - MARGIN_S < end for begin, end in intervals
    )
    return "cut" if touched else "whole"


def noise2_of(point, quantity):
    """Relative variance, or in rad^2."""
    column = "u_magnitude_rel" if quantity == "magnitude" else "u_phase_rad"
    return sum(row[column] ** 2 for row in point["budget"] if row["kind"] == "noise of")


class Judgement:
    def __init__(self, run, cuts, points):
        self.run = run
        self.points = points
        self.left = [
            [left_of(step, cuts.get(name, [])) for name in run.epochs_ns] for step in run.steps
        ]
        self.findings = []
        self.of_cut_steps = []  # deviation over what is allowed at 3
        self.refused = 0  # steps that are whole, where others are like them

    def like(self, step):
        """Places of the steps with its frequency and level."""
        return [
            i
            for i, other in enumerate(self.run.steps)
            if (other.frequency_text, other.amplitude) == (step.frequency_text, step.amplitude)
        ]

    def same_frequency(self, step):
        return [
            i
            for i, other in enumerate(self.run.steps)
            if other.frequency_text == step.frequency_text
        ]

    def judge(self):
        seen = set()
        for point in self.points:
            if not point["valid"]:
                if MISLEADING in point["problem"] or not point["problem"]:
                    self.findings.append(f"step {point['step']}: {point['problem']!r}")
                continue
            place = self.run.step_of(point)
            if not isinstance(place, int):
                self.findings.append(f"step {point['step']} was made of {place}")
                continue
            seen.add(place)
            self.judge_label(point, place)
            self.judge_value(point, place)
        for place, left in enumerate(self.left):
            if place not in seen and set(left) == {"whole"}:
                if len(self.same_frequency(self.run.steps[place])) == 1:
                    self.findings.append(f"step {place + 1} is whole, and has no value")
                else:
                    self.refused += 1

    def judge_label(self, point, place):
        step = self.run.steps[place]
        level = self.run.whole[place]["level_m_s2"]
        if point["frequency_text_hz"] != step.frequency_text or point["level_m_s2"] != level:
            self.findings.append(
                f"step {place + 1} is given as {point['frequency_text_hz']} Hz, "
                f"{point['level_m_s2']} m/s^2"
            )
        elif point["step"] != place + 1:
            lacking = [i for i in self.like(step) if "whole" not in self.left[i]]
            if not lacking:
                self.findings.append(f"step {place + 1} is given as step {point['step']}")

    def judge_value(self, point, place):
        whole = self.run.whole[place]
        untouched = set(self.left[place]) == {"whole"}
        hum = any("hum" in row["kind"] for row in point["budget"] + whole["budget"])
        for quantity in ("magnitude", "phase_rad"):
            change = abs(point[quantity] - whole[quantity])
            u_cut, u_whole = point[f"u_{quantity}"], whole[f"u_{quantity}"]
            scale = whole["magnitude"] if quantity == "magnitude" else 1.0
            if untouched:
                allowed = EQUAL_WITH_HUM_U * u_whole if hum else EQUAL
                if change > allowed:
                    self.findings.append(
                        f"step {place + 1} is whole, and its {quantity} moved by {change:.3g} "
                        f"({change / u_whole:.3g} u)"
                    )
                continue
            more = noise2_of(point, quantity) - noise2_of(whole, quantity)
            allowed = 3.0 * scale * math.sqrt(max(0.0, more)) + 0.1 * u_cut
            self.of_cut_steps.append(change / allowed)
            if change > 5.0 / 3.0 * allowed:
                self.findings.append(
                    f"step {place + 1} is cut, and its {quantity} moved by {change:.3g} "
                    f"({change / allowed:.3g} of what is allowed)"
                )


def judged(work):
    """All cuts of one run."""
    program, top, keep, kind, seed, first, draws = work
    folder = pathlib.Path(top) / f"run-{first:04}"
    folder.mkdir(parents=True)
    rng = np.random.default_rng([seed, first, 1])
    run = Run(program, folder, KINDS[kind], [seed, first])
    judgements = []
    for draw in range(first, first + draws):
        cuts = draw_cut(run, rng)
        for name, rows in run.rows.items():
            times_s = run.times_s(name)
            kept = np.ones(rows.size, bool)
            for begin_s, end_s in cuts.get(name, []):
                kept &= (times_s < begin_s) | (times_s > end_s)
            np.save(folder / f"{name}.npy", rows[kept])
        judgement = Judgement(run, cuts, analysed(program, folder))
        judgement.judge()
        text = f"cut {draw} ({kind}; {cuts})"
        judgements.append(
            (
                kind,
                [Finding(text, one) for one in judgement.findings],
                judgement.of_cut_steps,
                judgement.refused,
                sum(set(left) == {"whole"} for left in judgement.left),
            )
        )
        if keep:
            shutil.copytree(folder, pathlib.Path(top) / f"cut-{draw:04}")
    shutil.rmtree(folder)
    return judgements


def all_judged(options, top):
    kinds = list(KINDS)
    work = [
        (
            os.path.abspath(options.program),
            top,
            bool(options.keep),
            kinds[first // CUTS_A_RUN % len(kinds)],
            options.seed,
            first,
            min(CUTS_A_RUN, options.draws - first),
        )
        for first in range(0, options.draws, CUTS_A_RUN)
    ]
    with multiprocessing.Pool(PROCESSES) as pool:
        return [one for judgements in pool.imap(judged, work) for one in judgements]


def report(judgements):
    """Prints a line a kind; returns what is wrong."""
    wrong = [f"{one.where}: {one.what}" for _, found, *_ in judgements for one in found]
    for kind in KINDS:
        of_kind = [one for one in judgements if one[0] == kind]
        whole = sum(one[4] for one in of_kind)
        of_cut = [ratio for one in of_kind for ratio in one[2]]
        refused = sum(one[3] for one in of_kind)
        print(
            f"{kind:20} {len(of_kind):4} cuts, {whole:5} steps left whole, {refused:3} of them "
            f"refused, {len(of_cut):4} values of cut steps, largest "
            f"{max(of_cut, default=0.0):.2f} of what is allowed"
        )
        if of_kind and not whole:
            wrong.append(f"{kind}: no step was left whole, nothing was judged")
        if refused > REFUSED_OF_ALIKE * whole:
            wrong.append(f"{kind}: {refused} of {whole} steps that are whole have no value")
    of_cut = [ratio for one in judgements for ratio in one[2]]
    beyond = sum(ratio > 1.0 for ratio in of_cut)
    if too_few(len(of_cut) - beyond, len(of_cut), 1.0 - BEYOND, CHANCE):
        wrong.append(f"{beyond} of {len(of_cut)} values of cut steps moved by more than is allowed")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="dyncal of the build that is judged")
    parser.add_argument("--draws", type=int, default=100, help="cuts")
    parser.add_argument("--seed", type=int, default=SEED, help="other runs than usual")
    parser.add_argument("--keep", help="a new folder for all files; else they are removed")
    options = parser.parse_args()
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="dyncal-cuts-") as temporary:
        judgements = all_judged(options, options.keep or temporary)
    print(f"{options.draws} cuts, seed {options.seed}, {time.monotonic() - begin:.0f} s")
    wrong = report(judgements)
    for one in wrong:
        print(f"WRONG: {one}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
