"""What a channel has beside the excitation at its frequency: hum that lasts, that is there only
while the amplifier drives, that grows with the level or has the same phase in every repetition;
railway lines; narrow-band noise. And what is no hum: an exciter that rings down between the steps.
"""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, bench
from expected_row import MEAN, VALUE, Row
from faults.fault import Fault
from judgement import (
    COVERED,
    COVERED_AND_NARROW,
    COVERED_NO_FLAG,
    COVERED_OR_FLAGGED,
    FLAGGED,
)


class RingDown(Fault):
    """The exciter goes on with exp(-t / tau) until the next step; a resonance of it, so the sensor
    and the reference see the same."""

    def __init__(self, calibration, rng, tau_s=0.06):
        super().__init__(calibration, rng)
        self.tau_s = tau_s

    def _decay(self, times_s, of_step):
        added = np.zeros_like(times_s)
        ends_s = [step.begin_s for step in self.steps[1:]] + [np.inf]
        for step, next_s in zip(self.steps, ends_s):
            begin_s = step.end_s - 0.02  # where the excitation falls
            first, behind = np.searchsorted(times_s, [begin_s, next_s])
            after_s = times_s[first:behind] - begin_s
            amplitude, phase_rad = of_step(step)
            turn = 2.0 * np.pi * step.frequency_hz * times_s[first:behind] + phase_rad
            added[first:behind] += amplitude * np.exp(-after_s / self.tau_s) * np.sin(turn)
        return added

    def reference(self, times_s, values):
        return values + self._decay(times_s, lambda step: (step.amplitude, step.phase_rad))

    def sensor(self, times_s, values):
        return values + self._decay(
            times_s,
            lambda step: (step.amplitude * step.magnitude, step.phase_rad - step.delay_rad),
        )


class Hum(Fault):
    """A line in the sensor's signal, in parts of the amplitude of the first step."""

    def __init__(self, calibration, rng, part=0.005, line_hz=50.0, when="always", **more):
        super().__init__(calibration, rng)
        self.part, self.when = part, when
        self.line_hz = line_hz * (1.0 + 2e-4 * rng.standard_normal())
        self.phase_rad = rng.uniform(0.0, 2.0 * np.pi)
        self.grows = more.get("grows", False)  # with the level
        self.locked = more.get("locked", False)  # to the beginning of each step
        self.level_of = more.get("level_of", {})  # by frequency as text
        for step in self.steps:
            step.amplitude *= self.level_of.get(step.frequency_text, 1.0)

    def sensor(self, times_s, values):
        usual = self.settings.level_m_s2
        hum = self.part * usual * np.sin(2.0 * np.pi * self.line_hz * times_s + self.phase_rad)
        driven = np.zeros(times_s.size, dtype=bool)
        for step in self.steps:
            first, behind = np.searchsorted(times_s, [step.begin_s, step.end_s])
            driven[first:behind] = True
            if self.locked:
                since_s = times_s[first:behind] - step.begin_s
                turn = 2.0 * np.pi * self.line_hz * since_s + self.phase_rad + step.phase_rad
                hum[first:behind] = self.part * usual * np.sin(turn)
            if self.grows:
                hum[first:behind] *= step.amplitude / usual
        if self.when == "driven":
            hum[~driven] = 0.0
        elif self.when == "quiet":
            hum[driven] = 0.0
        return values + hum

    def bench_tables(self, tables):
        if self.level_of:
            excitation = tables["excitation"]
            excitation["level"] = [
                self.settings.level_m_s2 * self.level_of.get(text, 1.0)
                for text in self.settings.frequencies
            ]
        return tables


class NarrowBandNoise(Fault):
    """Noise about one frequency, whose standard deviation is a part of the amplitude."""

    def __init__(self, calibration, rng, part=0.01, centre_hz=63.0, width_hz=2.0, of="sensor"):
        super().__init__(calibration, rng)
        self.part, self.centre_hz, self.width_hz, self.of = part, centre_hz, width_hz, of

    def sensor(self, times_s, values):
        return self._beside(times_s, values) if self.of == "sensor" else values

    def reference(self, times_s, values):
        return self._beside(times_s, values) if self.of == "reference" else values

    def _beside(self, times_s, values):
        # Two slow normal processes of this bandwidth, drawn ten times as densely.
        interval_s = 0.1 / self.width_hz
        grid_s = np.arange(-10.0 / self.width_hz, times_s[-1] + 10.0 / self.width_hz, interval_s)
        keep = np.exp(-np.pi * self.width_hz * interval_s)
        slow = np.empty((2, grid_s.size))
        slow[:, 0] = self.rng.standard_normal(2)
        for i in range(1, grid_s.size):
            fresh = np.sqrt(1.0 - keep**2) * self.rng.standard_normal(2)
            slow[:, i] = keep * slow[:, i - 1] + fresh
        turn = 2.0 * np.pi * self.centre_hz * times_s
        noise = np.interp(times_s, grid_s, slow[0]) * np.cos(turn)
        noise += np.interp(times_s, grid_s, slow[1]) * np.sin(turn)
        return values + self.part * self.settings.level_m_s2 * noise


def hum(**more):
    return functools.partial(Hum, **more)


def narrow_band_noise(part, duration_s=1.5, **more):
    return bench(
        LITTLE_NOISE,
        frequencies=("31.5", "63", "80", "125"),
        duration_s=duration_s,
        fault=functools.partial(NarrowBandNoise, part=part, **more),
    )


AT_MAINS = ("31.5", "50", "80", "100", "150", "200")
ISO_266 = ("10", "12.5", "16", "20", "25", "31.5", "40", "50", "63", "80",
           "100", "125", "150", "160", "200")
RAILWAY = ("10", "12.5", "16.7", "25", "31.5", "40")
STRENGTHS = {"just visible": 0.0007, "clear": 0.005, "gross": 0.05}
NOISES = {"just visible": 0.001, "clear": 0.01, "gross": 0.05}

CLASSES = {
    **{
        f"clean, rings {1e3 * tau_s:g} ms, pauses {pause_s:g} s": bench(
            frequencies=AT_MAINS,
            pause_s=pause_s,
            fault=functools.partial(RingDown, tau_s=tau_s),
        )
        for tau_s, pause_s in ((0.02, 0.3), (0.06, 0.32), (0.2, 0.6), (0.2, 3.0))
    },
    "clean, ISO 266": bench(frequencies=ISO_266, duration_s=1.0),
    "clean, mains alone": bench(frequencies=("50", "100", "150", "200")),
    "clean, mains alone, little noise": bench(
        LITTLE_NOISE, frequencies=("50", "100", "150", "200"), duration_s=1.0
    ),
    "clean, mean of 3 at the mains": bench(
        frequencies=AT_MAINS,
        repetitions=3,
        pause_s=0.32,
        fault=functools.partial(RingDown, tau_s=0.06),
    ),
    **{
        f"hum at 50 Hz, {name}": bench(LITTLE_NOISE, frequencies=AT_MAINS, fault=hum(part=part))
        for name, part in STRENGTHS.items()
    },
    "hum at 60 Hz, clear": bench(
        LITTLE_NOISE, frequencies=("31.5", "60", "80", "120"), fault=hum(line_hz=60.0)
    ),
    **{
        f"hum while driven, {name}": bench(
            LITTLE_NOISE, frequencies=AT_MAINS, fault=hum(part=part, when="driven")
        )
        for name, part in STRENGTHS.items()
    },
    "hum while driven, 50 Hz alone": bench(
        LITTLE_NOISE, frequencies=("50",), fault=hum(when="driven")
    ),
    "hum in quiet time alone": bench(
        LITTLE_NOISE, frequencies=AT_MAINS, fault=hum(when="quiet")
    ),
    "hum grows with the level": bench(
        LITTLE_NOISE,
        frequencies=AT_MAINS,
        fault=hum(when="driven", grows=True, level_of={"50": 5.0}),
    ),
    **{
        f"hum locked to the generator, {name}": bench(
            LITTLE_NOISE,
            frequencies=AT_MAINS,
            repetitions=3,
            duration_s=0.8,
            fault=hum(part=part, when="driven", locked=True),
        )
        for name, part in STRENGTHS.items()
    },
    **{
        f"railway line of 16.7 Hz, {name}": bench(
            LITTLE_NOISE, frequencies=RAILWAY, fault=hum(part=part, line_hz=16.7)
        )
        for name, part in STRENGTHS.items()
    },
    **{
        f"noise {width_hz} Hz wide, {name}": narrow_band_noise(part, width_hz=width_hz)
        for width_hz in (0.2, 1.0, 2.0, 5.0)
        for name, part in NOISES.items()
    },
    **{
        f"noise 2.0 Hz wide in the reference, {name}": narrow_band_noise(part, of="reference")
        for name, part in NOISES.items()
    },
    **{
        f"noise 2.0 Hz wide, {away_hz} Hz beside the step": narrow_band_noise(
            0.01, centre_hz=63.0 + away_hz
        )
        for away_hz in (1, 3)
    },
    **{
        f"noise 2.0 Hz wide, steps of {duration_s} s": narrow_band_noise(0.01, duration_s)
        for duration_s in (0.5, 5.0)
    },
}

EXPECTED = [
    *(Row(name, VALUE, COVERED_NO_FLAG) for name in CLASSES if name.startswith("clean, rings")),
    Row("clean, ISO 266", VALUE, COVERED_NO_FLAG),
    # No step shows what hum there is: u holds what quiet time leaves possible.
    Row("clean, mains alone", VALUE, COVERED_AND_NARROW),
    Row("clean, mains alone, little noise", VALUE, COVERED_AND_NARROW),
    Row("clean, mean of 3 at the mains", MEAN, COVERED_NO_FLAG),
    *(Row(name, VALUE, COVERED_OR_FLAGGED) for name in CLASSES if name.startswith("hum at")),
    *(
        Row(f"hum while driven, {name}", VALUE, COVERED_OR_FLAGGED)
        for name in STRENGTHS
    ),
    Row("hum while driven, 50 Hz alone", VALUE, FLAGGED),
    Row("hum in quiet time alone", VALUE, COVERED),
    Row("hum grows with the level", VALUE, COVERED_OR_FLAGGED),
    *(Row(name, MEAN, COVERED_OR_FLAGGED) for name in CLASSES if name.startswith("hum locked")),
    *(Row(name, VALUE, COVERED_OR_FLAGGED) for name in CLASSES if name.startswith("railway")),
    *(Row(name, VALUE, COVERED_OR_FLAGGED) for name in CLASSES if name.startswith("noise ")),
]
