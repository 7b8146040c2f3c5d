"""What goes wrong with a channel or with its stamps: plain functions on numpy arrays.

Values in the unit of the channel, times in seconds, stamps in int64 nanoseconds. Nothing here
knows what a bench is, and nothing changes its arguments.
"""

import numpy as np


def over_range(values, lowest, highest):
    """What a converter at its end stops makes of a signal that goes beyond them."""
    return np.clip(values, lowest, highest)


def stuck(values, begin, samples):
    """A sensor that repeats sample `begin` for as many samples."""
    held = values.copy()
    held[begin : begin + samples] = values[begin]
    return held


def resolved(values, least_significant_bit):
    """Rounded to whole steps of the converter."""
    return least_significant_bit * np.round(values / least_significant_bit)


def hum(times_s, amplitude, mains_hz, phase_rad):
    return amplitude * np.sin(2.0 * np.pi * mains_hz * times_s + phase_rad)


def slow_drift(times_s, size, rng):
    """Straight and bent in random parts, from end to end as large as `size`."""
    place = 2.0 * (times_s - times_s[0]) / (times_s[-1] - times_s[0]) - 1.0
    bend = rng.uniform(-1.0, 1.0)
    drift = place * rng.choice([-1.0, 1.0]) + bend * place**2
    return size * drift / np.ptp(drift)


def lost_samples(samples, lost_rel, rng):
    """Places of the samples that arrive when single ones and bursts of up to five are lost."""
    kept = np.ones(samples, dtype=bool)
    while samples - np.count_nonzero(kept) < lost_rel * samples:
        begin = rng.integers(1, samples - 6)
        kept[begin : begin + rng.integers(1, 6)] = False
    return np.flatnonzero(kept)


def disordered_stamps(stamps_ns, faults, rng):
    """As many duplicate stamps (half of them) and stamps that lie before the last one."""
    stamps_ns = stamps_ns.copy()
    interval_ns = np.median(np.diff(stamps_ns)).astype(np.int64)
    # Never two faults side by side: each is one sample that a reader can leave out.
    places = rng.choice(np.arange(10, stamps_ns.size - 10, 7), faults, replace=False)
    for number, place in enumerate(places):
        back_ns = 0 if number % 2 == 0 else interval_ns // 3
        stamps_ns[place] = stamps_ns[place - 1] - back_ns
    return stamps_ns


def not_measured(values, missing_rel, rng):
    """Some values are NaN."""
    return np.where(rng.random(values.size) < missing_rel, np.nan, values)
