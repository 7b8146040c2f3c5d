"""Triggered series whose shots are no repetitions of one measurement, whose start is neither fixed
nor free, or whose trace of sync is not what the trigger saw."""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, SERIES, bench
from expected_row import MAGNITUDE, PHASE, VALUE, Row
from faults.fault import Fault
from judgement import (
    COVERED,
    COVERED_AND_NARROW,
    COVERED_NO_FLAG,
    COVERED_OR_FLAGGED,
    COVERED_WITH_BOUND,
    FLAGGED,
)


class DriftingClock(Fault):
    """The sensor's rate changes by so much over every series."""

    def __init__(self, calibration, rng, change_rel):
        super().__init__(calibration, rng)
        self.change_rel = change_rel

    def series_instants(self, step, times_s):
        since_s = times_s - times_s[0]
        return times_s + 0.5 * self.change_rel * since_s**2 / since_s[-1]


class RateOfShot(Fault):
    """Every series has a rate of its own."""

    def __init__(self, calibration, rng, scatter_rel):
        super().__init__(calibration, rng)
        self.scatter_rel = scatter_rel

    def series_instants(self, step, times_s):
        change_rel = self.scatter_rel * self.rng.standard_normal()
        return times_s + change_rel * (times_s - times_s[0])


class JitteringClock(Fault):
    """Every interval is off by its own part, so that the instants walk at random."""

    def __init__(self, calibration, rng, jitter_rel):
        super().__init__(calibration, rng)
        self.jitter_rel = jitter_rel

    def series_instants(self, step, times_s):
        jitter_s = self.jitter_rel / self.calibration.sensor_rate_hz
        walk_s = np.cumsum(jitter_s * self.rng.standard_normal(times_s.size - 1))
        return times_s + np.concatenate([[0.0], walk_s])


class LostSample(Fault):
    """One sample is missing somewhere in a series, in so many of them."""

    def __init__(self, calibration, rng, part):
        super().__init__(calibration, rng)
        self.part = part

    def series_instants(self, step, times_s):
        if self.rng.uniform() >= self.part:
            return times_s
        late = np.arange(times_s.size) >= self.rng.integers(times_s.size // 10, times_s.size)
        return times_s + late / self.calibration.sensor_rate_hz


class LateStart(Fault):
    """The series begins late: by part of a sample, drawn uniformly; or by an exponential time."""

    def __init__(self, calibration, rng, part_of_sample=0.0, mean_s=0.0):
        super().__init__(calibration, rng)
        self.width_s = part_of_sample / calibration.sensor_rate_hz
        self.mean_s = mean_s

    def series_instants(self, step, times_s):
        return times_s + self.rng.uniform(0.0, self.width_s) + self.rng.exponential(self.mean_s)


class TriggerOnGrid(Fault):
    """The oscilloscope takes its trigger for the sample before it, `coarse` times as far away."""

    def __init__(self, calibration, rng, coarse):
        super().__init__(calibration, rng)
        self.coarse = coarse

    def trace(self, volts, turn):
        late = self.coarse * self.rng.uniform() * (turn[1] - turn[0])
        return 5.0 * np.sin(turn - late)


class ClippedTrace(Fault):
    """On one side."""

    def __init__(self, calibration, rng, limit_rel):
        super().__init__(calibration, rng)
        self.limit_v = 5.0 * limit_rel

    def trace(self, volts, turn):
        return np.minimum(volts, self.limit_v)


class DistortedSync(Fault):
    """By its second and third harmonic, at the oscilloscope and at the ACS."""

    def __init__(self, calibration, rng, part):
        super().__init__(calibration, rng)
        self.part = part
        self.turn_rad = rng.uniform(0.0, 2.0 * np.pi, 2)

    def harmonics(self, turn):
        return self.part * (
            np.sin(2.0 * turn + self.turn_rad[0]) + 0.5 * np.sin(3.0 * turn + self.turn_rad[1])
        )

    def trace(self, volts, turn):
        return volts + 5.0 * self.harmonics(turn)

    def sync(self, times_s, values, volts):
        distorted = values.copy()
        for step in self.steps:
            inside = (times_s >= step.begin_s) & (times_s < step.end_s)
            turn = 2.0 * np.pi * step.frequency_hz * (times_s[inside] - step.begin_s)
            distorted[inside] += volts * self.harmonics(turn + step.sync_phase_rad)
        return distorted


FEW_STEPS = {**SERIES, "frequencies": ("20", "80", "210"), "shots": 8}
SHORT_TRACES = {"trace_periods": 0.7}


def series(fault, *parts, **arguments):
    return bench(FEW_STEPS, LITTLE_NOISE, *parts, fault=functools.partial(fault, **arguments))


class DriftingSeries(Fault):
    """The offset drifts in every series, by another part of the amplitude in each."""

    def __init__(self, calibration, rng, drift_rel):
        super().__init__(calibration, rng)
        self.drift_rel = drift_rel

    def series(self, step, times_s, values):
        size = self.drift_rel * step.amplitude * self.rng.standard_normal()
        return values + size * np.linspace(-0.5, 0.5, values.size)


TWO_PERIODS = {
    **SERIES,
    "frequencies": ("4.1", "4.2", "4.3", "4.4"),
    "duration_s": 1.0,
    "sensor_noise_rel": 1e-3,
    "reference_noise_rel": 1e-4,
}

ONE_FREQUENCY = "clean, series of one frequency"
CLASSES = {
    **{
        f"series of two periods drift by {100 * drift_rel:g} %": bench(
            TWO_PERIODS, fault=functools.partial(DriftingSeries, drift_rel=drift_rel)
        )
        for drift_rel in (0.002, 0.02, 0.2)
    },
    "series of two periods": bench(TWO_PERIODS),
    # Nothing is wrong.
    "clean, series of 5 shots": bench(SERIES, shots=5, frequencies=("20", "80", "210")),
    "clean, series with little noise": bench(FEW_STEPS, LITTLE_NOISE),
    ONE_FREQUENCY: bench(SERIES, frequencies=("80",)),
    "clean, series, traces of 0.7 periods": bench(FEW_STEPS, LITTLE_NOISE, SHORT_TRACES),
    "free-running series with little noise": bench(
        SERIES, LITTLE_NOISE, start="free-running", frequencies=("20", "80", "210")
    ),
    "series, sync distorted by 3 %": series(DistortedSync, part=0.03),
    # Inside a series.
    "series, clock drifts by 2 ppm": series(DriftingClock, change_rel=2e-6),
    "series, clock drifts by 20 ppm": series(DriftingClock, change_rel=2e-5),
    "series, clock drifts by 100 ppm": series(DriftingClock, change_rel=1e-4),
    "series, clock drifts by 2000 ppm": series(DriftingClock, change_rel=2e-3),
    "series, rates scatter by 5 ppm": series(RateOfShot, scatter_rel=5e-6),
    "series, rates scatter by 50 ppm": series(RateOfShot, scatter_rel=5e-5),
    "series, rates scatter by 500 ppm": series(RateOfShot, scatter_rel=5e-4),
    "series, intervals jitter by 0.01 %": series(JitteringClock, jitter_rel=1e-4),
    "series, intervals jitter by 0.1 %": series(JitteringClock, jitter_rel=1e-3),
    "series, intervals jitter by 3 %": series(JitteringClock, jitter_rel=0.03),
    "series, a sample lost in 1 of 20": series(LostSample, part=0.05),
    "series, a sample lost in 1 of 5": series(LostSample, part=0.2),
    "series, a sample lost in each": series(LostSample, part=1.0),
    # Its start.
    "series, start waits 0.1 us": series(LateStart, mean_s=1e-7),
    "series, start waits 0.3 us": series(LateStart, mean_s=3e-7),
    "series, start waits 1 us": series(LateStart, mean_s=1e-6),
    "series, start waits 50 us": series(LateStart, mean_s=50e-6),
    "series, start waits 500 us": series(LateStart, mean_s=500e-6),
    "series, start within 1/5000 of a sample": series(LateStart, part_of_sample=0.0002),
    "series, start within 1/2000 of a sample": series(LateStart, part_of_sample=0.0005),
    "series, start within 1/1000 of a sample": series(LateStart, part_of_sample=0.001),
    "series, start within 1/4 of a sample": series(LateStart, part_of_sample=0.25),
    "series, start within 3/4 of a sample": series(LateStart, part_of_sample=0.75),
    # The oscilloscope.
    "series, trigger on 1/250 of the grid": series(TriggerOnGrid, coarse=0.004),
    "series, trigger on the grid": series(TriggerOnGrid, coarse=1.0),
    "series, trigger on 5 times the grid": series(TriggerOnGrid, coarse=5.0),
    "series, trace clipped at 0.99": series(ClippedTrace, limit_rel=0.99),
    "series, trace clipped at 0.9": series(ClippedTrace, limit_rel=0.9),
    "series, trace clipped at 0.5": series(ClippedTrace, limit_rel=0.5),
    "series, trace of 0.7 periods clipped at 0.7": series(
        ClippedTrace, SHORT_TRACES, limit_rel=0.7
    ),
    "series, trace of 0.7 periods, sync 0.1 %": series(DistortedSync, SHORT_TRACES, part=0.001),
    "series, trace of 0.7 periods, sync 1 %": series(DistortedSync, SHORT_TRACES, part=0.01),
    "series, trace of 0.7 periods, sync 10 %": series(DistortedSync, SHORT_TRACES, part=0.1),
}

CLEAN = ("clean, series of 5 shots", "clean, series with little noise", ONE_FREQUENCY)
MORE_DRAWS = {ONE_FREQUENCY: 15}
COVERED_ANYHOW = (
    "clean, series, traces of 0.7 periods",
    "free-running series with little noise",
    "series, sync distorted by 3 %",
)
GROSS = (
    "series, clock drifts by 2000 ppm",
    "series, rates scatter by 500 ppm",
    "series, intervals jitter by 3 %",
    "series, a sample lost in each",
    "series, trace clipped at 0.5",
    "series, trace of 0.7 periods clipped at 0.7",
    "series, trace of 0.7 periods, sync 10 %",
)


def wanted(name):
    if name in COVERED_ANYHOW:
        return COVERED
    return FLAGGED if name in GROSS else COVERED_OR_FLAGGED


EXPECTED = [Row(name, VALUE, wanted(name)) for name in CLASSES if name not in CLEAN]
EXPECTED += [Row(name, MAGNITUDE, COVERED_NO_FLAG) for name in CLEAN]
# A start that waits a time as short as the shots resolve moves them all.
EXPECTED += [Row(name, PHASE, COVERED_WITH_BOUND) for name in CLEAN if name != ONE_FREQUENCY]
# At one frequency nothing else says how long a start may wait, nor whether the series agree.
EXPECTED += [Row(ONE_FREQUENCY, PHASE, COVERED_AND_NARROW)]
