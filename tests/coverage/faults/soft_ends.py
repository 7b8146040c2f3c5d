"""Ends of a range that no equal values betray: a filter or noise lies behind them.

Depths are what the peaks lose, in parts of the amplitude. A channel's own filter is the mean of
some samples that are taken faster; its delay belongs to the sensor and is put back.
"""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, SERIES, bench
from expected_row import VALUE, Row
from faults.fault import Fault

FASTER = 16


def bent(turned, upper, lower, knee):
    """`turned` in parts of the amplitude; a knee rounds the corner over that part of it."""
    if not knee:
        return np.clip(turned, -lower, upper)
    softened = np.where(turned > 0.0, upper, lower)
    over = np.abs(turned) - softened
    # log(1 + e^x): the corner as a curve, the same far away from it.
    return np.sign(turned) * (np.abs(turned) - knee * np.logaddexp(0.0, over / knee))


class SoftEnds(Fault):
    """The sensor's signal is cut off before its noise, or before its own filter and after noise."""

    def __init__(self, calibration, rng, upper=np.inf, lower=np.inf, knee=0.0, filtered=False):
        super().__init__(calibration, rng)
        self.upper, self.lower, self.knee, self.filtered = upper, lower, knee, filtered

    def sensor(self, times_s, values):
        values = values.copy()
        for step in self.steps:
            first, behind = np.searchsorted(times_s, [step.begin_s, step.end_s])
            part = slice(first, behind)
            amplitude = step.amplitude * step.magnitude
            if not self.filtered:
                clean = self.calibration.sensor_signal(step, times_s[part])
                values[part] += (
                    amplitude * bent(clean / amplitude, self.upper, self.lower, self.knee) - clean
                )
                continue
            # Noise is drawn at the faster rate, so that as much of it is left behind the mean.
            fast_s = np.arange(FASTER) - (FASTER - 1) / 2.0
            fast_s = times_s[part, None] + fast_s / FASTER / self.calibration.sensor_rate_hz
            clean = self.calibration.sensor_signal(step, fast_s.ravel()).reshape(fast_s.shape)
            noise = self.settings.sensor_noise_rel * amplitude * np.sqrt(FASTER)
            noise = noise * self.rng.standard_normal(clean.shape)
            turned = bent((clean + noise) / amplitude, self.upper, self.lower, self.knee)
            # The mean of so many shortens the sine itself: part of H, so not here.
            shortened = np.sinc(step.frequency_hz / self.calibration.sensor_rate_hz)
            values[part] = amplitude * turned.mean(axis=1) / shortened
            values[part] += self.settings.sensor_offset_rel * amplitude
        return values


class SoftReference(Fault):
    def __init__(self, calibration, rng, upper, lower):
        super().__init__(calibration, rng)
        self.upper, self.lower = upper, lower

    def reference(self, times_s, values):
        values = values.copy()
        for step in self.steps:
            first, behind = np.searchsorted(times_s, [step.begin_s, step.end_s])
            part = slice(first, behind)
            clean = step.amplitude * self.calibration._excitation(step, times_s[part])
            cut = step.amplitude * bent(clean / step.amplitude, self.upper, self.lower, 0.0)
            values[part] += cut - clean
        return values


class SoftSeries(Fault):
    def __init__(self, calibration, rng, limit):
        super().__init__(calibration, rng)
        self.limit = limit

    def series(self, step, times_s, values):
        amplitude = step.amplitude * step.magnitude
        offset = self.settings.sensor_offset_rel * amplitude
        noise = 0.3 * self.settings.sensor_noise_rel * amplitude
        cut = np.clip(values - offset, -self.limit * amplitude, self.limit * amplitude)
        return cut + offset + noise * self.rng.standard_normal(values.size)


class WrappedPeaks(Fault):
    """The converter's code overflows: a value just above the end becomes one at the other end."""

    def __init__(self, calibration, rng, limit):
        super().__init__(calibration, rng)
        self.limit = limit

    def sensor(self, times_s, values):
        values = values.copy()
        for step in self.steps:
            first, behind = np.searchsorted(times_s, [step.begin_s, step.end_s])
            part = slice(first, behind)
            limit = self.limit * step.amplitude * step.magnitude
            values[part] = (values[part] + limit) % (2.0 * limit) - limit
        return values


def soft(**how):
    return functools.partial(SoftEnds, **how)


# Below an eighth of the sensor's rate.
LOW = {"frequencies": ("12.5", "20", "31.5", "40", "63", "80"), "sensor_offset_rel": 0.0}
LITTLE = {**LOW, "sensor_noise_rel": 0.001}
SOME = {**LOW, "sensor_noise_rel": 0.008}

# Where harmonics fold or a good sensor's filter would take them, bent peaks are hardly seen.
HIGH = {"frequencies": ("90", "100.3", "128", "160", "200", "240")}

CLASSES = {
    "sensor cut at 0.995 A before its noise": bench(
        LITTLE, fault=soft(upper=0.995, lower=0.995)
    ),
    "sensor cut at 0.97 A before its noise": bench(SOME, fault=soft(upper=0.97, lower=0.97)),
    "sensor cut at 0.9 A before its noise": bench(SOME, fault=soft(upper=0.9, lower=0.9)),
    "sensor cut at 0.99 A before its filter": bench(
        SOME, fault=soft(upper=0.99, lower=0.99, filtered=True)
    ),
    "sensor cut at 0.96 A before its filter": bench(
        SOME, fault=soft(upper=0.96, lower=0.96, filtered=True)
    ),
    "sensor cut at 0.9 A before its filter": bench(
        SOME, fault=soft(upper=0.9, lower=0.9, filtered=True)
    ),
    "sensor's upper peaks cut at 0.98 A": bench(LITTLE, fault=soft(upper=0.98)),
    "sensor's lower peaks cut at 0.9 A": bench(SOME, fault=soft(lower=0.9)),
    "sensor with a soft knee at 0.95 A": bench(
        LITTLE, fault=soft(upper=0.95, lower=0.95, knee=0.02)
    ),
    "reference's upper peaks cut at 0.97 A": bench(
        LITTLE,
        frequencies=("12.5", "16", "20", "25", "31.5", "40"),
        fault=functools.partial(SoftReference, upper=0.97, lower=np.inf),
    ),
    "reference cut at 0.9 A": bench(
        LITTLE,
        frequencies=("12.5", "16", "20", "25", "31.5", "40"),
        fault=functools.partial(SoftReference, upper=0.9, lower=0.9),
    ),
    "sensor's codes overflow at 1.01 A": bench(
        LITTLE, sensor_offset_rel=0.0125, fault=functools.partial(WrappedPeaks, limit=1.01)
    ),
    "series cut at 0.9 A before its noise": bench(
        SERIES,
        frequencies=("20", "31.5", "40", "63", "80"),
        sensor_noise_rel=0.003,
        fault=functools.partial(SoftSeries, limit=0.9),
    ),
    "above rate / 8, sensor cut at 0.99 A before its filter": bench(
        SOME, HIGH, fault=soft(upper=0.99, lower=0.99, filtered=True)
    ),
    "above rate / 8, sensor cut at 0.97 A": bench(
        LITTLE, HIGH, fault=soft(upper=0.97, lower=0.97)
    ),
    "above rate / 8, sensor cut at 0.9 A before its filter": bench(
        SOME, HIGH, fault=soft(upper=0.9, lower=0.9, filtered=True)
    ),
    "above rate / 8, reference cut at 0.9 A": bench(
        LITTLE, HIGH, fault=functools.partial(SoftReference, upper=0.9, lower=0.9)
    ),
    "above rate / 8, reference cut at 0.97 A": bench(
        LITTLE, HIGH, fault=functools.partial(SoftReference, upper=0.97, lower=0.97)
    ),
    # The opposite: nothing is cut.
    "clean, exciter with harmonics of 3, 2, 1 %": bench(harmonics_rel=(0.03, 0.02, 0.01)),
    "clean, above rate / 8, exciter with eight harmonics": bench(
        HIGH, harmonics_rel=(0.003, 0.01, 0.002, 0.006, 0.001, 0.003, 0.001, 0.002)
    ),
    # Products of two orders turn with twice the phase, as what stamps that scatter leave does.
    "clean, above rate / 8, exciter with harmonics of 3, 2, 1 %": bench(
        HIGH, LITTLE_NOISE, harmonics_rel=(0.03, 0.02, 0.01)
    ),
    "clean, above rate / 8, sensor with harmonics of 3, 1 %": bench(
        HIGH, LITTLE_NOISE, sensor_harmonics_rel=(0.03, 0.01)
    ),
    "clean, sensor with harmonics of its own": bench(
        LITTLE, sensor_harmonics_rel=(0.001, 0.0005)
    ),
    "clean, sensor with 10 % noise": bench(sensor_noise_rel=0.1),
}

EXPECTED = [
    *(
        Row(name, VALUE, "covered or flagged")
        for name in (
            "sensor cut at 0.995 A before its noise",
            "sensor cut at 0.99 A before its filter",
            "sensor's upper peaks cut at 0.98 A",
            "reference's upper peaks cut at 0.97 A",
        )
    ),
    # Of a run in which one step alone shows it, or none.
    Row(
        "above rate / 8, sensor cut at 0.99 A before its filter",
        VALUE,
        "covered or mostly flagged",
    ),
    *(
        Row(name, VALUE, "flagged")
        for name in (
            "sensor cut at 0.97 A before its noise",
            "sensor cut at 0.9 A before its noise",
            "sensor cut at 0.96 A before its filter",
            "sensor cut at 0.9 A before its filter",
            "sensor's lower peaks cut at 0.9 A",
            "sensor with a soft knee at 0.95 A",
            "reference cut at 0.9 A",
            "sensor's codes overflow at 1.01 A",
            "series cut at 0.9 A before its noise",
            "above rate / 8, sensor cut at 0.97 A",
            "above rate / 8, sensor cut at 0.9 A before its filter",
            "above rate / 8, reference cut at 0.9 A",
            "above rate / 8, reference cut at 0.97 A",
        )
    ),
    *(Row(name, VALUE, "covered, no flag") for name in CLASSES if name.startswith("clean")),
]
