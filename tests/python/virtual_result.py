"""A result of records that the virtual bench makes."""

import json
import subprocess

BENCH = """
bench = "python"
[excitation]
frequencies_hz = {frequencies}
level = 10.0
repetitions = 2
settling_s = 0.5
duration_s = 1.0
[sources.dau]
driver = "file"
path = "records/dau.csv"
time_base = "utc"
units = {{ acceleration_z = "m/s^2", sync = "V" }}
[sources.acs]
driver = "file"
path = "records/acs.csv"
units = {{ reference = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1.7e-3
adc_delay_s = 1e-6
acs_delay_s = 1e-7
"""


def make(programs, folder, frequencies):
    """records/, bench.toml and result.json in the folder; the frequencies as decimal texts."""
    (folder / "bench.toml").write_text(BENCH.format(frequencies=json.dumps(frequencies)))
    drawn = ["--frequencies", ",".join(frequencies), "--levels", "10", "--repetitions", "2"]
    drawn += ["--settling", "0.5", "--duration-per-step", "1"]
    for words in (
        ["dyncal-virtual-bench", "--record-csv", "records", *drawn],
        ["dyncal", "analyse", "bench.toml", "--output", "result.json"],
    ):
        done = subprocess.run(
            [programs / words[0], *words[1:]],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
