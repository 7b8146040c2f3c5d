"""Tables of the reference between their points, and scatter that whole sweeps share, as when the
sensor is mounted anew between them."""

import functools
import math

from bench_files import write_reference_calibration
from class_presets import LITTLE_NOISE, SHORT_ANALOGUE_STEPS, bench
from expected_row import MEAN, PHASE, VALUE, Row
from faults.fault import Fault
from judgement import (
    COVERED,
    COVERED_AS_STUDENT,
    COVERED_NO_FLAG,
    COVERED_NO_MORE,
    COVERED_OR_FLAGGED,
    FLAGGED,
)


class ReferenceTable(Fault):
    """A certificate whose points are not the frequencies of the run."""

    points_hz = ()

    def __init__(self, calibration, rng):
        super().__init__(calibration, rng)
        calibration.reference_response = self.response
        calibration._write_reference_calibration = self.write

    def response(self, frequency_hz):
        raise NotImplementedError

    def write(self, folder):
        points = [
            (
                f,
                *self.response(f),
                self.settings.u_reference_magnitude_rel,
                self.settings.u_reference_phase_rad,
            )
            for f in self.points_hz
        ]
        write_reference_calibration(folder / "reference.csv", points)


class Inverting(ReferenceTable):
    """A charge amplifier that inverts: 179.9, -179.8 ... degrees."""

    points_hz = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)

    def response(self, frequency_hz):
        octaves = math.log2(frequency_hz / 57.0)
        return 1.0, math.radians(math.remainder(self.degrees(octaves), 360.0))

    def degrees(self, octaves):
        return 180.05 + 0.15 * octaves + 0.02 * octaves**2


class Ripple(Inverting):
    """The same, up and down within some points of the table, from anywhere on: the standing wave of
    a cable or a mount."""

    def __init__(self, calibration, rng, points_a_period, half_degrees=0.25):
        self.turn_an_octave = 2.0 * math.pi / points_a_period
        self.half_degrees, self.begin = half_degrees, rng.uniform(0.0, 2.0 * math.pi)
        super().__init__(calibration, rng)

    def degrees(self, octaves):
        wave = math.sin(self.turn_an_octave * octaves + self.begin)
        return super().degrees(octaves) + self.half_degrees * wave


class Late(ReferenceTable):
    """Its phase makes more than half a turn from one point to the next."""

    points_hz = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)

    def __init__(self, calibration, rng, delay_s):
        self.delay_s = delay_s
        super().__init__(calibration, rng)

    def response(self, frequency_hz):
        return 1.0, math.remainder(-2.0 * math.pi * frequency_hz * self.delay_s, 2.0 * math.pi)


class HighPass(ReferenceTable):
    points_hz = (10.0, 20.0, 40.0)

    def __init__(self, calibration, rng, corner_hz):
        self.corner_hz = corner_hz
        super().__init__(calibration, rng)

    def response(self, frequency_hz):
        ratio = self.corner_hz / frequency_hz
        return 1.0 / math.hypot(1.0, ratio), math.atan(ratio)


class SweepsScatter(Fault):
    """The sensor answers a little otherwise in each sweep, alike at all frequencies. What these
    have in common errs together: one of them is judged, another in every calibration."""

    def __init__(self, calibration, rng, scatter_rel):
        super().__init__(calibration, rng)
        scatter = scatter_rel * rng.standard_normal((self.settings.repetitions + 1, 2))
        for step in self.steps:
            step.magnitude *= 1.0 + scatter[step.repetition, 0]
            step.delay_rad -= scatter[step.repetition, 1]
        judged = self.settings.frequencies[rng.integers(len(self.settings.frequencies))]
        whole = calibration.truth

        def of_one_frequency():
            truth = whole()
            truth.magnitude = {judged: truth.magnitude[judged]}
            truth.phase_rad = {judged: truth.phase_rad[judged]}
            return truth

        calibration.truth = of_one_frequency


class UpsideDown(Fault):
    """One sweep with the sensor the other way."""

    def __init__(self, calibration, rng):
        super().__init__(calibration, rng)
        for step in self.steps:
            if step.repetition == 2:
                step.delay_rad += math.pi


class Resonance(Fault):
    """Its phase is no straight line over frequency. Only flags are judged: truth has none of it."""

    def __init__(self, calibration, rng):
        super().__init__(calibration, rng)
        for step in self.steps:
            ratio = step.frequency_hz / 250.0
            step.delay_rad += math.atan2(0.2 * ratio, 1.0 - ratio**2)


TABLE = {**LITTLE_NOISE, "calibrated_reference": True}
AT_TABLE_HZ = {"frequencies": ("12.5", "14", "16", "18", "25", "31.5")}
RIPPLES = (4.0, 4.5, 6.0, 9.0)
HIGH_PASSES = {"just visible": 0.3, "clear": 1.0, "gross": 3.0}  # corner in Hz
SCATTER = {"just visible": 5e-4, "clear": 2e-3, "gross": 2e-2}
TWO = {**SHORT_ANALOGUE_STEPS, "frequencies": ("31.5", "80")}
FOUR = {**SHORT_ANALOGUE_STEPS, "frequencies": ("12.5", "31.5", "80", "128")}
TEN = {
    **SHORT_ANALOGUE_STEPS,
    "frequencies": ("12.5", "16", "20", "22", "31.5", "40", "45", "63", "80", "128"),
}


def sweeps_scatter(preset, repetitions, scatter_rel):
    return bench(
        preset,
        repetitions=repetitions,
        fault=functools.partial(SweepsScatter, scatter_rel=scatter_rel),
    )


CLASSES = {
    "table of an inverting reference, between points": bench(TABLE, fault=Inverting),
    **{
        f"table of {points:g} points a period of its ripple": bench(
            TABLE, fault=functools.partial(Ripple, points_a_period=points)
        )
        for points in RIPPLES
    },
    **{
        f"table of a reference {1e3 * delay_s:g} ms late, between points": bench(
            TABLE, fault=functools.partial(Late, delay_s=delay_s)
        )
        for delay_s in (0.5e-3, 5e-3)
    },
    **{
        f"table of a high pass, {strength}, between points": bench(
            TABLE, AT_TABLE_HZ, fault=functools.partial(HighPass, corner_hz=corner_hz)
        )
        for strength, corner_hz in HIGH_PASSES.items()
    },
    **{
        f"mean of {n}, sweeps scatter, {strength}": sweeps_scatter(FOUR, n, scatter_rel)
        for n in (2, 3, 5)
        for strength, scatter_rel in SCATTER.items()
    },
    **{
        f"mean of {n}, sweeps scatter, two frequencies": sweeps_scatter(TWO, n, SCATTER["clear"])
        for n in (2, 3, 5)
    },
    "mean of 2, sweeps scatter, ten frequencies": sweeps_scatter(TEN, 2, SCATTER["gross"]),
    "mean of 3, one sweep upside down": bench(
        SHORT_ANALOGUE_STEPS, repetitions=3, fault=UpsideDown
    ),
    "group delay at multiples of 40 Hz": bench(LITTLE_NOISE, frequencies=("40", "80", "160")),
    "group delay of a resonance": bench(LITTLE_NOISE, fault=Resonance),
    "clean, three frequencies that tell the delay": bench(frequencies=("12.5", "16", "80")),
}

EXPECTED = [
    Row("table of an inverting reference, between points", VALUE, COVERED),
    *(
        Row(f"table of {points:g} points a period of its ripple", PHASE, COVERED)
        for points in RIPPLES
    ),
    *(
        Row(f"table of a reference {name} ms late, between points", VALUE, COVERED_OR_FLAGGED)
        for name in ("0.5", "5")
    ),
    *(Row(f"table of a high pass, {one}, between points", VALUE, COVERED) for one in HIGH_PASSES),
    *(
        Row(f"mean of {n}, sweeps scatter, {strength}", MEAN, COVERED_AS_STUDENT)
        for n in (2, 3, 5)
        for strength in SCATTER
    ),
    # Far above the noise nothing is left to guess: neither more nor less than stated.
    *(Row(f"mean of {n}, sweeps scatter, gross", MEAN, COVERED_NO_MORE) for n in (2, 3, 5)),
    *(
        Row(f"mean of {n}, sweeps scatter, two frequencies", MEAN, COVERED_AS_STUDENT)
        for n in (2, 3, 5)
    ),
    Row("mean of 2, sweeps scatter, ten frequencies", MEAN, COVERED_AS_STUDENT),
    Row("mean of 3, one sweep upside down", MEAN, FLAGGED),
    Row("group delay at multiples of 40 Hz", MEAN, FLAGGED),
    Row("group delay of a resonance", MEAN, FLAGGED),
    Row("clean, three frequencies that tell the delay", MEAN, COVERED_NO_FLAG),
]
MORE_DRAWS = {
    **{f"table of {points:g} points a period of its ripple": 2 for points in RIPPLES},
    **{f"mean of {n}, sweeps scatter, gross": 4 for n in (2, 3, 5)},
    **{f"mean of {n}, sweeps scatter, two frequencies": 2 for n in (2, 3, 5)},
    "mean of 2, sweeps scatter, ten frequencies": 2,
}
