"""A bench whose records are played from files at twice their speed, so that bits can be compared.

The results of a run must be those that `dyncal analyse` gives for the same files, to the last bit,
whatever happens on the way. On loopback, on a DDS domain of its own; close() ends what was started.
"""

import json
import pathlib

from bench_laboratory import READY, VENDORS, Failure, Program, reserve_dds_domain

FREQUENCIES = ("20", "80", "160")
LEVELS = ("10", "100", "100")
REPETITIONS = 2
BENCH = """bench = "{name}"
[excitation]
frequencies_hz = ["20", "80", "160"]
level = [10.0, 100.0, 100.0]
repetitions = 2
settling_s = 0.5
duration_s = 1.5
[sources.dau]
driver = "file"
play = {speed}
path = "dau.csv"
[sources.dau.units]
acceleration_x = "m/s^2"
acceleration_y = "m/s^2"
acceleration_z = "m/s^2"
sync = "V"
[sources.acs]
driver = "file"
play = {speed}
path = "acs.csv"
units = {{ reference = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_x", "dau/acceleration_y", "dau/acceleration_z"]
[corrections]
adc = {{ file = "adc.json", channel = "ADC1" }}
[uncertainty]
reference_magnitude_rel = 5e-4
reference_phase_rad = 5e-4
acs_delay_s = 1e-8
"""


class PlayedLaboratory:
    def __init__(self, programs, folder, vendors, speed=2.0, name="played"):
        self.programs = pathlib.Path(programs)
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.vendors = VENDORS[vendors]
        self.domain, self.keeper = reserve_dds_domain()
        self.started = []
        self.bench_file = self.folder / "bench.toml"
        self.bench_file.write_text(BENCH.format(name=name, speed=speed), encoding="utf-8")
        self.record()
        self.expected = self.analysed()

    def record(self):
        """The same samples at every call."""
        record = self.start_program(
            "dyncal-virtual-bench",
            ["--preset", "mpu9250-ptb", "--seed", 3, "--record-csv", self.folder]
            + ["--truth", self.folder / "truth.json", "--adc-file", self.folder / "adc.json"]
            + ["--frequencies", ",".join(FREQUENCIES), "--levels", ",".join(LEVELS)]
            + ["--repetitions", REPETITIONS, "--settling", 0.5, "--duration-per-step", 2.0],
        )
        if record.wait() != 0:
            raise Failure(record.errors())

    def analysed(self):
        result = self.folder / "analyse.json"
        analyse = self.start_program("dyncal", ["analyse", self.bench_file, "--output", result])
        if analyse.wait() != 0:
            raise Failure(analyse.errors())
        return json.loads(result.read_text(encoding="utf-8"))

    def start_program(self, program, arguments, environment=None):
        place = self.folder / f"{len(self.started):02}-{program}"
        place.mkdir(exist_ok=True)
        command = [str(self.programs / program), *map(str, arguments)]
        own = {"XDG_CACHE_HOME": str(self.folder / "cache"), **(environment or {})}
        self.started.append(Program(command, place / "log.txt", own))
        return self.started[-1]

    def on_bus(self, program, arguments, environment=None):
        place = ["--domain", self.domain, "--dds", self.vendors[program]]
        return self.start_program(program, [*arguments, *place], environment)

    def service(self, program, environment=None):
        files = [] if program == "dyncal-analysis" else [self.bench_file]
        service = self.on_bus(program, files, environment)
        service.wait_for_text(READY[program])
        return service

    def run(self, environment=None):
        return self.on_bus(
            "dyncal", ["run", self.bench_file, "--output", self.folder / "run.json"], environment
        )

    def expect_same_bits(self, run):
        status = run.wait()
        if status != 0:
            raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
        result = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
        if not self.expected["points"] or not self.expected["transfer_function"]:
            raise Failure("nothing was expected")
        for key in ("points", "transfer_function"):
            if result[key] != self.expected[key]:
                raise Failure(f"{key} are not those of `dyncal analyse`")

    def close(self):
        for program in reversed(self.started):
            program.end()
        self.keeper.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
