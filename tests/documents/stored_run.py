"""A stored run with many values, made from the example that the writer of results prints: what
reports and certificates are tried on, without a measurement."""

import copy
import json
import math
import pathlib
import random
import subprocess
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
LAB_FOLDER = TOP / "deploy/example-lab/documents"
LAB = LAB_FOLDER / "laboratory.toml"
SENSOR = LAB_FOLDER / "sensor.toml"
FREQUENCIES = ["10", "12.5", "16", "20", "25", "31.5", "40", "50", "63", "80", "100", "199.87"]
CHANNELS = {"dau/acceleration_x": 0.02, "dau/acceleration_z": 0.98}
AXIS = "z"
# Of a sensor file.
TOLERANCES = """
[conformity]
specification = "data sheet"
rule = "guard-band"

[[tolerance]]
channel = "dau/acceleration_z"
from_hz = 10.0
to_hz = 100.0
limits_percent = 10.0
nominal = 0.98
"""
REPETITIONS = 3


def budget_of(channel, budget):
    """What the exciter moves across the excited axis is in the channels there."""
    rows = copy.deepcopy(budget)
    if not channel.endswith(f"_{AXIS}"):
        rows.append(
            {
                **rows[-1],
                "name": "transverse motion of the exciter",
                "kind": "transverse_motion",
                "subject": "",
                "distribution": "rectangular",
                "repeats": "common",
                "u_magnitude_rel": 1e-4,
                "u_phase_rad": 1e-4,
            }
        )
    return rows


def expanded(entry, u_magnitude, u_phase, k_magnitude, k_phase):
    """u, k and U as a result file states them."""
    entry.update(
        u_magnitude=u_magnitude,
        k_magnitude=k_magnitude,
        U_magnitude=k_magnitude * u_magnitude,
        nu_eff_magnitude=40.0,
        u_phase_rad=u_phase,
        u_phase_deg=math.degrees(u_phase),
        k_phase=k_phase,
        U_phase_rad=k_phase * u_phase,
        U_phase_deg=math.degrees(k_phase * u_phase),
        nu_eff_phase=None,
        coverage_probability=0.9544997361036416,
    )


def clean_run(example_writer, seed=1):
    """The result of a whole run: two channels, every frequency, nothing lost, no flag."""
    example = json.loads(
        subprocess.run([example_writer], check=True, capture_output=True, text=True).stdout
    )
    draw = random.Random(seed)
    point_of = example["points"][0]
    value_of = example["transfer_function"][0]
    result = copy.deepcopy(example)
    result.update(flag_legend=[], points=[], transfer_function=[], channels=[], group_delay=[])
    # After sensor and reference of the example files.
    for name, hour in (("began_utc", 12), ("ended_utc", 13)):
        result[name] = f"2026-03-01T{hour}:00:05.500000000Z"
    result["conducted_by"] = {"name": "A. Meter", "user": "meter", "host": "lab3"}
    result["planned_steps"] = len(FREQUENCIES) * REPETITIONS
    sensor = {"source": "dau", "kind": "dau", "device": "MPU-9250", "serial": "0xbccb0100"}
    result["sources"].append({**result["sources"][0], **sensor})
    for clock in result["sample_clock"]:
        clock.update(flags=[], flag_names=[], lost=0)
    for channel, gain in CHANNELS.items():
        result["channels"].append(
            {
                "channel": channel,
                "unit": "\\one",
                "responds": True,
                "lost": 0,
                "flags": [],
                "flag_names": [],
            }
        )
        for number, text in enumerate(FREQUENCIES):
            frequency = float(text)
            magnitude = gain * (1.0 + 0.01 * draw.uniform(-1, 1))
            phase = math.remainder(-2 * math.pi * frequency * 8.2e-3, 2 * math.pi)
            u_magnitude = magnitude * draw.uniform(2e-4, 3e-3)
            u_phase = draw.uniform(2e-4, 9e-3)
            value = copy.deepcopy(value_of)
            value.update(
                channel=channel,
                frequency_text_hz=text,
                frequency_hz=frequency,
                level_m_s2=10.0,
                excited_axis=AXIS,
                magnitude=magnitude,
                phase_rad=phase,
                phase_deg=math.degrees(phase),
                unwrapped_phase_rad=-2 * math.pi * frequency * 8.2e-3,
                repetitions=REPETITIONS,
                unit="\\one",
                flags=[],
                flag_names=[],
            )
            expanded(value, u_magnitude, u_phase, draw.uniform(2.0, 2.9), 2.0)
            result["transfer_function"].append(value)
            for repetition in range(REPETITIONS):
                point = copy.deepcopy(point_of)
                point.update(
                    channel=channel,
                    step=repetition * len(FREQUENCIES) + number + 1,
                    repetition=repetition + 1,
                    frequency_text_hz=text,
                    frequency_hz=frequency,
                    level_m_s2=10.0,
                    excited_axis=AXIS,
                    budget=budget_of(channel, point_of["budget"]),
                    valid=True,
                    magnitude=magnitude,
                    phase_rad=phase,
                    phase_deg=math.degrees(phase),
                    lost=0,
                    flags=[],
                    flag_names=[],
                )
                for source in point["source_samples"]:
                    source.update(lost=0, unusable=0, overflowed=0)
                expanded(point, u_magnitude, u_phase, 2.0, 2.0)
                result["points"].append(point)
    return result


def write_run(folder, result):
    """A run folder with this result."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "result.json").write_text(json.dumps(result, indent=1))
    return folder


def kept(dyncal, run):
    """The options that name a new store that has this run, as `dyncal run` leaves one."""
    store = pathlib.Path(tempfile.mkstemp(suffix=".sqlite", dir=pathlib.Path(run).parent)[1])
    store.unlink()
    subprocess.run([dyncal, "store", "add", run, "--store", store], capture_output=True)
    return ["--store", store]


def two_digits(value):
    """As people read an uncertainty."""
    place = math.floor(math.log10(value)) - 1
    if round(value / 10**place) >= 100:
        place += 1
    return f"{value:.{max(-place, 0)}f}"


def rounded(value, expanded_uncertainty):
    """Value and U as people read them, by arithmetic of its own: U to two significant digits, the
    value to the same place."""
    place = math.floor(math.log10(expanded_uncertainty)) - 1
    if round(expanded_uncertainty / 10**place) >= 100:
        place += 1
    digits = max(-place, 0)
    value_text = f"{value:.{digits}f}"
    return value_text, f"{expanded_uncertainty:.{digits}f}"
