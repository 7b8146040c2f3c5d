"""Records that do not show the same steps: one begins late, ends early, or has no samples while a
step or two were excited. Joined by their order alone, every later step would be joined with
another."""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, bench
from expected_row import VALUE, Row
from faults.fault import Fault
from judgement import COVERED_OR_FLAGGED

MARGIN_S = 0.2  # of quiet time that goes with a step


class MissingSteps(Fault):
    """`records`: those that lack steps; which ones is drawn for each. `levels`: one for each
    frequency of the plan."""

    def __init__(self, calibration, rng, records=("dau",), lacks="first", count=1, levels=()):
        super().__init__(calibration, rng)
        self.records = records
        self.levels = levels
        for place, step in enumerate(self.steps):
            if levels:
                step.amplitude = levels[place % len(levels)]
        steps = len(self.steps)
        first = {
            "first": 0,
            "last": steps - count,
            "any": int(rng.integers(1, steps - count)),
        }[lacks]
        self.missing_s = (
            self.steps[first].begin_s - MARGIN_S if first else -np.inf,
            self.steps[first + count - 1].end_s + MARGIN_S if first + count < steps else np.inf,
        )

    def _without(self, record, times_s, columns):
        if record not in self.records:
            return columns
        kept = (times_s < self.missing_s[0]) | (times_s > self.missing_s[1])
        return {name: values[kept] for name, values in columns.items()}

    def acs_record(self, times_s, columns):
        return self._without("acs", times_s, columns)

    def dau_record(self, times_s, columns):
        return self._without("dau", times_s, columns)

    def bench_tables(self, tables):
        if self.levels:
            tables["excitation"]["level"] = list(self.levels)
        return tables


def missing(**settings):
    return functools.partial(MissingSteps, **settings)


SHORT = {**LITTLE_NOISE, "duration_s": 0.8, "acs_rate_hz": 2000.0}
LADDER = {**SHORT, "frequencies": ("80",) * 5}
LEVELS = (2.0, 5.0, 10.0, 15.0, 20.0)
CLOSE_LEVELS = (10.0, 10.3, 10.6, 10.9, 11.2)
REPEATED = {**SHORT, "frequencies": ("31.5", "80", "125"), "repetitions": 3}

CLASSES = {
    "the DAU lacks the first of a ladder of levels": bench(
        LADDER, fault=missing(levels=LEVELS)
    ),
    "the ACS lacks one of levels 3 % apart": bench(
        LADDER, fault=missing(records=("acs",), lacks="any", levels=CLOSE_LEVELS)
    ),
    "both lack two of a ladder of levels": bench(
        LADDER, fault=missing(records=("acs", "dau"), count=2, levels=LEVELS)
    ),
    "the DAU lacks one of five equal steps": bench(
        SHORT, frequencies=("80",), repetitions=5, fault=missing(lacks="any")
    ),
    "the DAU lacks one step of three repetitions": bench(REPEATED, fault=missing(lacks="any")),
    "the ACS lacks the first repetition": bench(
        REPEATED, fault=missing(records=("acs",), count=3)
    ),
}
EXPECTED = [Row(name, VALUE, COVERED_OR_FLAGGED) for name in CLASSES]
