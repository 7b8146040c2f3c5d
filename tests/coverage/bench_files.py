"""The files that `dyncal analyse` reads: records, shots, ADC calibration, bench file.

The formats are those of drivers/files/README.md, drivers/tss/README.md, and of adc_file.hpp and
bench_file.hpp in services/bench/file, written from these pages and not with any of our code.
"""

import json

import numpy as np


def write_record(path, columns):
    """`columns`: name to array; t_ns and sample_number are integers, all others numbers."""
    types = [
        (name, "<i8" if name in ("t_ns", "sample_number") else "<f8") for name in columns
    ]
    rows = np.empty(len(next(iter(columns.values()))), dtype=types)
    for name, values in columns.items():
        rows[name] = values
    np.save(path, rows)


def write_shot(path, channel, unit, values, nominal_rate_hz, first_sample_s=None):
    head = f"# nominal_rate_hz = {nominal_rate_hz!r}\n"
    if first_sample_s is not None:
        head += f"# first_sample_s = {first_sample_s!r}\n"
    rows = "\n".join(map(repr, values.tolist()))
    path.write_text(f"{head}# unit = {unit}\n{channel}\n{rows}\n", "utf-8")


def write_reference_calibration(path, points):
    """`points`: (frequency_hz, magnitude, phase_rad, u_magnitude_rel, u_phase_rad); half of the
    variance is said to be of mounting."""
    columns = "frequency_hz, magnitude, phase_rad, u_magnitude_rel, u_phase_rad"
    rows = [f"{columns}, mounting.u_magnitude_rel, mounting.u_phase_rad"]
    for point in points:
        of_mounting = (u * 0.5**0.5 for u in point[3:])
        rows.append(", ".join(map(repr, (*point, *of_mounting))))
    path.write_text("\n".join(rows) + "\n", "utf-8")


def write_adc_calibration(path, channel, points):
    """`points`: (frequency_hz, gain, lag_rad, u_lag_rad)."""
    measurements = {
        repr(frequency_hz): [
            {
                "Freq": frequency_hz,
                "Amplitude": gain,
                "Phase": lag_rad,
                "u_Phase": u_lag_rad,
                "TestAmplVPP.": 10.0,
            }
        ]
        for frequency_hz, gain, lag_rad, u_lag_rad in points
    }
    path.write_text(json.dumps({"FitResults": {channel: measurements}}), "utf-8")


def toml_value(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml_value(one)}" for key, one in value.items()) + " }"
    return json.dumps(value)  # numbers, texts, truth values and lists are the same in both


def write_bench_file(path, tables):
    """`tables`: "" for the keys on top, then name of the table to its keys."""
    text = ""
    for name, keys in tables.items():
        text += f"[{name}]\n" if name else ""
        text += "".join(f"{key} = {toml_value(value)}\n" for key, value in keys.items())
    path.write_text(text, "utf-8")
