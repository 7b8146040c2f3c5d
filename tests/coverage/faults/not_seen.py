"""What no data can show (deploy/guide/what-it-cannot-see.md). These rows must fail: one that holds
would say that the evaluation finds out after all, or that the class draws nothing."""

import math

import numpy as np

from class_presets import LITTLE_NOISE, bench
from expected_row import MAGNITUDE, PHASE, Row
from faults.fault import Fault
from judgement import COVERED_OR_FLAGGED

NO_DATA_SHOW_IT = "O: on the page what-it-cannot-see.md"
DELAY_S = 50e-6
ADC_DELAY_S = 10e-6
CROSS_TALK_REL = 0.01
STANDARD_GRAVITY = 9.80665


class LateCable(Fault):
    """A filter in the sensor's path that nobody states."""

    def sensor_lag_rad(self, step, times_s):
        return 2.0 * math.pi * step.frequency_hz * DELAY_S


class OtherAdc(Fault):
    """The calibration of another channel."""

    def __init__(self, calibration, rng):
        super().__init__(calibration, rng)
        for text in self.settings.frequencies:
            calibration.adc_lag_error_rad[text] += 2.0 * math.pi * float(text) * ADC_DELAY_S


class CrossTalk(Fault):
    """The drive, which sync is a copy of, in the reference."""

    def reference(self, times_s, values):
        values = values.copy()
        for step in self.steps:
            part = slice(*np.searchsorted(times_s, [step.begin_s, step.end_s]))
            turn = 2.0 * np.pi * step.frequency_hz * (times_s[part] - step.begin_s)
            drive = np.sin(turn + step.sync_phase_rad)
            values[part] += CROSS_TALK_REL * step.amplitude * drive
        return values


class SampleBefore(Fault):
    """The register is read before the sample is ready."""

    def sensor(self, times_s, values):
        return np.concatenate((values[:1], values[:-1]))


class GravityAsUnit(Fault):
    """A sensor file that takes g for m/s^2."""

    def sensor(self, times_s, values):
        return values / STANDARD_GRAVITY


class LateRegister(Fault):
    """A register that is polled at the stamps and written twenty times as often: values are held
    for a twentieth of the sensor's period, and late by half of that."""

    def sensor_lag_rad(self, step, times_s):
        held_s = 1.0 / (20.0 * self.calibration.sensor_rate_hz)
        return 2.0 * math.pi * step.frequency_hz * np.mod(times_s + 0.3 * held_s, held_s)


CLASSES = {
    "not seen: mean age of a register that is polled": bench(LITTLE_NOISE, fault=LateRegister),
    "not seen: a delay of 50 us": bench(LITTLE_NOISE, fault=LateCable),
    "not seen: ADC calibration of another channel": bench(LITTLE_NOISE, fault=OtherAdc),
    "not seen: 1 % of the drive in the reference": bench(LITTLE_NOISE, fault=CrossTalk),
    "not seen: values of the sample before": bench(LITTLE_NOISE, fault=SampleBefore),
    "not seen: g taken for m/s^2": bench(LITTLE_NOISE, fault=GravityAsUnit),
}

EXPECTED = [
    Row("not seen: a delay of 50 us", PHASE, COVERED_OR_FLAGGED, NO_DATA_SHOW_IT),
    Row(
        "not seen: ADC calibration of another channel", PHASE, COVERED_OR_FLAGGED, NO_DATA_SHOW_IT
    ),
    Row(
        "not seen: 1 % of the drive in the reference",
        MAGNITUDE,
        COVERED_OR_FLAGGED,
        NO_DATA_SHOW_IT,
    ),
    Row("not seen: values of the sample before", PHASE, COVERED_OR_FLAGGED, NO_DATA_SHOW_IT),
    Row(
        "not seen: mean age of a register that is polled",
        PHASE,
        COVERED_OR_FLAGGED,
        NO_DATA_SHOW_IT,
    ),
    Row("not seen: g taken for m/s^2", MAGNITUDE, COVERED_OR_FLAGGED, NO_DATA_SHOW_IT),
]
