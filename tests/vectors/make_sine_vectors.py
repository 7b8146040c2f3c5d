#!/usr/bin/env python3
"""Exact least-squares answers for sine approximation, with 60 digits: writes sine_vectors.json
beside this file.

    /usr/bin/python3 make_sine_vectors.py        (Debian package python3-mpmath; takes about two
    minutes)

The series themselves are not stored: their recipe is in the JSON file and both this script and
sine_vectors_test.cpp make them from it. Stamps come from integers only; a value is rounded to a
multiple of its quantum (a power of two, or 1 for a sensor that delivers LSB), so that both get the
same doubles. Model, sign and units are those of analysis/sine/sine_fit.hpp:

    y = A sin(w (t - t_ref)) + B cos(w (t - t_ref)) + C + ...,   theta = atan2(B, A),   times in
    integer nanoseconds.

Four parameters: the shared frequency minimises sum over channels of log(rss), each channel having
noise of its own. Its uncertainties: inverse of the joint information matrix with s_j^2 = rss_j / (n
- 3 - 1/K).
"""

import json
import os

from mpmath import atan2, cos, hypot, matrix, mp, mpf, nint, pi, sin, sqrt, lu_solve, inverse

mp.dps = 60
EPOCH = 1_700_000_000_123_456_789
MASK = (1 << 64) - 1


def splitmix64(x):
    x = (x + 0x9E3779B97F4A7C15) & MASK
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & MASK
    return x ^ (x >> 31)


def uniform(seed, index):
    """In [-1, 1), exactly representable."""
    return mpf((splitmix64(seed * 1_000_003 + index) >> 11)) / mpf(2) ** 52 - 1


def stamps_of(r):
    stamps = []
    for i in range(r["samples"]):
        shift = (
            splitmix64(r["seed"] * 1_000_003 + i) % (2 * r["jitter_ns"] + 1) - r["jitter_ns"]
            if r["jitter_ns"]
            else 0
        )
        gap = r.get("gap_ns", 0) if i >= r["samples"] // 3 else 0
        stamps.append(r["first_ns"] + i * r["interval_ns"] + shift + gap)
    return stamps


def turns(f, dt):
    return 2 * pi * mpf(f) * dt / 10**9


def series_of(r, c, stamps):
    """c: amplitude, phase_rad at t_ref, offset, noise, quantum, and optionally lines [[f, a,
    phase]], drift_per_s."""
    f = mpf(r["frequency_hz"])
    q = mpf(c["quantum"])
    middle = (stamps[0] + stamps[-1]) // 2
    out = []
    for i, t in enumerate(stamps):
        y = mpf(c["offset"]) + mpf(c["amplitude"]) * sin(
            turns(f, t - r["t_ref_ns"]) + mpf(c["phase_rad"])
        )
        for line, a, phase in c.get("lines", []):
            y += mpf(a) * sin(turns(line, t - r["t_ref_ns"]) + mpf(phase))
        for k, d in enumerate(c.get("drift_per_s", []), 1):
            y += mpf(d) * (mpf(t - middle) / 10**9) ** k
        y += mpf(c["noise"]) * uniform(c["seed"], i)
        out.append(nint(y / q) * q)
    return out


def columns(f, r, stamps):
    """Basis: sine, cosine, constant, then drift powers of u in [-1, 1], harmonics, further
    lines."""
    middle = (stamps[0] + stamps[-1]) // 2
    half = mpf(stamps[-1] - stamps[0]) / 2
    rows = []
    basis = r.get("basis", {})
    for t in stamps:
        x = turns(f, t - r["t_ref_ns"])
        row = [sin(x), cos(x), mpf(1)]
        row += [(mpf(t - middle) / half) ** k for k in range(1, basis.get("drift_order", 0) + 1)]
        for h in range(2, basis.get("highest_harmonic", 1) + 1):
            row += [sin(h * x), cos(h * x)]
        for line in basis.get("lines_hz", []):
            z = turns(line, t - r["t_ref_ns"])
            row += [sin(z), cos(z)]
        rows.append(row)
    return rows


def gram(rows):
    p = len(rows[0])
    g = matrix(p, p)
    for i in range(p):
        for j in range(i, p):
            g[i, j] = g[j, i] = sum(row[i] * row[j] for row in rows)
    return g


def linear_fit(rows, y, g):
    p = len(rows[0])
    z = matrix(p, 1)
    for i in range(p):
        z[i] = sum(row[i] * v for row, v in zip(rows, y))
    x = lu_solve(g, z)
    rss = sum((v - sum(x[i] * row[i] for i in range(p))) ** 2 for row, v in zip(rows, y))
    return x, rss


def number(x):
    return mp.nstr(x, 25)


def report(x, rss, v, dof):
    """v: covariance of (A, B, C)."""
    a, b = x[0], x[1]
    size = hypot(a, b)
    return {
        "A_sin": number(a),
        "B_cos": number(b),
        "C": number(x[2]),
        "amplitude": number(size),
        "theta_rad": number(atan2(b, a)),
        "rss": number(rss),
        "dof": number(dof),
        "u_amplitude": number(sqrt(a * a * v[0, 0] + 2 * a * b * v[0, 1] + b * b * v[1, 1]) / size),
        "u_theta": number(sqrt(b * b * v[0, 0] - 2 * a * b * v[0, 1] + a * a * v[1, 1]) / size**2),
        "u_C": number(sqrt(v[2, 2])),
    }


def three(r):
    stamps = stamps_of(r)
    rows = columns(r["frequency_hz"], r, stamps)
    g = gram(rows)
    inv = inverse(g)
    answers = []
    for c in r["channels"]:
        x, rss = linear_fit(rows, series_of(r, c, stamps), g)
        dof = len(stamps) - len(rows[0])
        answers.append(report(x, rss, inv * (rss / dof), mpf(dof)))
    return {"channels": answers}


def four(r):
    stamps = stamps_of(r)
    ys = [series_of(r, c, stamps) for c in r["channels"]]
    n, count = len(stamps), len(ys)
    f = mpf(r["frequency_hz"])
    tau = [mpf(t - r["t_ref_ns"]) / 10**9 for t in stamps]
    dof = mpf(n) - 3 - mpf(1) / count
    for _ in range(60):
        rows = columns(f, r, stamps)
        g = gram(rows)
        inv = inverse(g)
        gradient = information = mpf(0)
        fits, cross = [], []
        for y in ys:
            x, rss = linear_fit(rows, y, g)
            d = [t * (x[0] * row[1] - x[1] * row[0]) for t, row in zip(tau, rows)]
            dq = matrix([sum(q * row[i] for q, row in zip(d, rows)) for i in range(3)])
            e = [v - sum(x[i] * row[i] for i in range(3)) for v, row in zip(y, rows)]
            s2 = rss / dof
            gradient += sum(q * v for q, v in zip(d, e)) / s2
            information += (sum(q * q for q in d) - (dq.T * inv * dq)[0]) / s2
            fits.append((x, rss, s2))
            cross.append(inv * dq)
        step = gradient / information
        f += step / (2 * pi)
        if abs(step) * tau_span(stamps) < mpf(10) ** -30:
            break
    else:
        raise RuntimeError("did not settle")
    answers = []
    for (x, rss, s2), k in zip(fits, cross):
        v = inv * s2
        for i in range(3):
            for j in range(3):
                v[i, j] += k[i] * k[j] / information
        answers.append(report(x, rss, v, dof))
    return {
        "frequency_hz": number(f),
        "u_frequency_hz": number(sqrt(1 / information) / (2 * pi)),
        "channels": answers,
    }


def tau_span(stamps):
    return mpf(stamps[-1] - stamps[0]) / 10**9


def channel(
    seed,
    amplitude="1.25",
    phase="0.7",
    offset="0.1",
    noise="0.001",
    quantum="5.9604644775390625e-08",
    **more,
):
    return {
        "amplitude": amplitude,
        "phase_rad": phase,
        "offset": offset,
        "noise": noise,
        "quantum": quantum,
        "seed": seed,
        **more,
    }


def record(frequency, samples, interval, jitter, seed, channels, **more):
    return {
        "frequency_hz": frequency,
        "t_ref_ns": EPOCH,
        "first_ns": EPOCH,
        "samples": samples,
        "interval_ns": interval,
        "jitter_ns": jitter,
        "seed": seed,
        "channels": channels,
        **more,
    }


LSB = [
    channel(31, "8192.4", "0.35", "-120.25", "130", "1"),
    channel(32, "161.7", "-2.9", "16384.5", "130", "1"),
    channel(33, "95.3", "1.8", "33.125", "131", "1"),
]

CASES = {
    "six_hours": ("three", record("199.87", 4000, 5_400_000_000, 2_600_000_000, 1, [channel(11)])),
    "six_hours_reference_elsewhere": (
        "three",
        record(
            "46.7",
            2000,
            10_800_000_000,
            5_200_000_000,
            2,
            [channel(12)],
            t_ref_ns=EPOCH + 3_600_000_000_123,
        ),
    ),
    "three_axes_in_lsb": ("three", record("80", 3000, 996_960, 60, 3, LSB)),
    "drift": (
        "three",
        record(
            "16",
            2000,
            996_960,
            40,
            4,
            [channel(14, drift_per_s=["0.05", "-0.02"])],
            basis={"drift_order": 2},
        ),
    ),
    "harmonics_and_hum": (
        "three",
        record(
            "46.7",
            2500,
            996_960,
            40,
            5,
            [
                channel(
                    15,
                    lines=[["93.4", "0.02", "0.4"], ["140.1", "0.01", "-1"], ["50", "0.006", "2"]],
                )
            ],
            basis={"highest_harmonic": 3, "lines_hz": ["50"]},
        ),
    ),
    "third_of_a_cycle": ("three", record("0.5", 660, 1_000_000, 90_000, 6, [channel(16)])),
    "gap": ("three", record("80", 1500, 1_000_000, 5_000, 7, [channel(17)], gap_ns=3_700_000_000)),
    "four_300_ppm": (
        "four",
        record(
            "80.024", 4000, 4_900_000, 900_000, 8, [channel(18)], start_hz="80", search_rel=1e-3
        ),
    ),
    "four_3040_ppm": (
        "four",
        record(
            "80.2432", 4000, 4_900_000, 900_000, 9, [channel(19)], start_hz="80", search_rel=5e-3
        ),
    ),
    "four_below_two_cycles": (
        "four",
        record(
            "1.6",
            800,
            1_000_000,
            90_000,
            10,
            [channel(20, noise="0.0002")],
            start_hz="1.7",
            search_rel=0.2,
        ),
    ),
    "four_shared_by_axes": (
        "four",
        record("80.01", 2500, 996_960, 60, 11, LSB, start_hz="80", search_rel=1e-3),
    ),
    "four_with_gap": (
        "four",
        record(
            "80.1",
            2400,
            1_000_000,
            50_000,
            12,
            [channel(21, noise="0.05")],
            gap_ns=5_000_000_000,
            start_hz="80",
            search_rel=3e-3,
        ),
    ),
    "four_reference_far_away": (
        "four",
        record(
            "12.501",
            2000,
            5_000_000,
            100_000,
            13,
            [channel(22)],
            start_hz="12.5",
            search_rel=1e-3,
            t_ref_ns=EPOCH - 7_200_000_000_321,
        ),
    ),
}


def main():
    result = {}
    for name, (kind, recipe) in CASES.items():
        answer = three(recipe) if kind == "three" else four(recipe)
        result[name] = {"kind": kind, "recipe": recipe, "answer": answer}
        print(name, answer["channels"][0]["amplitude"], flush=True)
    with open(
        os.path.join(os.path.dirname(os.path.abspath(__file__)), "sine_vectors.json"), "w"
    ) as file:
        json.dump(result, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main()
