#!/usr/bin/env python3
"""Holds a file of `dyncal model` against an independent fit and filter by scipy.

    model_against_scipy.py MODEL.json

The points of the file are fitted again with the covariance that it states, from another start and
with numerical derivatives; the filter is judged by scipy.signal. Exit status 1: they differ; 77:
numpy and scipy are not installed, and nothing was compared.
"""

import json
import pathlib
import sys

try:
    import numpy as np
    from scipy import optimize, signal, stats
except ImportError:
    print("MODELS WERE NOT COMPARED: numpy and scipy are not installed")
    sys.exit(77)

# Of a parameter, in its u; of covariance and chi-squared, relative.
MAX_DEVIATION_U = 1e-3
MAX_DEVIATION_REL = 1e-3


def response(names, values, frequency):
    parameters = dict(zip(names, values))
    ratio = frequency / parameters.get("resonance_hz", np.inf)
    h = parameters["gain"] * np.exp(-2j * np.pi * frequency * parameters.get("delay_s", 0.0))
    h = h / (1 + 1j * frequency / parameters.get("corner_hz", np.inf))
    return h / (1 - ratio**2 + 2j * parameters.get("damping", 0.0) * ratio)


def covariance(points, common):
    def column(key):
        return np.array([point[key] for point in points])

    w = 2 * np.pi * column("frequency_hz")
    ones = np.ones(len(points))
    magnitude = np.diag(column("u_own_magnitude_rel") ** 2)
    magnitude += common["u_gain_rel"] ** 2 * np.outer(ones, ones)
    phase = np.diag(column("u_own_phase_rad") ** 2)
    phase += common["u_phase_rad"] ** 2 * np.outer(ones, ones)
    phase += common["u_delay_s"] ** 2 * np.outer(w, w)
    zero = np.zeros_like(phase)
    return np.block([[magnitude, zero], [zero, phase]])


def check_fit(model):
    points = model["points"]
    names = [parameter["name"] for parameter in model["parameters"]]
    stated = np.array([parameter["value"] for parameter in model["parameters"]])
    stated_u = np.array([parameter["u"] for parameter in model["parameters"]])
    frequency = np.array([point["frequency_hz"] for point in points])
    measured = np.array(
        [point["magnitude"] * np.exp(1j * point["phase_rad"]) for point in points]
    )
    whiten = np.linalg.inv(np.linalg.cholesky(covariance(points, model["common"])))

    def residuals(scaled):
        ratio = np.log(response(names, scaled * stated, frequency) / measured)
        return whiten @ np.concatenate([ratio.real, ratio.imag])

    start = 1 + 0.02 * np.cos(np.arange(len(names)))
    found = optimize.least_squares(
        residuals, start, method="lm", xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    jacobian = optimize.approx_fprime(found.x, residuals, 1e-7)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    yield "parameters", np.max(np.abs(found.x - 1) * np.abs(stated) / stated_u), MAX_DEVIATION_U
    ratio = inverse * np.outer(stated, stated) / np.outer(stated_u, stated_u)
    ours = np.array(model["covariance"]) / np.outer(stated_u, stated_u)
    yield "covariance", np.max(np.abs(ratio - ours)), MAX_DEVIATION_REL
    chi_squared = 2 * found.cost
    yield "chi-squared", abs(chi_squared / model["chi_squared"] - 1), MAX_DEVIATION_REL
    chance = stats.chi2.sf(model["chi_squared"], model["degrees_of_freedom"])
    yield "probability", abs(chance / model["probability"] - 1), 1e-9


def check_filter(model):
    one = model["filter"]
    parameters = model["parameters"]
    names = [parameter["name"] for parameter in parameters]
    values = [parameter["value"] for parameter in parameters]
    frequency = np.linspace(0.0, one["cutoff_hz"], 4001)
    _, c = signal.freqz(one["b"], one["a"], frequency, fs=one["rate_hz"])
    late = np.exp(2j * np.pi * frequency * one["delay_s"])
    ripple = np.max(np.abs(c * response(names, values, frequency) * late - 1))
    yield "ripple", abs(ripple / one["ripple"] - 1), 0.02
    _, impulse = signal.dimpulse((one["b"], one["a"] + [0.0] * (len(one["b"]) - len(one["a"])), 1),
                                 n=4000)
    noise = np.sqrt(np.sum(impulse[0] ** 2)) * abs(values[0])
    yield "noise gain", abs(noise / one["noise_gain"] - 1), 0.01
    covariance_b = np.array(one["Ub"])
    yield "symmetry of Ub", np.max(np.abs(covariance_b - covariance_b.T)), 0.0
    eigenvalues = np.linalg.eigvalsh(covariance_b)
    yield "negative part of Ub", max(0.0, -eigenvalues[0] / eigenvalues[-1]), 1e-12
    # U of the compensated response from Ub alone, in the pass band, where C H is nearly 1.
    for point in one["compensated"]:
        f = point["frequency_hz"]
        if f > one["cutoff_hz"]:
            continue
        k = np.arange(len(one["b"]))
        denominator = np.polyval(one["a"][::-1], np.exp(-2j * np.pi * f / one["rate_hz"]))
        row = np.exp(-2j * np.pi * f * k / one["rate_hz"]) / denominator
        row = row * response(names, values, f) * np.exp(2j * np.pi * f * one["delay_s"])
        u = np.sqrt(row.real @ covariance_b @ row.real)
        yield f"U at {f} Hz", abs(2 * u / point["U_magnitude_error"] - 1), 0.05


def main(path):
    wrong = False
    for model in json.loads(pathlib.Path(path).read_text())["models"]:
        checks = list(check_fit(model))
        if model["filter"]:
            checks += check_filter(model)
        for name, deviation, allowed in checks:
            if not deviation <= allowed:
                wrong = True
                print(f"{model['channel']}: {name} deviates by {deviation:.3g} ({allowed:g})")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
