#!/usr/bin/env python3
"""Exact results made from several series or phasors, with 60 digits: writes result_vectors.json
beside this file.

    /usr/bin/python3 make_result_vectors.py      (Debian package python3-mpmath; takes about a
    minute)

Series come from recipes as in make_sine_vectors.py; result_vectors_test.cpp makes the same doubles.
Phases lead, H = P_out / P_in.
"""

import json
import os

from mpmath import (
    atan2,
    betainc,
    conj,
    cos,
    expj,
    findroot,
    hypot,
    inf,
    matrix,
    mp,
    mpc,
    mpf,
    pi,
    sqrt,
    inverse,
)

from make_sine_vectors import (
    EPOCH,
    channel,
    columns,
    four,
    gram,
    linear_fit,
    number,
    record,
    series_of,
    splitmix64,
    stamps_of,
    three,
)

mp.dps = 60


def phasor(fit):
    return mpc(mpf(fit["A_sin"]), mpf(fit["B_cos"]))


def turn(z):
    return z / abs(z)


def arg(z):
    return atan2(z.imag, z.real)


def sync_link(r):
    """Eq. (4): four series in two systems, at a known frequency."""
    reference, sync_acs = (phasor(f) for f in three(r["acs"])["channels"])
    sync_dau, dos = (phasor(f) for f in three(r["dau"])["channels"])
    adc = expj(-mpf(r["adc_lag_rad"]))
    late = expj(2 * pi * mpf(r["acs"]["frequency_hz"]) * mpf(r["reference_delay_s"]))
    h = dos / (reference * late) * turn(sync_acs) / turn(sync_dau / adc)
    return {"magnitude": number(abs(h)), "phase_rad": number(arg(h))}


def series_stamping(r):
    """Eqs. (5) to (8): the ACS at the known frequency; each oscilloscope trace at it too; the
    series share their apparent one."""
    f = mpf(r["acs"]["frequency_hz"])
    w = 2 * pi * f
    reference, sync = (phasor(p) for p in three(r["acs"])["channels"])
    series = four(r["series"])
    # Stamps of the series recipe are millionths of a sample interval: its "Hz" are turns in a
    # thousand samples.
    apparent = mpf(series["frequency_hz"]) / 1000 * mpf(r["nominal_rate_hz"])
    answers = []
    for trace, shot in zip(r["traces"], series["channels"]):
        beta = phasor(three(trace)["channels"][0])
        way = expj(-w * mpf(r["dso_delay_s"]))
        answers.append(phasor(shot) / reference * turn(sync) * way / turn(beta))
    length = sum(abs(h) for h in answers) / len(answers)
    direction = sum(turn(h) for h in answers)
    return {
        "shots": [{"magnitude": number(abs(h)), "phase_rad": number(arg(h))} for h in answers],
        "magnitude": number(length),
        "phase_rad": number(arg(direction)),
        "real_rate_hz": number(mpf(r["nominal_rate_hz"]) * f / apparent),
    }


def matrix_response(r):
    """H = P R^-1 for three excitations, u of each real component."""
    z = [
        [[mpc(mpf(x[0]), mpf(x[1])) for x in axes] for axes in r[side]]
        for side in ("reference", "sensor")
    ]
    base, answer = (matrix(3, 3) for _ in range(2))
    for j in range(3):
        for i in range(3):
            base[i, j] = z[0][j][i]
            answer[i, j] = z[1][j][i]
    inv = inverse(base)
    h = answer * inv
    u_r, u_p = mpf(r["u_reference"]), mpf(r["u_sensor"])
    u = [
        [
            sqrt(
                sum(
                    abs(inv[k, j]) ** 2
                    * (u_p**2 + sum(abs(h[i, l]) ** 2 for l in range(3)) * u_r**2)
                    for k in range(3)
                )
            )
            for j in range(3)
        ]
        for i in range(3)
    ]
    return {
        "h": [[[number(h[i, j].real), number(h[i, j].imag)] for j in range(3)] for i in range(3)],
        "u": [[number(u[i][j]) for j in range(3)] for i in range(3)],
    }


def allan(r):
    """Overlapping Allan deviation of stamps."""
    t = stamps_of(r)
    mean = mpf(r["interval_ns"])
    answers = []
    for m in r["factors"]:
        total = sum(mpf(t[i + 2 * m] - 2 * t[i + m] + t[i]) ** 2 for i in range(len(t) - 2 * m))
        answers.append(number(sqrt(total / (2 * (len(t) - 2 * m))) / (m * mean)))
    return {"deviations": answers}


def student_quantile(nu, probability):
    tail = 1 - probability

    def two_sided(t):
        return betainc(nu / 2, mpf(1) / 2, 0, nu / (nu + t * t), regularized=True) - tail

    return findroot(
        two_sided, (mpf(2), mpf(3)), solver="anderson", tol=mpf(10) ** -50, maxsteps=200
    )


def budget(r):
    rows = [(mpf(x["u"]), mpf(x["sensitivity"]), mpf(x["degrees_of_freedom"])) for x in r["inputs"]]
    parts = [c * u for u, c, _ in rows]
    variance = sum(p * p for p in parts)
    for x in r["correlations"]:
        variance += 2 * mpf(x["coefficient"]) * parts[x["first"]] * parts[x["second"]]
    nu = variance**2 / sum(p**4 / d for p, (_, _, d) in zip(parts, rows))
    k = student_quantile(nu, mp.erf(sqrt(mpf(2))))
    u = sqrt(variance)
    return {
        "u": number(u),
        "degrees_of_freedom": number(nu),
        "k": number(k),
        "expanded": number(k * u),
    }


def group_delay(r):
    """psi = psi_0 - w tau by generalised least squares from phases that are wrapped; V with a
    common delay and a common phase."""
    n = len(r["points"])
    w = [2 * pi * mpf(p["frequency_hz"]) for p in r["points"]]
    v = matrix(n, n)
    for i in range(n):
        for j in range(n):
            v[i, j] = mpf(r["u_delay_s"]) ** 2 * w[i] * w[j] + mpf(r["u_phase_rad"]) ** 2
        v[i, i] += mpf(r["points"][i]["u_phase_rad"]) ** 2
    design = matrix(n, 2)
    y = matrix(n, 1)
    for i, p in enumerate(r["points"]):
        design[i, 0], design[i, 1] = mpf(1), -w[i]
        y[i] = mpf(p["phase_rad"]) + 2 * pi * p["turns"]
    inv = inverse(v)
    covariance = inverse(design.T * inv * design)
    x = covariance * (design.T * inv * y)
    e = y - design * x
    return {
        "delay_s": number(x[1]),
        "intercept_rad": number(x[0]),
        "u_delay_s": number(sqrt(covariance[1, 1])),
        "u_intercept_rad": number(sqrt(covariance[0, 0])),
        "chi_squared": number((e.T * inv * e)[0]),
    }


def phase_points():
    """A delay of 8.1 ms seen through the principal value, at the decimal texts a user writes; small
    deviations from the line."""
    points = []
    for i, f in enumerate(
        [
            "10",
            "12.5",
            "16",
            "20",
            "25",
            "31.5",
            "40",
            "46.7",
            "50",
            "53.3",
            "63",
            "80",
            "100",
            "125",
            "160",
            "200",
            "250",
        ]
    ):
        u = mpf("2e-4") * (1 + i % 3)
        off = (mpf(splitmix64(900 + i) >> 11) / mpf(2) ** 52 - 1) * u
        psi = mpf("0.3") - 2 * pi * mpf(f) * mpf("0.0081") + off
        turns = int(mp.nint(psi / (2 * pi)))
        points.append(
            {
                "frequency_hz": f,
                "phase_rad": mp.nstr(psi - 2 * pi * turns, 15),
                "u_phase_rad": mp.nstr(u, 5),
                "turns": turns,
            }
        )
    return points


def trace(seed, phase):
    """A thousand samples around the trigger point; stamps in ns, so that the trigger point is an
    instant between two samples."""
    return record(
        "250",
        1000,
        8_000,
        0,
        seed,
        [channel(seed, "2.5", phase, "0.01", "0.02", "0.00390625")],
        t_ref_ns=0,
        first_ns=-3_996_100,
    )


SYNC_LINK = {
    "acs": record(
        "160",
        3000,
        100_000,
        0,
        41,
        [channel(42, "9.5", "3.1415", "0.02"), channel(43, "9.75", "-3.1414", "-0.01")],
        t_ref_ns=7_000_000,
        first_ns=5_000_000,
    ),
    "dau": record(
        "160",
        2500,
        996_960,
        40,
        44,
        [channel(45, "1.62", "3.14", "1.6"), channel(46, "8.1", "-3.13", "0.3", "0.01")],
        t_ref_ns=EPOCH + 17,
    ),
    "adc_lag_rad": "0.000471",
    "reference_delay_s": "0.0000021",
}

SERIES = {
    "acs": record(
        "250",
        3000,
        50_000,
        0,
        51,
        [channel(52, "10.25", "-2.75", "0.02"), channel(53, "2.5", "1.25", "0")],
        t_ref_ns=0,
        first_ns=0,
    ),
    "traces": [trace(54, "0.013"), trace(55, "-0.009"), trace(56, "0.004")],
    # 1024.5 samples a second: no whole number of nanoseconds between two of them.
    "series": record(
        "243.98243045387994",
        1000,
        1_000_000,
        0,
        57,
        [
            channel(58, "9.8", "2.9", "0.1"),
            channel(59, "9.8", "2.88", "0.1"),
            channel(60, "9.8", "2.893", "0.1"),
        ],
        t_ref_ns=0,
        first_ns=0,
    ),
    "nominal_rate_hz": "1024.5",
    "dso_delay_s": "0.000000236",
}

MATRIX = {
    "reference": [
        [["9.75", "0.5"], ["0.25", "-0.125"], ["-0.0625", "0.03125"]],
        [["0.125", "0.25"], ["-9.5", "2.25"], ["0.5", "0.0625"]],
        [["-0.375", "0.125"], ["0.3125", "0.0625"], ["4.5", "-8.75"]],
    ],
    "sensor": [
        [["9.1", "-2.2"], ["0.31", "0.02"], ["-0.11", "0.07"]],
        [["0.02", "0.33"], ["-9.9", "0.4"], ["0.41", "-0.09"]],
        [["-0.29", "0.21"], ["0.22", "-0.14"], ["2.1", "-9.6"]],
    ],
    "u_reference": "0.003",
    "u_sensor": "0.002",
}

BUDGET = {
    "inputs": [
        {"u": "0.0012", "sensitivity": "1", "degrees_of_freedom": "2"},
        {"u": "0.0035", "sensitivity": "-0.5", "degrees_of_freedom": "17.5"},
        {"u": "0.0009", "sensitivity": "2", "degrees_of_freedom": "inf"},
        {"u": "0.0004", "sensitivity": "1.5", "degrees_of_freedom": "inf"},
    ],
    "correlations": [{"first": 2, "second": 3, "coefficient": "-0.4"}],
}

CASES = {
    "sync_link_at_wrapped_phases": (sync_link, SYNC_LINK),
    "series_of_three_shots": (series_stamping, SERIES),
    "response_of_three_axes": (matrix_response, MATRIX),
    "allan_deviation": (
        allan,
        dict(
            record("0", 6000, 996_960, 5000, 61, []),
            factors=[1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024],
        ),
    ),
    "budget": (budget, BUDGET),
    "group_delay_of_wrapped_phases": (
        group_delay,
        {"points": phase_points(), "u_delay_s": "1e-7", "u_phase_rad": "3e-4"},
    ),
}


def main():
    result = {}
    for name, (evaluate, recipe) in CASES.items():
        result[name] = {"recipe": recipe, "answer": evaluate(recipe)}
        print(name, flush=True)
    with open(
        os.path.join(os.path.dirname(os.path.abspath(__file__)), "result_vectors.json"), "w"
    ) as file:
        json.dump(result, file, indent=1)
        file.write("\n")


if __name__ == "__main__":
    main()
