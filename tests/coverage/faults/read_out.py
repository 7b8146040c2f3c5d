"""Values that a sensor's read-out makes of good samples: bytes that change places, a code that the
converter never gives, a second sensor between the samples, a register that is polled."""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, bench
from expected_row import VALUE, Row
from faults.fault import Fault
from judgement import COVERED_OR_FLAGGED, FLAGGED

CODES = 1 << 16
RANGE_REL = 2.0  # half the range, in amplitudes


class SwappedBytes(Fault):
    """Of single samples the bytes of their code of 16 bits."""

    def __init__(self, calibration, rng, strength):
        super().__init__(calibration, rng)
        self.part = strength

    def sensor(self, times_s, values):
        scale = RANGE_REL * self.settings.level_m_s2 / (CODES // 2)
        codes = np.round(values / scale).astype(np.int16)
        swapped = self.rng.random(values.size) < self.part
        return scale * np.where(swapped, codes.byteswap(), codes)


class MissingCode(Fault):
    """Of a converter with steps of a part of the amplitude: one code reads as the next one."""

    def __init__(self, calibration, rng, strength):
        super().__init__(calibration, rng)
        self.step = strength * self.settings.level_m_s2
        self.missing = round(rng.uniform(0.2, 0.7) / strength)

    def sensor(self, times_s, values):
        codes = np.round(values / self.step)
        return self.step * np.where(codes == self.missing, codes + 1, codes)


class Interleaved(Fault):
    """Every second sample is of another sensor, which differs by a gain."""

    def __init__(self, calibration, rng, strength):
        super().__init__(calibration, rng)
        self.gain = 1.0 + strength

    def sensor(self, times_s, values):
        return np.where(np.arange(values.size) % 2, values * self.gain, values)


class Polled(Fault):
    """A register is read at every stamp, which the sensor writes by a clock of its own. The mean
    age of a value is a delay, which no data show: it is taken out."""

    def __init__(self, calibration, rng, strength):
        super().__init__(calibration, rng)
        self.interval_s = 1.0 / (strength * calibration.sensor_rate_hz)
        self.begin_s = -rng.uniform(0.0, self.interval_s)

    def sensor(self, times_s, values):
        written_s = times_s - (times_s - self.begin_s) % self.interval_s + 0.5 * self.interval_s
        values = values.copy()
        update = np.floor((times_s - self.begin_s) / self.interval_s).astype(np.int64)
        noise = self.rng.standard_normal(update[-1] + 1)[update]
        for step in self.steps:
            part = slice(*np.searchsorted(times_s, [step.begin_s, step.end_s]))
            amplitude = step.amplitude * step.magnitude
            values[part] = self.calibration.sensor_signal(step, written_s[part])
            values[part] += amplitude * self.settings.sensor_noise_rel * noise[part]
            values[part] += amplitude * self.settings.sensor_offset_rel
        return values


# Where no harmonic of the signal, nor of the mains, folds to half the rate less the signal.
FREQUENCIES = {"frequencies": ("12.5", "31.5", "63", "128", "160", "203")}
STRENGTHS = {
    "{:g} % of the values have their bytes swapped": (SwappedBytes, {0.05: 5e-4, 1: 0.01}),
    "a code of {:g} % of the amplitude is missing": (
        MissingCode, {0.5: 0.005, 5: 0.05, 20: 0.2}
    ),
    "every second sample of a sensor {:+g} %": (
        Interleaved, {0.02: 2e-4, 0.05: 5e-4, 0.1: 1e-3, 0.2: 2e-3}
    ),
    "polled, written at {:g} times the rate": (Polled, {5.3: 5.3, 1.013: 1.013}),
}
GROSS = {
    "{:g} % of the values have their bytes swapped": (SwappedBytes, {20: 0.2}),
    "every second sample of a sensor {:+g} %": (Interleaved, {5: 0.05, -90: -0.9}),
    "polled, written at {:g} times the rate": (Polled, {0.9997: 0.9997, 0.91: 0.91, 0.5: 0.5}),
}


def classes_of(strengths):
    return {
        text.format(shown): bench(
            LITTLE_NOISE, FREQUENCIES, fault=functools.partial(kind, strength=strength)
        )
        for text, (kind, of_kind) in strengths.items()
        for shown, strength in of_kind.items()
    }


SEEN, CERTAIN = classes_of(STRENGTHS), classes_of(GROSS)
CLASSES = {**SEEN, **CERTAIN}
EXPECTED = [
    *(Row(name, VALUE, COVERED_OR_FLAGGED) for name in SEEN),
    *(Row(name, VALUE, FLAGGED) for name in CERTAIN),
]
