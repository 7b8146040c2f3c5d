#!/usr/bin/env python3
"""Sine approximation in C++, numpy and scipy: the same data, the same process, the quickest of many
runs. Other work on the machine lengthens the slow forms more than ours: run it alone (the load
average is printed).

    sine_against_python.py BUILD/lib/libsine_shared.so [--samples 100000] [--noise 1e-3] [--json
    FILE]

Prints nanoseconds per sample (all channels together) and how many times longer each form takes than
ours:

  numpy normal equations   sin, cos, D'D and D'y in one go: the fastest form numpy has
  numpy lstsq              numpy.linalg.lstsq on [sin, cos, 1], all channels at once
  scipy lstsq a channel    scipy.linalg.lstsq for every channel, as laboratory scripts do
  scipy curve_fit          four parameters, start value from ours, analytic Jacobian

and, beside the demand, how many times longer the fit takes than reading the samples takes (in the
caches, and out of them as after a network or a file). Also checks that all agree. Needs
python3-numpy and python3-scipy; says so and leaves with status 77 without them. BLAS and the like
are held to one thread: ours uses one.
"""

import argparse
import ctypes
import json
import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
try:
    import numpy as np
    import scipy
    import scipy.linalg
    import scipy.optimize
except ImportError as missing:
    print(f"SKIPPED: {missing}; install python3-numpy and python3-scipy", file=sys.stderr)
    sys.exit(77)

EPOCH = 1_700_000_000_123_456_789


def best_of(work, seconds=1.5, least=3, before=lambda: None):
    best, runs, end = float("inf"), 0, time.monotonic() + seconds
    while runs < least or time.monotonic() < end:
        before()
        begin = time.perf_counter_ns()
        result = work()
        best = min(best, time.perf_counter_ns() - begin)
        runs += 1
    return best, result


class Ours:
    def __init__(self, path):
        self.library = ctypes.CDLL(path)
        self.library.dyncal_fit.argtypes = (
            [ctypes.c_double, ctypes.c_int64]
            + [ctypes.c_void_p] * 2
            + [ctypes.c_int64] * 2
            + [ctypes.c_void_p]
        )
        self.library.dyncal_fit_frequency.argtypes = (
            [ctypes.c_double] * 2
            + [ctypes.c_int64]
            + [ctypes.c_void_p] * 2
            + [ctypes.c_int64] * 2
            + [ctypes.c_void_p]
        )
        self.library.dyncal_read.argtypes = [ctypes.c_void_p] * 2 + [ctypes.c_int64] * 2
        self.library.dyncal_read.restype = ctypes.c_double
        self.library.dyncal_flush.argtypes = [ctypes.c_void_p, ctypes.c_int64]

    def flush(self, *arrays):
        for one in arrays:
            self.library.dyncal_flush(one.ctypes.data, one.nbytes)

    # What calls the fit: made once for the same arrays, so that little of Python is in the time of
    # one fit.

    def read(self, t, y):
        read, arguments = self.library.dyncal_read, (
            t.ctypes.data,
            y.ctypes.data,
            t.size,
            y.shape[0],
        )
        return lambda: read(*arguments)

    def three(self, f, t, y):
        out = np.empty((y.shape[0], 4))
        fit, arguments = self.library.dyncal_fit, (
            f,
            int(t[0]),
            t.ctypes.data,
            y.ctypes.data,
            t.size,
            y.shape[0],
            out.ctypes.data,
        )

        def call():
            if fit(*arguments):
                raise RuntimeError("the fit failed")
            return out[:, :3]

        return call

    def four(self, f, t, y):
        out = np.empty(1 + 4 * y.shape[0])
        fit = self.library.dyncal_fit_frequency
        arguments = (
            f,
            1e-3,
            int(t[0]),
            t.ctypes.data,
            y.ctypes.data,
            t.size,
            y.shape[0],
            out.ctypes.data,
        )

        def call():
            if fit(*arguments):
                raise RuntimeError("the fit failed")
            return out[0], out[1:].reshape(-1, 4)[:, :3]

        return call


def design(f, t):
    x = 2 * np.pi * f * ((t - t[0]) * 1e-9)
    return np.sin(x), np.cos(x)


def normal_equations(f, t, y):
    s, c = design(f, t)
    d = np.empty((3, t.size))
    d[0], d[1], d[2] = s, c, 1.0
    p = np.linalg.solve(d @ d.T, d @ y.T)
    rss = ((y - p.T @ d) ** 2).sum(axis=1)
    return p.T, rss


def normal_sums(f, t, y):
    """Without a design matrix: dot products only, residual sum of squares from the sums."""
    s, c = design(f, t)
    n = t.size
    ss, sc, s1, c1 = s @ s, s @ c, s.sum(), c.sum()
    g = np.array([[ss, sc, s1], [sc, n - ss, c1], [s1, c1, n]])
    z = np.array([y @ s, y @ c, y.sum(axis=1)])
    p = np.linalg.solve(g, z)
    return p.T, np.einsum("ij,ij->i", y, y) - (p * z).sum(axis=0)


def numpy_lstsq(f, t, y):
    s, c = design(f, t)
    return np.linalg.lstsq(np.column_stack((s, c, np.ones_like(s))), y.T, rcond=None)[0].T


def scipy_each(f, t, y):
    s, c = design(f, t)
    d = np.column_stack((s, c, np.ones_like(s)))
    return np.array([scipy.linalg.lstsq(d, one)[0] for one in y])


def curve_fit(f, t, y, start):
    x = (t - t[0]) * 1e-9

    def model(u, a, b, c, w):
        return a * np.sin(w * u) + b * np.cos(w * u) + c

    def jacobian(u, a, b, c, w):
        s, k = np.sin(w * u), np.cos(w * u)
        return np.column_stack((s, k, np.ones_like(u), u * (a * k - b * s)))

    return [
        scipy.optimize.curve_fit(model, x, one, p0=[*p, 2 * np.pi * f], jac=jacobian)[0]
        for one, p in zip(y, start)
    ]


def series(samples, channels, noise):
    rng = np.random.default_rng(1)
    f = 80.02
    t = EPOCH + np.arange(samples, dtype=np.int64) * 996_960 + rng.integers(-60, 61, samples)
    x = 2 * np.pi * f * ((t - t[0]) * 1e-9)
    return (
        f,
        t,
        np.array(
            [np.sin(x + j) + 0.1 + noise * rng.standard_normal(samples) for j in range(channels)]
        ),
    )


def compare(ours, samples, channels, noise):
    f, t, y = series(samples, channels, noise)
    # The start of the iteration is 0.3 of a bin away: curve_fit would not arrive from further.
    near = f + 0.3 / ((t[-1] - t[0]) * 1e-9)
    rows = {}
    rows["ours, three parameters"], p = best_of(ours.three(f, t, y))
    for name, work in (("numpy normal equations", normal_equations), ("numpy sums", normal_sums)):
        rows[name], (q, _) = best_of(lambda: work(f, t, y))
        assert np.abs(p - q).max() < 1e-8, name
    rows["numpy lstsq"], q = best_of(lambda: numpy_lstsq(f, t, y))
    assert np.abs(p - q).max() < 1e-8
    rows["scipy lstsq a channel"], q = best_of(lambda: scipy_each(f, t, y))
    assert np.abs(p - q).max() < 1e-8
    rows["reading only"], _ = best_of(ours.read(t, y), seconds=0.5)
    flush = lambda: ours.flush(t, y)
    rows["reading only, not cached"], _ = best_of(
        ours.read(t, y), seconds=0.5, least=20, before=flush
    )
    rows["ours, not cached"], _ = best_of(ours.three(f, t, y), seconds=0.5, least=20, before=flush)
    rows["ours, four parameters"], (found, p4) = best_of(ours.four(near, t, y))
    start = ours.three(near, t, y)()
    rows["scipy curve_fit"], q = best_of(lambda: curve_fit(near, t, y, start), seconds=0.5, least=2)
    assert (
        abs(q[0][3] / (2 * np.pi) - found) < 5 * noise / samples**0.5
    ), "curve_fit found another frequency"
    return {name: value / samples for name, value in rows.items()}


def demands(rows):
    """What is wanted of 4 channels with 1e5 samples, and what is there."""
    three, four = rows["ours, three parameters"], rows["ours, four parameters"]
    best = min(rows["numpy normal equations"], rows["numpy sums"])
    lines = [
        (
            "three parameters against reading, not cached",
            rows["ours, not cached"] / rows["reading only, not cached"],
            "<=",
            1.3,
        ),
        (
            "three parameters against reading, in the caches",
            three / rows["reading only"],
            "<=",
            1.3,
        ),
        ("best numpy form against three parameters", best / three, ">=", 10),
        ("numpy lstsq against three parameters", rows["numpy lstsq"] / three, ">=", 40),
        ("four parameters against three", four / three, "<=", 3),
        ("scipy curve_fit against four parameters", rows["scipy curve_fit"] / four, ">=", 40),
    ]
    for name, value, sign, demand in lines:
        met = value >= demand if sign == ">=" else value <= demand
        print(
            f"  {name:48s} {value:8.2f}  demanded {sign} {demand:<4g} {'met' if met else 'NOT met'}"
        )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("library")
    parser.add_argument(
        "--samples", type=int, nargs="+", default=[1000, 10_000, 100_000, 1_000_000]
    )
    parser.add_argument("--channels", type=int, nargs="+", default=[1, 4])
    parser.add_argument("--noise", type=float, default=1e-3)
    parser.add_argument("--json")
    arguments = parser.parse_args()
    ours = Ours(arguments.library)
    print(
        f"numpy {np.__version__}, scipy {scipy.__version__}, one thread, "
        f"ns per sample and times ours, load {os.getloadavg()[0]:.1f}"
    )
    table = []
    for samples in arguments.samples:
        for channels in arguments.channels:
            rows = compare(ours, samples, channels, arguments.noise)
            three, four = rows["ours, three parameters"], rows["ours, four parameters"]
            print(f"\n{samples} samples, {channels} channel(s)")
            for name, value in rows.items():
                own = four if "curve_fit" in name or "four" in name else three
                print(f"  {name:26s} {value:9.2f} ns  {value / own:7.1f} x")
            print(f"  four parameters against three: {four / three:.2f} x")
            if samples == 100_000 and channels == 4:
                print("  demands")
                demands(rows)
            table.append({"samples": samples, "channels": channels, "ns_per_sample": rows})
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(table, file, indent=1)


if __name__ == "__main__":
    main()
