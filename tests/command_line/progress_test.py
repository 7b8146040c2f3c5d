#!/usr/bin/env python3
"""The progress of commands that take long, on a terminal: the time left is told, and the line is
gone when the command has ended: with its result, with an error, by Ctrl-C."""

import json
import math
import pathlib
import re
import signal
import tempfile

from programs import expect, run
from terminal import Terminal

CLEAR = "\r\x1b[K"
PERIOD = 100  # rows
ROWS_OF_A_BLOCK = 1000
FIT = ["--frequency", "10", "--nominal-rate", "1000"]


def write_series(path, megabytes, end=""):
    """A sine of 10 Hz in three columns, at 1 kHz by --nominal-rate: the stamps repeat."""
    rows = []
    for i in range(ROWS_OF_A_BLOCK):
        values = [math.sin(2 * math.pi * i / PERIOD + phase) + 0.01 * (i % 7) for phase in range(3)]
        rows.append(f"{i * 1000000}," + ",".join(f"{value:.9f}" for value in values) + "\n")
    block = "".join(rows)
    with open(path, "w", encoding="utf-8") as file:
        file.write("t_ns,a,b,c\n")
        for _ in range(megabytes * 1000000 // len(block)):
            file.write(block)
        file.write(end)


def write_result(path, megabytes):
    """A result of three axes with as much else in it as results of many steps have."""
    numbers = dict.fromkeys(
        ["level_m_s2", "unwrapped_phase_rad", "unwrapped_phase_deg", "scatter_magnitude",
         "scatter_phase_rad", "phase_deg", "u_phase_deg", "U_phase_deg", "nu_eff_magnitude",
         "nu_eff_phase", "u_independent_phase_rad"]
    )  # fmt: skip
    values = [
        {**numbers, "channel": f"dau/a_{axis}", "frequency_text_hz": str(hz), "frequency_hz": hz,
         "unit": "\\one", "magnitude": 1.0, "u_magnitude": 0.001, "k_magnitude": 2.0,
         "U_magnitude": 0.002, "phase_rad": 0.1, "u_phase_rad": 0.001, "k_phase": 2.0,
         "U_phase_rad": 0.002, "coverage_probability": 0.95, "repetitions": 1, "flags": [],
         "flag_names": []}
        for axis in "xyz"
        for hz in range(10, 20)
    ]  # fmt: skip
    result = {
        **dict.fromkeys(["began_utc", "ended_utc"]),
        **{name: [] for name in ["flag_legend", "sources", "steps", "channels", "group_delay",
                                 "sample_clock", "points"]},
        "schema": {"name": "dyncal-result", "version": 2}, "bench": "b", "run": "r",
        "method": "analogue", "phase_convention": "", "software": "dyncal",
        "analysis": {"software": None, "host": None}, "dds": {"analysis": "none"},
        "planned_steps": 10, "interrupted": False, "problem": "", "recipe_sha256": "",
        "transfer_function": values,
    }  # fmt: skip
    more = "0.123456789," * (megabytes * 1000000 // 12)
    path.write_text(f'{{"of_a_later_version": [{more}0], {json.dumps(result)[1:]}')


def remaining(text):
    """What stays on the terminal: all before it was one line, which was cleared."""
    progress, after = text.rsplit(CLEAR, 1)
    expect("\n" not in progress, f"more than one line: {progress[-500:]!r}")
    return after.replace("\r\n", "\n")


def progress_of(text, what):
    """The counts of what was shown."""
    return [int(done) for done in re.findall(rf"{what}: (\d+) (?:of|%)", text)]


def check_to_the_end(arguments, whats, last):
    """What is drawn on a terminal, and that the output is that without one."""
    terminal = Terminal(*arguments)
    expect(terminal.read_to_the_end() == 0, terminal.text[-500:])
    expect(last in terminal.text, terminal.text[-500:])
    for what in whats:
        expect(re.search(rf"{what}: [^\r]*, \d+ (s|min) left", terminal.text), terminal.text)
        counts = progress_of(terminal.text, what)
        expect(counts == sorted(counts) and len(set(counts)) > 2, f"{what}: {counts}")
    quiet = run("dyncal", *arguments)
    expect(quiet.stderr == "" and "left" not in quiet.stdout, quiet.stderr + quiet.stdout[:500])
    expect(remaining(terminal.text) == quiet.stdout, f"{terminal.text[-500:]!r}")
    print(f"{arguments[0]}: {len(re.findall('left', terminal.text))} lines")


def check_refusal(arguments, part):
    """One sentence, and nothing else on the terminal."""
    terminal = Terminal(*arguments)
    expect(terminal.read_to_the_end() == 1, terminal.text)
    expect(part in terminal.text, terminal.text[-500:])
    expect(re.search(r"reading: \d+ of \d+ MB, \d+ s left", terminal.text), terminal.text)
    left = remaining(terminal.text)
    expect(left.startswith("dyncal: ") and left.count("\n") == 1, left)


def check_interruption(arguments):
    terminal = Terminal(*arguments)
    terminal.read_until(lambda text: " left" in text, 300)
    terminal.write("\x03")
    expect(terminal.read_to_the_end() == -signal.SIGINT, terminal.text)
    expect("^C" in terminal.text, terminal.text)
    expect(remaining(terminal.text) == "", terminal.text)


def check_fit(folder):
    write_series(folder / "sine.csv", 160)
    fit = ["fit", folder / "sine.csv", *FIT, "--harmonics", "50"]
    check_to_the_end(fit, ["fitting"], "reference time")
    check_interruption(fit)


def check_reading(folder):
    """Of results: what takes long is to read them."""
    for axis in "xyz":
        write_result(folder / f"{axis}.json", 90)
    (folder / "cut.json").write_text((folder / "x.json").read_text()[:-200])
    of_axis = lambda axis, name: [f"--{axis}", folder / f"{name}.json"]
    results = [*of_axis("x", "x"), *of_axis("y", "y"), *of_axis("z", "z")]
    check_to_the_end(["triaxial", *results], ["reading"], "transverse motion")
    check_interruption(["triaxial", *results])
    check_refusal(
        ["triaxial", *of_axis("x", "x"), *of_axis("y", "y"), *of_axis("z", "cut")],
        "cut.json: not JSON",
    )


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_fit(folder)
        check_reading(folder)


main()
