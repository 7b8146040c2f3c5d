#!/usr/bin/env python3
"""Inputs of public bug reports, one folder a case, each with what is right in expected.txt: values
within U, counted stamps, a refusal that names the true cause.

    public_cases_test.py PROGRAMS SOURCE

The cases lie beside the project, not in it: without them the test is skipped, and says so.
"""

import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

from programs import FOLDER, SOURCE, expect, run

CASES = SOURCE.parent / "shared" / "cases"
DELAY_S = 2e-3  # of the sensor of every played case, whose |H| is 0.98
FREQUENCY_HZ = 80.0


def made(case, folder):
    """The case's inputs, those that its script writes included."""
    if (CASES / case / "make.txt").exists():
        subprocess.run(
            [sys.executable, "-B", CASES / "make_case.py", case, folder / case],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        return folder / case
    return CASES / case


def points_of(case, folder):
    result = folder / f"{case}.json"
    done = run("dyncal", "analyse", made(case, folder) / "bench.toml", "--output", result)
    points = json.loads(result.read_text())["points"] if result.exists() else []
    expect(points, f"{case}: no results: {done.stdout}{done.stderr}")
    return points


def expect_covered(case, point, phase_rad=-2.0 * math.pi * FREQUENCY_HZ * DELAY_S):
    expect(point["valid"], f"{case}, step {point['step']}: {point.get('problem')}")
    magnitude = point["magnitude"] - 0.98
    phase = math.remainder(point["phase_rad"] - phase_rad, 2.0 * math.pi)
    inside = abs(magnitude) <= point["U_magnitude"] and abs(phase) <= point["U_phase_rad"]
    expect(inside, f"{case}, step {point['step']}: {magnitude}, {phase} beyond U")


def check_covered(case, folder, count, flags=(), **truth):
    points = points_of(case, folder)
    expect(len(points) == count, f"{case}: {len(points)} results")
    for point in points:
        expect_covered(case, point, **truth)
    for flag in flags:
        expect(flag in points[0]["flag_names"], f"{case}: no flag {flag}: {points[0]['flags']}")


def check_clock_set_back(folder):
    case = "04-clock-set-back-7h"
    first, second = points_of(case, folder)
    expect_covered(case, first)
    if second["valid"]:
        expect_covered(case, second)
    else:
        named = "time stamps" in second["problem"] and "connected" not in second["problem"]
        expect(named, f"{case}: {second['problem']}")


def check_limits_of_dbc(folder):
    case = "39-dbc-limits"
    for point in points_of(case, folder):
        if point["valid"]:
            expect_covered(case, point)
        else:
            expect("DBC" in point["problem"], f"{case}: {point.get('problem')}")


def check_sentence(case, words, unwanted, *command):
    done = run("dyncal", *command)
    text = done.stdout + done.stderr
    for word in words:
        expect(word in text, f"{case}: '{word}' is not in: {text}")
    for word in unwanted:
        expect(word not in text, f"{case}: {text}")
    return done.returncode


def decoded(file, frames):
    """Value by (frame, signal) of hexadecimal frames "id data", or None if the file is refused."""
    lines = "".join(f"{frame.split()[0]} 0 {frame.split()[1]}\n" for frame in frames)
    done = subprocess.run([FOLDER / "dbc_print", file], input=lines, capture_output=True, text=True)
    if done.returncode == 2:
        return None
    values = {}
    for line in done.stdout.splitlines():
        frame, signal, _, _, bits = line.split()
        values[int(frame), signal] = struct.unpack(">d", bytes.fromhex(bits))[0]
    return values


def check_dbc():
    nodes = decoded(CASES / "35-dbc-nodes-on-lines" / "s.dbc", ["123 e803010000000000"])
    expect(nodes == {(0, "acc_z"): 1.0, (0, "count"): 1.0}, f"35: {nodes}")
    real = decoded(CASES / "36-dbc-comment-lines" / "float.dbc", ["123 0000c03f00000000"])
    expect(real in (None, {(0, "acc_z"): 1.5}), f"36, float: {real}")
    lost = decoded(
        CASES / "36-dbc-comment-lines" / "lost-signals.dbc",
        ["123 e803d00700000000", "124 e803000000000000"],
    )
    whole = {(0, "acc_x"): 1.0, (0, "acc_z"): 2.0, (1, "q"): 1.0}
    expect(lost in (None, whole), f"36, signals: {lost}")


def main():
    if not CASES.is_dir():
        print(f"skipped: the cases of public reports are not at {CASES}")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_covered("03-one-stamp-ahead", folder, 2, ["stamps_not_trusted"])
        check_clock_set_back(folder)
        check_covered("22-wav-float-physical", folder, 1, phase_rad=-0.100531)
        check_covered("26-h5-times-0-inside", folder, 2, ["stamps_not_trusted"])
        check_covered("27-can-error-frames", folder, 2)
        check_covered("31-can-lines-swapped", folder, 2)
        check_limits_of_dbc(folder)
    archive = CASES / "21-npz-as-record" / "archive.npz"
    expect(check_sentence("21", ["NPZ"], ["t_ns column"], "fit", archive) == 1, "21: not refused")
    packed = CASES / "25-h5-lzf" / "dau.h5"
    words = ["lzf", "32000"]
    expect(check_sentence("25", words, ["damaged"], "fit", packed) == 1, "25: not refused")
    lz4 = CASES / "41-mcap-lz4" / "ros2-lz4.mcap"
    words = ["10 messages", "0 places are damaged", "0 chunks lost"]
    expect(check_sentence("41", words, [], "recording", "check", lz4) == 0, "41: damaged")
    check_dbc()


main()
