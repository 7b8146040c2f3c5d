#!/usr/bin/env python3
"""Recorded series as public libraries read them: TDMS by PyPI npTDMS, SigMF by PyPI sigmf.

    public_library_test.py tdms|sigmf SERIES_VALUES WORK

Draws files with the library's own writer (DYNCAL_DRAWN_FILES of them, 50 unless stated, from the
seed DYNCAL_FILE_SEED on) and reads these, and those of ../shared where that is there: every value,
number and stamp must be the same. Skips, with a line that says so, where the library cannot be had.
"""

import datetime
import json
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "recording"))

import public_reader  # noqa: E402  pylint: disable=wrong-import-position

SHARED = HERE.parents[2] / "shared/data/reference"
SKIPPED = 77
# Library, its modules, and the files of ../shared.
KINDS = {
    "tdms": (("nptdms", "numpy"), "tdms/*.tdms"),
    "sigmf": (("sigmf", "numpy"), "iq/*.sigmf-meta"),
}


class Difference(Exception):
    pass


def doubles(data):
    """Compared as bytes, but for NaN, which has many."""
    return memoryview(data).cast("d")


def same(ours, theirs):
    if ours == theirs:
        return True
    pairs = zip(doubles(ours), doubles(theirs))
    return len(ours) == len(theirs) and all(a == b or (a != a and b != b) for a, b in pairs)


class Reader:
    def __init__(self, program, work):
        self.program, self.output = program, work / "ours.values"

    def read(self, path, *options):
        """Names and units of channels, sample numbers, stamps, and the bytes of all values."""
        words = [self.program, path, str(self.output), *options]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Difference(f"{path} {options}: {done.stderr}")
        channels = [line.split("\t") for line in done.stdout.splitlines()]
        data = self.output.read_bytes()
        samples = len(data) // 8 // (2 + len(channels))
        whole = memoryview(data).cast("q")
        return channels, whole[:samples], whole[samples : 2 * samples], data[16 * samples :]


def stamps(interval_s, start_ns, count):
    return start_ns, start_ns + round((count - 1) * interval_s * 1e9)


def check_tdms_channel(reader, path, channel):
    rate = () if channel["increment"] else ("--rate", "1000")
    name = f"{channel['group']}/{channel['name']}"
    channels, numbers, times, values = reader.read(path, "--channel", name, *rate)
    if {unit for _, unit in channels} != {channel["unit"]}:
        raise Difference(f"{path} {name}: unit {channels}")
    if len(numbers) != channel["count"] or numbers[-1] != channel["count"] - 1:
        raise Difference(f"{path} {name}: {len(numbers)} samples, not {channel['count']}")
    first, last = stamps(channel["increment"] or 1e-3, channel["start_ns"], channel["count"])
    if times[0] != first or abs(times[-1] - last) > 1 + 1e-9 * abs(last - first):
        raise Difference(f"{path} {name}: from {times[0]} to {times[-1]}, not {first} to {last}")
    if not same(values, pathlib.Path(channel["values"]).read_bytes()):
        raise Difference(f"{path} {name}: other values")


def check_tdms(reader, file):
    for channel in file["channels"]:
        check_tdms_channel(reader, file["path"], channel)
    return sum(channel["count"] for channel in file["channels"])


def check_sigmf(reader, file):
    channels, numbers, times, values = reader.read(file["path"])
    if len(channels) != file["columns"] or len(numbers) != file["count"]:
        raise Difference(f"{file['path']}: {channels}, {len(numbers)} samples")
    if [numbers[0], numbers[-1]] != file["numbers"]:
        raise Difference(f"{file['path']}: samples {numbers[0]} to {numbers[-1]}")
    start = datetime.datetime.fromisoformat(file["start"].replace("Z", "+00:00"))
    microsecond = datetime.timedelta(microseconds=1)
    epoch = datetime.datetime(1970, 1, 1, tzinfo=datetime.timezone.utc)
    first_ns = (start - epoch) // microsecond * 1000
    last_ns = first_ns + round(numbers[-1] / file["rate"] * 1e9)
    if times[0] != first_ns or abs(times[-1] - last_ns) > 1:
        raise Difference(f"{file['path']}: from {times[0]} to {times[-1]}")
    if not same(values, pathlib.Path(file["values"]).read_bytes()):
        raise Difference(f"{file['path']}: other values")
    return len(numbers) * len(channels)


def main():
    kind, program, work = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    libraries, named = KINDS[kind]
    work.mkdir(parents=True, exist_ok=True)
    python = public_reader.interpreter(work, libraries)
    if python is None:
        print(f"skipped: the Python library {libraries[0]} is not there, and no PyPI either")
        return SKIPPED
    drawn = work / "drawn"
    shutil.rmtree(drawn, ignore_errors=True)
    drawn.mkdir()
    count = int(os.environ.get("DYNCAL_DRAWN_FILES", "50"))
    seed = int(os.environ.get("DYNCAL_FILE_SEED", "1"))
    shared = sorted(SHARED.glob(named))
    if not shared:
        print(f"skipped: {SHARED / named}, which is not there")
    script = [python, str(HERE / f"draw_{kind}.py"), str(drawn), str(count), str(seed)]
    subprocess.run([*script, *map(str, shared)], check=True)
    reader = Reader(program, work)
    check = check_tdms if kind == "tdms" else check_sigmf
    files = json.loads((drawn / "expected.json").read_text())
    numbers, differences = 0, []
    for file in files:
        try:
            numbers += check(reader, file)
        except Difference as difference:
            differences.append(str(difference))
    print("\n".join(differences))
    print(f"{len(files)} files, seed {seed}: {numbers} numbers, {len(differences)} differences")
    shutil.rmtree(drawn)
    return 1 if differences or len(files) < count or numbers < 1000 else 0


if __name__ == "__main__":
    sys.exit(main())
