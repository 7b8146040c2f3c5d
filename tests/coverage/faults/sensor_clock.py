"""How a sensor's samples are stamped: coarse ticks, batches out of a FIFO, a clock that is set, and
samples that are missing without a number."""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, bench
from expected_row import LOSSES, RATE, VALUE, Row
from faults.fault import Fault
from judgement import COVERED, COVERED_OR_FLAGGED

FEW_STEPS = {"frequencies": ("12.5", "80", "200")}


class CoarseTicks(Fault):
    """Stamps are the last tick of a slow counter."""

    def __init__(self, calibration, rng, tick_us):
        super().__init__(calibration, rng)
        self.tick_ns = 1000 * tick_us

    def dau_record(self, times_s, columns):
        return columns | {"t_ns": columns["t_ns"] // self.tick_ns * self.tick_ns}


class Batches(Fault):
    """A FIFO is read every so many samples; stamps are counted back from the read-out with the
    interval of the data sheet."""

    def __init__(self, calibration, rng, samples):
        super().__init__(calibration, rng)
        self.samples = samples

    def dau_record(self, times_s, columns):
        stamps_ns = columns["t_ns"].copy()
        first = self.rng.integers(0, self.samples)
        for begin in [0, *range(first, stamps_ns.size, self.samples)]:
            end = min(begin + self.samples if begin >= first else first, stamps_ns.size)
            if end > begin:
                read_ns = stamps_ns[end - 1] + self.rng.integers(0, 100_000)
                stamps_ns[begin:end] = read_ns - np.arange(end - begin)[::-1] * 1_000_000
        return columns | {"t_ns": stamps_ns}


class ClockSteps(Fault):
    """The clock is set once within every step, to and fro."""

    def __init__(self, calibration, rng, size_us):
        super().__init__(calibration, rng)
        self.size_ns = round(1000 * size_us)

    def dau_record(self, times_s, columns):
        stamps_ns = columns["t_ns"].copy()
        sign = self.rng.choice((-1, 1))
        for step in self.steps:
            begin_s, end_s = step.evaluated_s(self.settings)
            at_s = begin_s + self.rng.uniform(0.2, 0.8) * (end_s - begin_s)
            stamps_ns[times_s >= at_s] += sign * self.size_ns
            sign = -sign
        return columns | {"t_ns": stamps_ns}


class HalfMissing(Fault):
    """Of every step the middle part is missing."""

    def __init__(self, calibration, rng, part):
        super().__init__(calibration, rng)
        self.part = part

    def dau_record(self, times_s, columns):
        kept = np.ones(times_s.size, dtype=bool)
        for step in self.steps:
            begin_s, end_s = step.evaluated_s(self.settings)
            middle_s, half_s = 0.5 * (begin_s + end_s), 0.5 * self.part * (end_s - begin_s)
            missing = np.abs(times_s - middle_s) < half_s
            self.calibration.lost[step.frequency_text, step.repetition] += int(missing.sum())
            kept &= ~missing
        return {name: values[kept] for name, values in columns.items()}


def stamped(fault, *parts, **more):
    return bench(FEW_STEPS, *parts, fault=fault, **more)


CLASSES = {
    **{
        f"stamps of ticks of {tick_us} us": stamped(
            functools.partial(CoarseTicks, tick_us=tick_us)
        )
        for tick_us in (250, 500, 1000)
    },
    "stamps filled in by batches of 200": stamped(functools.partial(Batches, samples=200)),
    **{
        f"clock steps of {size_us} us": stamped(
            functools.partial(ClockSteps, size_us=size_us), LITTLE_NOISE
        )
        for size_us in (20, 300, 3000)
    },
    **{
        f"clock steps of {size_us} us, absolute time": stamped(
            functools.partial(ClockSteps, size_us=size_us), method="absolute-time"
        )
        for size_us in (5, 20, 300)
    },
    **{
        f"{part:.0%} of every step missing, no sample numbers": stamped(
            functools.partial(HalfMissing, part=part),
            records_sample_numbers=False,
            duration_s=3.0,
        )
        for part in (0.1, 0.3, 0.5)
    },
}

EXPECTED = [
    *(
        Row(f"stamps of ticks of {tick_us} us", RATE, COVERED)
        for tick_us in (250, 500, 1000)
    ),
    Row("stamps filled in by batches of 200", RATE, COVERED),
    *(
        Row(f"clock steps of {size_us} us", VALUE, COVERED_OR_FLAGGED)
        for size_us in (20, 300, 3000)
    ),
    *(
        Row(f"clock steps of {size_us} us, absolute time", VALUE, COVERED_OR_FLAGGED)
        for size_us in (5, 20, 300)
    ),
    *(
        Row(f"{part:.0%} of every step missing, no sample numbers", judged, COVERED_OR_FLAGGED)
        for part in (0.1, 0.3, 0.5)
        for judged in (VALUE, LOSSES)
    ),
]
