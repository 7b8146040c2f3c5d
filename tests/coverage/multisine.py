#!/usr/bin/env python3
"""Multi-sines of the virtual bench through `dyncal analyse`, against what the bench says is true:
how large the errors are, and whether their u tells.

    multisine.py PROGRAMS [--runs 20] [--seed 1]

PROGRAMS is the folder of the built programs. Every run is a bench of its own, with 17 lines in 10
s. The error of the reference, which no record shows, is taken from the truth; its u is stated as
1e-6.

Held, from 25 Hz to 250 Hz: the rms of the runs of each line is at most 1.5e-4 and 15 mdeg. At all
lines: each run lies within 4 u, has no flag, and u is not above twice the rms of its line (of 20
runs). Exit status 1 if not.
"""

import argparse
import cmath
import json
import math
import pathlib
import subprocess
import sys
import tempfile

LINES_HZ = (
    "10.1 12.3 16.1 20.3 25.3 31.3 39.7 45.7 49.1 53.3 63.1 80.3 98.7 125.3 159.7 198.3 248.3"
).split()
LARGEST_MAGNITUDE = 1.5e-4
LARGEST_PHASE_RAD = math.radians(15e-3)
JUDGED_FROM_HZ = 25.0

BENCH = f"""bench = "multisine"
[excitation]
kind = "multisine"
frequencies_hz = [{", ".join(f'"{line}"' for line in LINES_HZ)}]
level = 10.0
level_deviation_rel = 0.3
period_s = 10.0
dropped_periods = 0.2
[sources.dau]
driver = "file"
path = "dau.csv"
time_base = "utc"
units = {{ acceleration_z = "m/s^2", sync = "V" }}
[sources.acs]
driver = "file"
path = "acs.csv"
units = {{ reference = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[corrections]
adc = {{ file = "adc.json", channel = "ADC1" }}
[uncertainty]
reference_magnitude_rel = 1e-6
reference_phase_rad = 1e-6
acs_delay_s = 1e-9
"""


def run(folder, *arguments):
    done = subprocess.run(
        [str(argument) for argument in arguments], cwd=folder, capture_output=True, text=True
    )
    if done.returncode != 0:
        sys.exit(f"{arguments[0]}: {done.stdout}{done.stderr}")


def deviations(programs, seed):
    """By line: parts of the magnitude, rad, and both in u; and the flags of all lines."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(
            folder,
            programs / "dyncal-virtual-bench",
            *("--preset", "mpu9250-ptb", "--seed", seed, "--acs-rate", 5000),
            *("--record-csv", ".", "--adc-file", "adc.json", "--truth", "truth.json"),
            *("--frequencies", ",".join(LINES_HZ), "--levels", 10, "--multisine", 10),
            *("--settling", 2, "--duration-per-step", 10),
        )
        (folder / "bench.toml").write_text(BENCH)
        run(folder, programs / "dyncal", "analyse", "bench.toml", "--output", "result.json")
        truth = json.loads((folder / "truth.json").read_text())
        result = json.loads((folder / "result.json").read_text())
    drawn = truth["drawn"]
    reference = cmath.rect(
        1.0 + drawn["reference_gain_error"], drawn["reference_phase_error_rad"]
    )
    true = {
        point["frequency_hz"]: cmath.rect(point["magnitude"], point["phase_rad"]) / reference
        for point in truth["transfer_function"]
        if point["channel"] == "acceleration_z"
    }
    found, flags = {}, []
    for point in result["points"]:
        line = point["frequency_text_hz"]
        if not point["valid"]:
            sys.exit(f"seed {seed}, {line} Hz: {point['problem']}")
        expected = true[point["frequency_hz"]]
        magnitude = point["magnitude"] / abs(expected) - 1.0
        phase = cmath.phase(cmath.rect(1.0, point["phase_rad"]) / expected)
        u_magnitude = point["u_magnitude"] / point["magnitude"]
        found[line] = (magnitude, phase, u_magnitude, point["u_phase_rad"])
        flags += [f"{line} Hz: {flag}" for flag in point["flags"]]
    return found, flags


def rms(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


def judge(line, runs):
    magnitudes, phases, u_magnitudes, u_phases = zip(*runs)
    mdeg = [1e3 * math.degrees(rms(values)) for values in (phases, u_phases)]
    ppm = [1e6 * rms(values) for values in (magnitudes, u_magnitudes)]
    print(
        f"{line:>6} Hz  rms {ppm[0]:6.1f} ppm {mdeg[0]:6.2f} mdeg"
        f"   u {ppm[1]:6.1f} ppm {mdeg[1]:6.2f} mdeg"
    )
    worst = max(
        max(abs(m) / u_m, abs(p) / u_p)
        for m, p, u_m, u_p in zip(magnitudes, phases, u_magnitudes, u_phases)
    )
    problems = [f"{line} Hz: a run is off by {worst:.1f} u"] if worst > 4.0 else []
    if float(line) >= JUDGED_FROM_HZ:
        if rms(magnitudes) > LARGEST_MAGNITUDE or rms(phases) > LARGEST_PHASE_RAD:
            problems.append(f"{line} Hz: the rms is too large")
    if len(runs) >= 20 and rms(u_magnitudes) > 2.0 * rms(magnitudes):
        problems.append(f"{line} Hz: the u of the magnitude is more than twice the rms")
    return problems


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    by_line = {line: [] for line in LINES_HZ}
    problems = []
    for seed in range(options.seed, options.seed + options.runs):
        found, flags = deviations(options.programs.resolve(), seed)
        problems += [f"seed {seed}: {flag}" for flag in flags]
        for line, values in found.items():
            by_line[line].append(values)
    for line, runs in by_line.items():
        problems += judge(line, runs)
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
