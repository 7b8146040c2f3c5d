"""Stamps that scatter, and values that are not of the instants of their stamps."""

import functools

import numpy as np

from class_presets import LITTLE_NOISE, bench
from expected_row import MAGNITUDE, VALUE, Row
from faults.fault import Fault


class ScatteringStamps(Fault):
    """Stamps of whole ticks, with normal or one-sided errors. What is constant of them, no data
    show: the mean is taken out."""

    def __init__(self, calibration, rng, tick_s=0.0, normal_s=0.0, exponential_s=0.0):
        super().__init__(calibration, rng)
        self.tick_s, self.normal_s, self.exponential_s = tick_s, normal_s, exponential_s

    def dau_record(self, times_s, columns):
        stamps = columns["t_ns"]
        late_s = self.normal_s * self.rng.standard_normal(stamps.size)
        late_s += self.exponential_s * (self.rng.exponential(size=stamps.size) - 1.0)
        seen_ns = (stamps - stamps[0]) + 1e9 * late_s
        if self.tick_s:
            tick_ns, beside = 1e9 * self.tick_s, self.rng.uniform(-0.5, 0.5)
            seen_ns = (np.round(seen_ns / tick_ns + beside) - beside) * tick_ns
        rising = np.maximum.accumulate(np.round(seen_ns).astype(np.int64))
        # Two of one tick: a reader of stamps gives the second one the next nanosecond.
        for place in np.flatnonzero(np.diff(rising) <= 0):
            rising[place + 1] = max(rising[place + 1], rising[place] + 1)
        return {**columns, "t_ns": rising + stamps[0]}


class MisplacedValues(Fault):
    """`held` of the values are those before them; `exchanged` change places with the next; read
    from a buffer of `batch` samples, stamps are those of the reading, 10 ns apart."""

    def __init__(self, calibration, rng, held=0.0, exchanged=0.0, batch=0):
        super().__init__(calibration, rng)
        self.held, self.exchanged, self.batch = held, exchanged, batch

    def dau_record(self, times_s, columns):
        values, stamps = columns["dos"].copy(), columns["t_ns"].copy()
        if self.held:
            late = np.flatnonzero(self.rng.random(values.size - 1) < self.held) + 1
            values[late] = columns["dos"][late - 1]
        if self.exchanged:
            first = np.flatnonzero(self.rng.random(values.size // 2) < 2.0 * self.exchanged) * 2
            first = first[first + 1 < values.size]
            values[first], values[first + 1] = columns["dos"][first + 1], columns["dos"][first]
        if self.batch:
            number = np.arange(values.size)
            read = np.minimum(number - number % self.batch + self.batch - 1, values.size - 1)
            stamps = stamps[read] + 10 * (number % self.batch)
        return {**columns, "dos": values, "t_ns": stamps}


def scattering(**how):
    return functools.partial(ScatteringStamps, **how)


def misplaced(**how):
    return functools.partial(MisplacedValues, **how)


ABOVE_AN_EIGHTH = {"frequencies": ("90", "100.3", "128", "160", "200", "240")}
BELOW_AN_EIGHTH = {"frequencies": ("12.5", "20", "31.5", "40", "63", "80")}
# Rates at which the errors of the stamps, a saw-tooth of 21 Hz, have their third harmonic at twice
# 31.5 Hz, and the other steps do not show it.
BESIDE_31_HZ = ("12.5", "20", "31.5", "44.7", "80", "100.3")
RATES_IN_STEP = {100: 1002.1, 200: 1004.2, 500: 1010.5}
STAMPED_WELL = {"method": "absolute-time", "u_stamp_s": 2e-6}
OWN_CLOCK = {"own_clock": True, "u_stamp_s": 2e-6}
MODES = {"": {}, ", absolute time": STAMPED_WELL, ", own clock": OWN_CLOCK}
AT_80_HZ = {"frequencies": ("31.5", "40", "63", "80", "100.3", "125")}

CLASSES = {
    "tick of 100 us": bench(LITTLE_NOISE, fault=scattering(tick_s=1e-4)),
    "tick of 500 us": bench(LITTLE_NOISE, AT_80_HZ, repetitions=3, fault=scattering(tick_s=5e-4)),
    "tick of 1 ms": bench(LITTLE_NOISE, AT_80_HZ, fault=scattering(tick_s=1e-3)),
    "stamps scatter by 20 us": bench(LITTLE_NOISE, fault=scattering(normal_s=2e-5)),
    "stamps scatter by 100 us": bench(
        LITTLE_NOISE, repetitions=3, fault=scattering(normal_s=1e-4)
    ),
    "stamps scatter by 300 us": bench(LITTLE_NOISE, fault=scattering(normal_s=3e-4)),
    "one-sided latencies of 100 us": bench(LITTLE_NOISE, fault=scattering(exponential_s=1e-4)),
    **{
        f"ticks of {us} us in step{how}": bench(
            LITTLE_NOISE,
            mode,
            frequencies=BESIDE_31_HZ,
            sensor_rate_hz=rate_hz,
            sensor_rate_scatter_rel=1e-5,
            fault=scattering(tick_s=1e-6 * us),
        )
        for us, rate_hz in RATES_IN_STEP.items()
        for how, mode in MODES.items()
    },
    **{
        f"ticks of {us} us, any rate{how}": bench(
            LITTLE_NOISE, mode, sensor_rate_scatter_rel=3e-3, fault=scattering(tick_s=1e-6 * us)
        )
        for us in RATES_IN_STEP
        for how, mode in MODES.items()
    },
    "ticks of 250 us, a saw-tooth of seconds": bench(
        LITTLE_NOISE,
        STAMPED_WELL,
        sensor_rate_hz=1000.12,
        sensor_rate_scatter_rel=2e-5,
        fault=scattering(tick_s=2.5e-4),
    ),
    "1 % of the values held": bench(fault=misplaced(held=0.01)),
    "10 % of the values held": bench(fault=misplaced(held=0.1)),
    "0.2 % of the values exchanged": bench(BELOW_AN_EIGHTH, fault=misplaced(exchanged=0.002)),
    "1 % of the values exchanged": bench(BELOW_AN_EIGHTH, fault=misplaced(exchanged=0.01)),
    "10 % of the values exchanged": bench(BELOW_AN_EIGHTH, fault=misplaced(exchanged=0.1)),
    **{
        f"above rate / 8, {100 * part:g} % of the values exchanged": bench(
            ABOVE_AN_EIGHTH, fault=misplaced(exchanged=part)
        )
        for part in (0.002, 0.01, 0.1)
    },
    "buffer of 4 read": bench(fault=misplaced(batch=4)),
    "buffer of 8 read": bench(fault=misplaced(batch=8)),
    # The opposite.
    "clean, stamps scatter by 10 us at absolute time": bench(
        method="absolute-time",
        frequencies=("10", "12.5", "16", "20", "25", "31.5"),
        fault=scattering(normal_s=1e-5),
    ),
    "clean, coarse steps at low frequencies": bench(
        resolution_rel=0.02, frequencies=("4", "5", "6.3", "8", "10", "12.5"), duration_s=3.0
    ),
}

# Few are without a flag, and u differs much with the rate.
MORE_DRAWS = {"ticks of 500 us, any rate": 3}

EXPECTED = [
    *(
        Row(name, MAGNITUDE, "covered or flagged")
        for name in (
            "tick of 100 us",
            "tick of 500 us",
            "tick of 1 ms",
            "stamps scatter by 20 us",
            "stamps scatter by 100 us",
            "stamps scatter by 300 us",
            "one-sided latencies of 100 us",
        )
    ),
    *(
        Row(f"ticks of {us} us{which}{how}", VALUE, "covered or flagged")
        for us in RATES_IN_STEP
        for which in (" in step", ", any rate")
        for how in MODES
    ),
    Row("ticks of 250 us, a saw-tooth of seconds", VALUE, "covered or flagged"),
    *(
        Row(name, VALUE, "covered or flagged")
        for name in (
            "1 % of the values held",
            "0.2 % of the values exchanged",
            "1 % of the values exchanged",
            "10 % of the values exchanged",
            "above rate / 8, 0.2 % of the values exchanged",
            "above rate / 8, 1 % of the values exchanged",
            "above rate / 8, 10 % of the values exchanged",
        )
    ),
    *(
        Row(name, VALUE, "flagged")
        for name in ("10 % of the values held", "buffer of 4 read", "buffer of 8 read")
    ),
    Row(
        "clean, stamps scatter by 10 us at absolute time", MAGNITUDE, "covered, no more"
    ),
    Row("clean, coarse steps at low frequencies", VALUE, "covered, no flag"),
]
