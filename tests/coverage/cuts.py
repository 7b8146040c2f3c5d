#!/usr/bin/env python3
"""Cuts good runs: whole steps, a repetition, a block in the middle, or a record's begin or end,
from one record or from both, and holds what `dyncal analyse` gives of the rest against what it gave
of the whole. (Recordings, whose announced steps give the truth: recorded_cuts_test.cpp.)

    cuts.py BUILD/bin/dyncal                          short: 100 cuts (test command)
    cuts.py BUILD/bin/dyncal --draws 1000 --seed 7    long, of other runs
    cuts.py BUILD/bin/dyncal --keep FOLDER            leaves all files there

The long form takes 0.1 s of processor time a cut, two minutes for 1000, on as many processors as
there are; a machine that is so busy that one evaluation takes two minutes ends it.

A result is of the step whose samples it used, by their stamps: never of two steps.

- A step that was cut in no record has the value of the whole run, to 1e-12; to 0.01 u where its
  budget holds a bound of the hum, which is of the whole record.
- Of steps that were cut at most 1 % are farther from it than
  3 sqrt(u_cut^2 - u_whole^2) + 0.1 u_cut (a finding when more are by the binomial bound), and none
  than 5 sqrt(u_cut^2 - u_whole^2) + 0.1 u_cut. All u are those that are stated.
- Rows of noise. The wording above holds where nothing but noise is in u, and the samples of the cut
  step are some of those of the whole one. A row that estimates something else may become smaller,
  and settling is counted from the begin of the record that is left, so that n samples go and n
  others come: then u_cut = u_whole, and the wording would allow 0.1 u for a difference of two means
  of noise that is not the same. Its variance is the sum over the rows of noise, where it is above
  0, of u_cut^2 + u_whole^2 - 2 u_whole^2 n_both / n_cut; no other row may move. This takes the
  place of the square root where it is larger; how many values are judged so is printed.
- A step has no value when a record lacks it, and its problem names no sync cable.
- It has the frequency and the level of its step. It has its number, or the flag
  `step_number_uncertain`; this only where every record in which steps are searched lacks a step of
  its frequency and level: then equal steps are left of which nothing tells which they are, and what
  is certain is the value at a frequency and a level.
- A value is refused only where steps of one frequency and level are left in both records: the
  offset between the clocks is free, so that any of one record could be any of the other. Then a
  value would be a guess, and the refusal has a need; in one record alone there is none.

The seed is fixed unless --seed gives another. Needs python3-numpy; says so and leaves with status
77 without it.
"""

import argparse
import dataclasses
import math
import multiprocessing
import os
import pathlib
import shutil
import sys
import tempfile
import time

from analysed_folder import PROCESSES, analysed  # first: leaves where there is no numpy

import numpy as np

from bench_simulator import ACS_EPOCH_NS, DAU_EPOCH_NS, Calibration
from class_presets import bench
from faults.missing_steps import LEVELS, missing
from judgement import CHANCE, MISLEADING, too_few

SEED = 2031_11_26
CUTS_A_RUN = 10
EQUAL = 1e-12
EQUAL_WITH_HUM_U = 0.01
MARGIN_S = 0.15  # beside a step, whose frames of the search a cut may touch
BEYOND = 0.01
OPPOSITE_ENDS = 0.15  # of the cuts of two records
BLOCK_S = (0.02, 1.0)  # length of a block that is cut from anywhere
UNCERTAIN = "step_number_uncertain"
# Steps of one frequency and level can be told by their phases alone: some draws leave too few. One
# such cut refuses all steps that it leaves, so that a kind with ten cuts alone shows no share.
REFUSED_OF_ALIKE = 0.05

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
    "numbered samples": bench(
        SHORT, frequencies=("31.5", "80", "125"), repetitions=2, records_sample_numbers=True
    ),
    "analogue": bench(SHORT, method="analogue", frequencies=("31.5", "80", "125"), repetitions=2),
    "absolute time": bench(
        SHORT, method="absolute-time", frequencies=("31.5", "80", "125"), repetitions=2
    ),
}


@dataclasses.dataclass
class Finding:
    where: str
    what: str


def points_of(program, folder):
    result, complaint = analysed(program, folder)
    if not result:
        raise RuntimeError(f"dyncal analyse has no result: {complaint}")
    return result["points"]


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
        self.whole = {self.step_of(point): point for point in points_of(program, folder)}

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


def draw_steps(run, rng, repetition):
    """The first and last of each row of steps that are cut: of a repetition, or one or two."""
    if repetition:
        length = len(run.steps) // run.calibration.settings.repetitions
        first = length * rng.integers(run.calibration.settings.repetitions)
        if length < len(run.steps):
            return [(first, first + length - 1)]
    places = rng.choice(len(run.steps), size=rng.integers(1, 3), replace=False)
    return [(place, place) for place in places]


def draw_opposite_ends(run, rng, names):
    """Of one step one record lacks the begin and what comes before, the other one the end alone; or
    the other way round: neither end is in both."""
    step = run.steps[rng.integers(len(run.steps))]
    length_s = step.end_s - step.begin_s
    early_s = step.begin_s + rng.uniform(0.1, 0.7) * length_s
    late_s = step.begin_s + rng.uniform(0.3, 0.9) * length_s
    outer, inner = rng.permutation(names)
    if rng.random() < 0.5:
        return {
            str(outer): [(late_s, math.inf)],
            str(inner): [(step.begin_s - rng.uniform(0.0, 0.4), early_s)],
        }
    return {
        str(outer): [(-math.inf, early_s)],
        str(inner): [(late_s, step.end_s + rng.uniform(0.0, 0.4))],
    }


def draw_cut(run, rng):
    """By record, the intervals of true time that are cut from it."""
    names = list(run.epochs_ns)
    if len(names) == 2 and rng.random() < OPPOSITE_ENDS:
        return draw_opposite_ends(run, rng, names)
    chosen = [names, names[:1], names[-1:]][rng.integers(3)]
    alike = rng.random() < 0.5
    cuts = {}
    for name in chosen:
        if cuts and alike:
            cuts[name] = next(iter(cuts.values()))
            continue
        kind = rng.integers(5)
        if kind == 0:
            cuts[name] = [(-math.inf, rng.uniform(0.0, 0.7) * run.end_s)]
        elif kind == 1:
            cuts[name] = [(rng.uniform(0.3, 1.0) * run.end_s, math.inf)]
        elif kind == 2:
            middle_s = rng.uniform(0.0, run.end_s)
            half_s = 0.5 * rng.uniform(*BLOCK_S)
            cuts[name] = [(middle_s - half_s, middle_s + half_s)]
        else:
            quiet_s = 0.4 * run.calibration.settings.pause_s
            cuts[name] = [
                (run.steps[first].begin_s - quiet_s, run.steps[last].end_s + quiet_s)
                for first, last in draw_steps(run, rng, kind == 3)
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


SOURCES_OF_NOISE = {  # whose rows have which subject
    "dau": ("the sensor", "the DAU sync"),
    "acs": ("the reference", "the ACS sync"),
}


def span_ns(point, source):
    of_source = [s for s in point["source_samples"] if s["source"] == source]
    return of_source[0]["first_stamp_ns"], of_source[0]["last_stamp_ns"], of_source[0]["used"]


def variance_of_change(point, whole, quantity, sources):
    """Of the noise that fewer samples, or others in their place, make of a value: relative, or in
    rad^2.
    With u^2 = s^2 / n: u_cut^2 + u_whole^2 - 2 u_whole^2 n_both / n_cut; where s, which is an
    estimate too, came out larger of the whole step, by that of the cut one."""
    column = "u_magnitude_rel" if quantity == "magnitude" else "u_phase_rad"
    noise2 = [
        {row["subject"]: row[column] ** 2 for row in one["budget"] if row["kind"] == "fit_noise"}
        for one in (point, whole)
    ]
    variance = 0.0
    for subject, cut2 in noise2[0].items():
        usual = [name for name, subjects in SOURCES_OF_NOISE.items() if subject in subjects]
        source = usual[0] if usual and usual[0] in sources else "acs"
        begin, end, used = span_ns(point, source)
        whole_begin, whole_end, whole_used = span_ns(whole, source)
        both = max(0, min(end, whole_end) - max(begin, whole_begin)) / (end - begin)
        whole2 = min(noise2[1].get(subject, cut2), cut2 * used / whole_used)
        variance += max(0.0, cut2 + whole2 - 2.0 * whole2 * both)
    return variance


class Judgement:
    def __init__(self, run, cuts, points):
        self.run = run
        self.points = points
        self.left = [
            [left_of(step, cuts.get(name, [])) for name in run.epochs_ns] for step in run.steps
        ]
        # Steps are searched in the sync of both records, or in the reference alone: "acs" is first.
        self.searched = 2 if run.calibration.settings.method == "sample-timestamping" else 1
        self.findings = []
        self.of_cut_steps = []  # deviation over what is allowed at 3
        self.by_noise = 0  # of these values, by the rows of noise
        self.uncertain = 0  # numbers that are said to be so
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
        said = UNCERTAIN in point["flag_names"]
        self.uncertain += said
        lacking = [i for i in self.like(step) if "whole" not in self.left[i][: self.searched]]
        if point["step"] != place + 1 and not said:
            self.findings.append(f"step {place + 1} is given as step {point['step']}, unsaid")
        if said and not lacking:
            self.findings.append(f"the number of step {place + 1} is uncertain, without need")

    def judge_value(self, point, place):
        whole = self.run.whole[place]
        untouched = set(self.left[place]) == {"whole"}
        hum = any("hum" in row["kind"] for row in point["budget"] + whole["budget"])
        for quantity in ("magnitude", "phase_rad"):
            change = abs(point[quantity] - whole[quantity])
            u_cut, u_whole = point[f"u_{quantity}"], whole[f"u_{quantity}"]
            if untouched:
                allowed = EQUAL_WITH_HUM_U * u_whole if hum else EQUAL
                if change > allowed:
                    self.findings.append(
                        f"step {place + 1} is whole, and its {quantity} moved by {change:.3g} "
                        f"({change / u_whole:.3g} u)"
                    )
                continue
            scale = whole["magnitude"] if quantity == "magnitude" else 1.0
            more2 = max(0.0, u_cut**2 - u_whole**2)
            noise = variance_of_change(point, whole, quantity, self.run.epochs_ns)
            self.by_noise += scale**2 * noise > more2
            more2 = max(more2, scale**2 * noise)
            more = math.sqrt(more2)
            self.of_cut_steps.append(change / (3.0 * more + 0.1 * u_cut))
            if change > 5.0 * more + 0.1 * u_cut:
                self.findings.append(
                    f"step {place + 1} is cut, and its {quantity} moved by {change:.3g} "
                    f"({change / u_cut:.3g} u; u was {u_whole:.4g}, is {u_cut:.4g})"
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
        judgement = Judgement(run, cuts, points_of(program, folder))
        judgement.judge()
        text = f"cut {draw} ({kind}; {cuts})"
        judgements.append(
            (
                kind,
                [Finding(text, one) for one in judgement.findings],
                judgement.of_cut_steps,
                judgement.refused,
                judgement.by_noise,
                judgement.uncertain,
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
        whole = sum(one[6] for one in of_kind)
        of_cut = [ratio for one in of_kind for ratio in one[2]]
        refused = sum(one[3] for one in of_kind)
        print(
            f"{kind:20} {len(of_kind):4} cuts, {whole:5} steps left whole, {refused:3} of them "
            f"refused, {sum(one[5] for one in of_kind):3} numbers uncertain, {len(of_cut):4} "
            f"values of cut steps ({sum(one[4] for one in of_kind)} by the rows of noise), largest "
            f"{max(of_cut, default=0.0):.2f} of what is allowed"
        )
        if of_kind and not whole:
            wrong.append(f"{kind}: no step was left whole, nothing was judged")
    refused, whole = (sum(one[column] for one in judgements) for column in (3, 6))
    if refused > REFUSED_OF_ALIKE * whole:
        wrong.append(f"{refused} of {whole} steps that are whole have no value")
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
