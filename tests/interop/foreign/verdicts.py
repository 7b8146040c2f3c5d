"""What a stack has read against the result file, what it has written against the recording."""

import csv
import json
import math
import subprocess

CHANNELS = ("reference", "sync")
SAMPLES_A_SECOND = 1000
FIRST_COUNTS = 0.5  # of what was written: a reader may join late, but not miss anything then


def expected_rows(result):
    """Of both topics, as the programs print them; without what the result file has not."""
    contents = json.loads(result.read_text())
    rows = {}
    for point in contents["points"]:
        key = (point["channel"], str(point["step"]), str(point["repetition"]))
        rows[("CalibrationResult", *key)] = [
            point["frequency_text_hz"],
            *(point[name] for name in ("magnitude", "u_magnitude", "phase_rad", "u_phase_rad")),
            point["unit"],
            len(point["budget"]),
        ]
    for channel in {point["channel"] for point in contents["points"]}:
        functions = [one for one in contents["transfer_function"] if one["channel"] == channel]
        rows[("TransferFunction", channel)] = [
            number
            for one in functions
            for number in (one["magnitude"], one["phase_rad"])
        ]
    return contents["run"], rows


def equal(printed, expected):
    if isinstance(expected, str):
        return printed == expected
    number = float(printed)
    return number == expected or (math.isnan(number) and math.isnan(expected))


def judge_reading(log, result):
    """PASS, PRODUCT_FAIL or TIMEOUT, and a sentence."""
    run, missing = expected_rows(result)
    wanted = len(missing)
    for line in log.read_text(errors="replace").splitlines():
        cells = line.split("\t")
        if cells[0] == "CalibrationResult" and cells[2] == run:
            key, values = (cells[0], *cells[3:6]), cells[6:13]
        elif cells[0] == "TransferFunction" and cells[2] == run:
            key, values = (cells[0], cells[3]), cells[7:]
            values = [cell for i, cell in enumerate(values) if i % 3 != 2]
        else:
            continue
        expected = missing.pop(key, None)
        if expected is None:
            continue  # a second time
        if len(values) != len(expected) or not all(map(equal, values, expected)):
            return "PRODUCT_FAIL", f"{key}: {values[:6]}, in the result file {expected[:6]}"
    if missing:
        return "TIMEOUT", f"{len(missing)} of {wanted} are missing: {sorted(missing)[0]}"
    return "PASS", f"{wanted} messages as in the result file"


def judge_writing(recording, dyncal, seconds):
    """Of one bench: every sample that the recording has from the first on."""
    tables = recording.with_suffix("")
    done = subprocess.run(
        [dyncal, "export", recording, "--output", tables, "--format", "csv"],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode or not (tables / "acs.csv").exists():
        return "PRODUCT_FAIL", f"dyncal export: {(done.stdout + done.stderr)[-200:]}"
    with open(tables / "acs.csv", encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    numbers = [int(row["sample_number"]) for row in rows]
    columns = [name for name in (rows or [{}])[0] if name.startswith(CHANNELS)]
    if len(columns) != len(CHANNELS):
        return "PRODUCT_FAIL", f"the recording has the columns {list((rows or [{}])[0])}"
    wrong = sum(
        [float(row[column]) for column in columns] != [number * 0.25, number * -0.5]
        for number, row in zip(numbers, rows, strict=True)
    )
    if wrong or not numbers:
        return "PRODUCT_FAIL", f"{wrong} wrong samples of {len(numbers)}"
    gaps = numbers[-1] - numbers[0] + 1 - len(numbers)
    last = int(seconds * SAMPLES_A_SECOND) - 1
    if gaps or numbers[-1] != last:
        return "PRODUCT_FAIL", f"{gaps} samples missing, the last is {numbers[-1]}"
    if len(numbers) < FIRST_COUNTS * last:
        return "PRODUCT_FAIL", f"only {len(numbers)} samples of {last + 1}"
    return "PASS", f"{len(numbers)} samples, none missing from the first on, none wrong"
