#!/usr/bin/env python3
"""Do the parameters of `dyncal model` lie within their U? Calibrations of a sensor of second order
with delay through `dyncal analyse` and `dyncal model`.

    model_coverage.py DYNCAL [--draws N]

Drawn anew in every calibration: gain and phase of the reference, delay of the sync ADC, noise, and
scatter from repetition to repetition. Exit status 1: outside the binomial bounds; 77: numpy is not
installed.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np

    from bench_files import write_record
except ImportError:
    print("MODELS WERE NOT DRAWN: numpy is not installed")
    sys.exit(77)

FREQUENCIES_HZ = [10, 16, 25, 40, 63, 80, 100, 125, 160, 200, 250]
TRUTH = {"gain": 1.02, "delay_s": 0.9e-3, "resonance_hz": 320.0, "damping": 0.75}
REPETITIONS = 3
STEP_S, EXCITED_S = 1.2, 1.0
U_REFERENCE, U_ADC_DELAY_S, SCATTER = 5e-4, 1e-6, 2e-4
START_NS = 1_700_000_000_000_000_000
COVERED = 0.9545

BENCH = f"""bench = "model"
[excitation]
frequencies_hz = [{", ".join(f'"{f}"' for f in FREQUENCIES_HZ)}]
level = 10.0
repetitions = {REPETITIONS}
settling_s = 0.1
duration_s = 0.8
[sources.dau]
driver = "file"
path = "dau.npy"
units = {{ acceleration = "m/s^2", sync = "V" }}
[sources.acs]
driver = "file"
path = "acs.npy"
units = {{ reference = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration"]
[uncertainty]
reference_magnitude_rel = {U_REFERENCE}
reference_phase_rad = {U_REFERENCE}
adc_delay_s = {U_ADC_DELAY_S}
acs_delay_s = 1e-9
"""


def sensor(frequency_hz):
    ratio = frequency_hz / TRUTH["resonance_hz"]
    late = np.exp(-2j * np.pi * frequency_hz * TRUTH["delay_s"])
    return TRUTH["gain"] * late / (1 - ratio**2 + 2j * TRUTH["damping"] * ratio)


class Clock:
    """Stamps of one source over the whole plan, and the step of each sample."""

    def __init__(self, rate_hz):
        plan = np.array(FREQUENCIES_HZ * REPETITIONS, dtype=float)
        numbers = np.arange(int(STEP_S * len(plan) * rate_hz))
        self.t_ns = (numbers * round(1e9 / rate_hz)).astype(np.int64)
        self.t_s = self.t_ns * 1e-9
        self.step = np.minimum((self.t_s / STEP_S).astype(int), len(plan) - 1)
        self.frequency_hz = plan[self.step]
        self.excited = self.t_s - self.step * STEP_S <= EXCITED_S

    def sine(self, factor=1.0, delay_s=0.0):
        angle = 2 * np.pi * self.frequency_hz * (self.t_s - delay_s)
        return np.where(self.excited, (factor * np.exp(1j * angle)).imag, 0.0)


def write_calibration(random, folder):
    def noise(size, count):
        return size * random.normal(size=count)

    acs, dau = Clock(4000.0), Clock(1003.0)
    reference = (1 + noise(U_REFERENCE, 1)) * np.exp(1j * noise(U_REFERENCE, 1))
    steps = len(FREQUENCIES_HZ) * REPETITIONS
    scatter = (1 + noise(SCATTER, steps)) * np.exp(1j * noise(SCATTER, steps))
    write_record(
        folder / "acs.npy",
        {
            "t_ns": acs.t_ns + START_NS,
            "reference": 10 * acs.sine(reference) + noise(1e-3, len(acs.t_ns)),
            "sync": acs.sine() + noise(1e-4, len(acs.t_ns)),
        },
    )
    answer = sensor(dau.frequency_hz) * scatter[dau.step]
    late_s = noise(U_ADC_DELAY_S, 1)[0]
    write_record(
        folder / "dau.npy",
        {
            "t_ns": dau.t_ns + START_NS,
            "acceleration": 9.81 + 10 * dau.sine(answer) + noise(0.01, len(dau.t_ns)),
            "sync": dau.sine(delay_s=late_s) + noise(1e-4, len(dau.t_ns)),
        },
    )
    (folder / "bench.toml").write_text(BENCH, "utf-8")


def model_of(dyncal, folder):
    for arguments in (
        ("analyse", "bench.toml", "--output", "result.json"),
        ("model", "result.json", "--output", "model.json"),
    ):
        subprocess.run([dyncal, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return json.loads((folder / "model.json").read_text("utf-8"))["models"][0]


def main(dyncal, draws):
    covered = dict.fromkeys(TRUTH, 0)
    right = fitting = 0
    ratio = 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for seed in range(draws):
            write_calibration(np.random.default_rng([23, seed]), folder)
            model = model_of(dyncal, folder)
            right += model["kind"] == "second_order_with_delay"
            fitting += model["fits"]
            ratio += model["chi_squared"] / model["degrees_of_freedom"] / draws
            for one in model["parameters"]:
                if one["name"] in TRUTH:
                    deviation = abs(one["value"] - TRUTH[one["name"]])
                    covered[one["name"]] += deviation <= one["U"]
    bound = draws * COVERED - 3.3 * (draws * COVERED * (1 - COVERED)) ** 0.5
    print(f"{draws} calibrations: order right {right}, fits {fitting}, chi2 / nu {ratio:.2f}")
    for name, count in covered.items():
        print(f"  {name:<14} {count:>4} within U (at least {bound:.1f} wanted)")
    wanted = 0.9 * draws
    good = min(covered.values()) >= bound and right >= wanted and fitting >= wanted
    return 0 if good else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("dyncal", type=pathlib.Path)
    parser.add_argument("--draws", type=int, default=20)
    options = parser.parse_args()
    sys.exit(main(options.dyncal.resolve(), options.draws))
