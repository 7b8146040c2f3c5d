"""Draws SigMF recordings, and what the public library (PyPI sigmf) reads there: runs in its Python.

    draw_sigmf.py FOLDER COUNT SEED [META...]

Writes COUNT recordings with the library, and expected.json of these and of those that are named: of
every channel its values (counts of integers, not parts of full scale), number and time of every
sample.
"""

import datetime
import json
import pathlib
import random
import sys

import numpy as np
import sigmf

TYPES = ["f64", "f32", "i32", "i16", "u32", "u16", "i8", "u8"]
START = datetime.datetime(2024, 1, 1, tzinfo=datetime.timezone.utc)
FLOAT32_EXACT = 2**24  # all that the library reads it makes float32 of
RATES_HZ = [1000, 20000, 51200, 1000000, 1250.5]


def drawn_numbers(rng, datatype, count):
    base, _, order = datatype[1:].partition("_")
    dtype = np.dtype(f"{'>' if order == 'be' else '<'}{base[0]}{int(base[1:]) // 8}")
    if base[0] == "f":
        return rng.standard_normal(count).astype(np.float32).astype(dtype)
    low, high = max(np.iinfo(dtype).min, -FLOAT32_EXACT), min(np.iinfo(dtype).max, FLOAT32_EXACT)
    return rng.integers(low, high, count, dtype=np.int64, endpoint=True).astype(dtype)


def time_text(seconds):
    return (START + datetime.timedelta(seconds=seconds)).strftime("%Y-%m-%dT%H:%M:%S.%fZ")


def draw_recording(path, seed):
    draw, rng = random.Random(seed), np.random.default_rng(seed)
    base = draw.choice(TYPES)
    order = "" if base.endswith("8") else draw.choice(["_le", "_le", "_be"])
    datatype = draw.choice("cr") + base + order
    channels = draw.choice([1, 1, 1, 2, 3])
    samples = draw.randint(10, 9000)
    rate = draw.choice(RATES_HZ)
    numbers = samples * channels * (2 if datatype[0] == "c" else 1)
    drawn_numbers(rng, datatype, numbers).tofile(path.with_suffix(".sigmf-data"))
    meta = sigmf.SigMFFile(
        data_file=path.with_suffix(".sigmf-data"),
        global_info={"core:datatype": datatype, "core:sample_rate": rate,
                     "core:num_channels": channels},
        skip_checksum=draw.random() < 0.5)
    starts = sorted({0, *draw.sample(range(1, samples), draw.randint(0, 3))})
    lost = [0]
    for start in starts:
        lost.append(lost[-1] + (draw.randint(0, 50) if start else 0))
        capture = {"core:datetime": time_text((start + lost[-1]) / rate)} if not start else {}
        if len(starts) > 1:
            capture["core:global_index"] = 1000 + start + lost[-1]
        meta.add_capture(start, metadata=capture)
    meta.tofile(path)


def expected(path, folder):
    recording = sigmf.fromfile(path, autoscale=False)
    samples = recording.read_samples()
    samples = samples.reshape(len(samples), -1)
    columns = []
    for channel in range(samples.shape[1]):
        one = samples[:, channel]
        columns += [one.real, one.imag] if np.iscomplexobj(one) else [one]
    output = folder / f"{path.stem}.values"
    np.concatenate([column.astype(np.float64) for column in columns]).tofile(output)
    numbers = np.arange(len(samples))
    captures = recording.get_captures()
    for capture in captures:
        if "core:global_index" in capture:
            start = capture["core:sample_start"]
            gone = capture["core:global_index"] - captures[0]["core:global_index"] - start
            numbers[start:] = np.arange(start, len(samples)) + gone
    return {"path": str(path), "columns": len(columns), "values": str(output),
            "numbers": [int(numbers[0]), int(numbers[-1])], "count": len(samples),
            "rate": recording.get_global_info()["core:sample_rate"],
            "start": captures[0]["core:datetime"]}


def main():
    folder, count, seed = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    paths = [pathlib.Path(path) for path in sys.argv[4:]]
    for i in range(count):
        paths.append(folder / f"drawn_{i}.sigmf-meta")
        draw_recording(paths[-1], seed + i)
    (folder / "expected.json").write_text(json.dumps([expected(path, folder) for path in paths]))


if __name__ == "__main__":
    main()
