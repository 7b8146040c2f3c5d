"""Something happens while a step is recorded: the exciter wanders, the sensor or its stamps change,
somebody knocks, the noise has a memory.

A step is what is evaluated of it, from 0 to 1 (Step.evaluated_s). What both sensor and reference
feel must cost nothing; what only one of them has must be in u, or flagged.
"""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, LOW_FREQUENCIES, bench
from expected_row import VALUE, Row
from faults.fault import Fault
from judgement import COVERED, COVERED_AND_NARROW, COVERED_NO_FLAG, COVERED_OR_FLAGGED, FLAGGED

KNOCK_S = 0.01
SLEW_S = 0.5


def place_in(step, settings, times_s):
    begin_s, end_s = step.evaluated_s(settings)
    return (times_s - begin_s) / (end_s - begin_s)


class Wandering(Fault):
    """The exciter's level: a ramp over the step, a modulation, a step in its middle."""

    def __init__(self, calibration, rng, ramp_rel=0.0, modulated_rel=0.0, by_hz=1.0, step_rel=0.0):
        super().__init__(calibration, rng)
        self.ramp_rel, self.step_rel = ramp_rel, step_rel
        self.modulated_rel, self.by_hz = modulated_rel, by_hz
        self.turned_rad = rng.uniform(0.0, 2.0 * np.pi)
        self.steps_at = rng.uniform(0.3, 0.7)

    def exciter(self, step, times_s, signal):
        place = place_in(step, self.settings, times_s)
        level = 1.0 + self.ramp_rel * place + self.step_rel * (place > self.steps_at)
        angle = 2.0 * np.pi * self.by_hz * (times_s - step.begin_s) + self.turned_rad
        return signal * (level + self.modulated_rel * np.sin(angle))


class Settling(Fault):
    """The exciter's level, still a part above its end where the step is evaluated from."""

    def __init__(self, calibration, rng, part, time_s):
        super().__init__(calibration, rng)
        self.part, self.time_s = part, time_s

    def exciter(self, step, times_s, signal):
        since_s = times_s - step.evaluated_s(self.settings)[0]
        return signal * (1.0 + self.part * np.exp(-since_s / self.time_s))


class Changing(Fault):
    """The sensor from some place in the step on: its delay, in seconds or in samples; its gain, at
    once or creeping there."""

    def __init__(self, calibration, rng, late_s=0.0, gain_rel=0.0, creeps_s=0.0):
        super().__init__(calibration, rng)
        self.late_s, self.gain_rel, self.creeps_s = late_s, gain_rel, creeps_s
        self.at = rng.uniform(0.3, 0.7)

    def sensor_lag_rad(self, step, times_s):
        late = place_in(step, self.settings, times_s) > self.at
        return 2.0 * np.pi * step.frequency_hz * self.late_s * late

    def sensor(self, times_s, values):
        if not self.gain_rel:
            return values
        gain = np.ones_like(values)
        for step in self.steps:
            begin_s, end_s = step.evaluated_s(self.settings)
            first, behind = np.searchsorted(times_s, [step.begin_s, step.end_s])
            since_s = times_s[first:behind] - (begin_s + self.at * (end_s - begin_s))
            part = since_s > 0.0
            if self.creeps_s:
                part = part * (1.0 - np.exp(-np.maximum(since_s, 0.0) / self.creeps_s))
            gain[first:behind] += self.gain_rel * part
        return gain * values


class SlewingClock(Fault):
    """The sensor's clock is brought to another time within half a second of every step. Where it
    returns it is right again before the next step: else it is off by more than is stated of it."""

    def __init__(self, calibration, rng, by_s, returns=False):
        super().__init__(calibration, rng)
        self.by_s, self.returns = by_s, returns
        self.at = rng.uniform(0.3, 0.5)

    def dau_record(self, times_s, columns):
        late_s = np.zeros_like(times_s)
        for step in self.steps:
            begin_s, end_s = step.evaluated_s(self.settings)
            since_s = times_s - (begin_s + self.at * (end_s - begin_s))
            late_s += self.by_s * np.clip(since_s / SLEW_S, 0.0, 1.0)
            if self.returns:
                late_s -= self.by_s * (times_s > step.end_s)
        stamps_ns = columns["t_ns"] + np.round(1e9 * late_s).astype(np.int64)
        return {**columns, "t_ns": stamps_ns}


class Knock(Fault):
    """Half a sine of 10 ms within every step, in amplitudes, in the sensor or the reference."""

    def __init__(self, calibration, rng, size_rel, where):
        super().__init__(calibration, rng)
        self.size_rel, self.where = size_rel, where
        self.at = rng.uniform(0.2, 0.8)

    def _knocked(self, times_s, values):
        values = values.copy()
        for step in self.steps:
            begin_s, end_s = step.evaluated_s(self.settings)
            since_s = times_s - (begin_s + self.at * (end_s - begin_s))
            inside = (since_s > 0.0) & (since_s < KNOCK_S)
            shape = np.sin(np.pi * since_s[inside] / KNOCK_S)
            values[inside] += self.size_rel * step.amplitude * shape
        return values

    def sensor(self, times_s, values):
        return self._knocked(times_s, values) if self.where == "sensor" else values

    def reference(self, times_s, values):
        return self._knocked(times_s, values) if self.where == "reference" else values


class TwoKnocks(Knock):
    """A second one, later in the same step."""

    def __init__(self, calibration, rng, size_rel, where):
        super().__init__(calibration, rng, size_rel, where)
        self.places = rng.uniform(0.15, 0.4), rng.uniform(0.5, 0.85)

    def _knocked(self, times_s, values):
        for self.at in self.places:
            values = super()._knocked(times_s, values)
        return values


def shaped_noise(size, power, rng):
    """Noise whose density is f^-power, of standard deviation 1."""
    spectrum = np.fft.rfft(rng.standard_normal(size))
    frequency = np.maximum(np.fft.rfftfreq(size), 1.0 / size)
    noise = np.fft.irfft(spectrum * frequency ** (-0.5 * power), size)
    return noise / np.std(noise)


def remembering_noise(size, memory, rng):
    """AR(1) of standard deviation 1."""
    spectrum = np.fft.rfft(rng.standard_normal(size))
    turn = np.exp(-2j * np.pi * np.fft.rfftfreq(size))
    noise = np.fft.irfft(spectrum / (1.0 - memory * turn), size)
    return noise / np.std(noise)


class ColouredNoise(Fault):
    """Beside the sensor's own: 1/f^power, or AR(1)."""

    def __init__(self, calibration, rng, noise_rel, power=0.0, memory=0.0):
        super().__init__(calibration, rng)
        self.noise_rel, self.power, self.memory = noise_rel, power, memory

    def sensor(self, times_s, values):
        size = self.noise_rel * self.settings.level_m_s2
        if self.power:
            # A record as long as a step: slower noise is an offset to it.
            parts = [self.steps[0].begin_s] + [step.end_s for step in self.steps]
            borders = np.searchsorted(times_s, parts[1:-1])
            pieces = np.split(np.arange(times_s.size), borders)
            noise = np.concatenate([shaped_noise(p.size, self.power, self.rng) for p in pieces])
        else:
            noise = remembering_noise(times_s.size, self.memory, self.rng)
        return values + size * noise


QUIET = {**LITTLE_NOISE, "frequencies": ("20", "80", "125", "200"), "duration_s": 3.0}
STEADY = {**QUIET, "sensor_noise_rel": 1e-5, "reference_noise_rel": 1e-5}
SLOW = {**LOW_FREQUENCIES, "sensor_noise_rel": 1e-4, "reference_noise_rel": 1e-4}


def with_fault(kind, *presets, **options):
    return bench(*presets, fault=functools.partial(kind, **options))


WANDERING = {
    "exciter on a ramp of 0.1 %": {"ramp_rel": 0.001},
    "exciter on a ramp of 1 %": {"ramp_rel": 0.01},
    "exciter on a ramp of 5 %": {"ramp_rel": 0.05},
    "exciter modulated by 1 % at 0.4 Hz": {"modulated_rel": 0.01, "by_hz": 0.4},
    "exciter modulated by 2 % at 3.3 Hz": {"modulated_rel": 0.02, "by_hz": 3.3},
    "exciter steps by 1 %": {"step_rel": 0.01},
}
SETTLING = {
    f"exciter settles by 0.3 % in {time_s:g} s": {"part": 0.003, "time_s": time_s}
    for time_s in (0.3, 1.0, 3.0)
}
STEPPING = {"amplifier steps by 20 %": {"step_rel": 0.2}}
CHANGING = {
    "sensor 0.2 us later within the step": ({"late_s": 2e-7}, COVERED_OR_FLAGGED),
    "sensor 0.1 ms later within the step": ({"late_s": 1e-4}, FLAGGED),
    "sensor 1 ms later within the step": ({"late_s": 1e-3}, FLAGGED),
    "FIFO 3 samples late within the step": ({"late_s": 3.0 / 1003.05}, FLAGGED),
    "gain changes by 0.005 %": ({"gain_rel": 5e-5}, COVERED_OR_FLAGGED),
    "gain changes by 2 %": ({"gain_rel": 0.02}, FLAGGED),
    "gain creeps by 2 %": ({"gain_rel": 0.02, "creeps_s": 0.4}, FLAGGED),
    "gain halves": ({"gain_rel": -0.5}, FLAGGED),
}
SLEWS = {f"clock slews by {by} within the step": {"by_s": s} for by, s in
         (("10 us", 1e-5), ("0.2 ms", 2e-4), ("2 ms", 2e-3))}
KNOCKS = {
    f"{where} knocked by {size:g} amplitudes": {"size_rel": size, "where": where}
    for where in ("sensor", "reference")
    for size in (0.02, 0.5, 50.0)
}
TWO_KNOCKS = {
    f"{where} knocked twice by {size:g} amplitudes": {"size_rel": size, "where": where}
    for where in ("sensor", "reference")
    for size in (0.02, 0.5, 50.0)
}
# The same of other methods; in the classes above the DAU's clock stamps sync and the sensor. Where
# the sensor's clock counts, its uncertainty is stated: else every result has a flag for that alone.
METHODS = {
    "analogue": {"method": "analogue"},
    "absolute-time": {"method": "absolute-time", "u_stamp_s": 2e-7},
    "own clock": {"own_clock": True, "u_stamp_s": 2e-7},
}
KNOCK = {"size_rel": 0.5, "where": "sensor"}
OF_METHODS = {
    f"{method}: {name}": (kind, {**QUIET, **settings}, options, wanted)
    for method, settings in METHODS.items()
    for name, kind, options, wanted in (
        ("nothing happens", Fault, {}, COVERED_NO_FLAG),
        ("gain changes by 0.005 %", Changing, {"gain_rel": 5e-5}, COVERED_OR_FLAGGED),
        ("gain changes by 2 %", Changing, {"gain_rel": 0.02}, FLAGGED),
        ("sensor 1 ms later", Changing, {"late_s": 1e-3}, FLAGGED),
        ("knocked by 0.5 amplitudes", Knock, KNOCK, COVERED_OR_FLAGGED),
        ("knocked twice by 0.5 amplitudes", TwoKnocks, KNOCK, COVERED_OR_FLAGGED),
        ("clock slews by 1 us", SlewingClock, {"by_s": 1e-6, "returns": True}, COVERED_OR_FLAGGED),
        ("clock slews by 10 us", SlewingClock, {"by_s": 1e-5, "returns": True}, COVERED_OR_FLAGGED),
        ("clock slews by 2 ms", SlewingClock, {"by_s": 2e-3, "returns": True}, FLAGGED),
    )
    if method != "analogue" or kind is not SlewingClock
}
NOISES = {
    "three periods, 1/f noise of 1 %": (SLOW, {"noise_rel": 0.01, "power": 1.0}),
    "three periods, 1/f noise of 0.03 %": (SLOW, {"noise_rel": 3e-4, "power": 1.0}),
    "three periods, 1/f^2 noise of 1 %": (SLOW, {"noise_rel": 0.01, "power": 2.0}),
    "noise with a memory of -0.9": (STEADY, {"noise_rel": 0.01, "memory": -0.9}),
    "noise with a memory of 0.99": (STEADY, {"noise_rel": 0.01, "memory": 0.99}),
}

CLASSES = {
    **{
        name: with_fault(Wandering, QUIET, **options)
        for name, options in (WANDERING | STEPPING).items()
    },
    **{name: with_fault(Settling, QUIET, **options) for name, options in SETTLING.items()},
    **{name: with_fault(Changing, QUIET, **options) for name, (options, _) in CHANGING.items()},
    **{name: with_fault(SlewingClock, QUIET, **options) for name, options in SLEWS.items()},
    **{name: with_fault(Knock, QUIET, **options) for name, options in KNOCKS.items()},
    **{name: with_fault(TwoKnocks, QUIET, **options) for name, options in TWO_KNOCKS.items()},
    **{
        name: with_fault(kind, preset, **options)
        for name, (kind, preset, options, _) in OF_METHODS.items()
    },
    **{
        name: with_fault(ColouredNoise, preset, **options)
        for name, (preset, options) in NOISES.items()
    },
}
# Enough of them that the rms of the errors is known to a tenth.
MORE_DRAWS = {name: 5 for name in (*WANDERING, *SETTLING)}
EXPECTED = [
    *(Row(name, VALUE, COVERED_AND_NARROW) for name in (*WANDERING, *SETTLING)),
    *(Row(name, VALUE, COVERED) for name in STEPPING),
    *(Row(name, VALUE, wanted) for name, (_, wanted) in CHANGING.items()),
    *(
        Row(name, VALUE, COVERED_OR_FLAGGED)
        for name in (*SLEWS, *KNOCKS, *TWO_KNOCKS, *NOISES)
    ),
    *(Row(name, VALUE, wanted) for name, (*_, wanted) in OF_METHODS.items()),
]
