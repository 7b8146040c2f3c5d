#!/usr/bin/env python3
"""dyncal.fit_sine beside numpy.linalg.lstsq on the same data, in a Python that has the wheel:

    python_speed.py [--seconds 0.5]

Prints the quickest of many runs, beside what is demanded: a call below 5 us, 40 times numpy at 1e5
samples. Run it alone; numpy is held to one thread, as ours is. Asserts only that both agree.
"""

import argparse
import os
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
import numpy as np  # noqa: E402

import dyncal  # noqa: E402

FREQUENCY = "80.02"
EPOCH = 1_700_000_000_123_456_789


def best_of(work, seconds, calls=1):
    """Seconds a call."""
    best, end, runs = float("inf"), time.monotonic() + seconds, 0
    while runs < 3 or time.monotonic() < end:
        begin = time.perf_counter_ns()
        for _ in range(calls):
            work()
        best = min(best, (time.perf_counter_ns() - begin) / calls * 1e-9)
        runs += 1
    return best


def series(samples):
    rng = np.random.default_rng(1)
    t = EPOCH + np.arange(samples, dtype=np.int64) * 996_960 + rng.integers(-60, 61, samples)
    x = 2 * np.pi * float(FREQUENCY) * ((t - t[0]) * 1e-9)
    return t, np.sin(x + 1) + 0.1 + 1e-3 * rng.standard_normal(samples)


def numpy_lstsq(t, y):
    x = 2 * np.pi * float(FREQUENCY) * ((t - t[0]) * 1e-9)
    design = np.column_stack((np.sin(x), np.cos(x), np.ones_like(x)))
    return np.linalg.lstsq(design, y, rcond=None)[0]


def stated(name, value, demand, met):
    print(f"  {name:44s} {value:>10s}  demanded {demand:10s} {'met' if met else 'NOT met'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=0.5, help="for each figure")
    seconds = parser.parse_args().seconds
    print(f"numpy {np.__version__}, load {os.getloadavg()[0]:.1f}")
    for samples in (16, 1000, 100_000):
        t, y = series(samples)
        frequency = dyncal.Frequency(FREQUENCY)
        fit = dyncal.fit_sine(frequency, t, y)
        theirs = numpy_lstsq(t, y)
        assert np.abs(np.array([fit.sine, fit.cosine, fit.offset]) - theirs).max() < 1e-8
        ours_s = best_of(lambda: dyncal.fit_sine(frequency, t, y), seconds, 20)
        numpy_s = best_of(lambda: numpy_lstsq(t, y), seconds)
        ratio = numpy_s / ours_s
        print(f"{samples} samples: {ours_s * 1e6:.2f} us, numpy {numpy_s * 1e6:.0f} us")
        if samples == 16:
            stated("a call", f"{ours_s * 1e6:.2f} us", "< 5 us", ours_s < 5e-6)
        if samples == 100_000:
            stated("numpy lstsq against ours", f"{ratio:.0f} x", ">= 40 x", ratio >= 40)


if __name__ == "__main__":
    main()
