"""A live bench on this machine for fault campaigns: virtual bench, its services, one conductor.

Everything runs on loopback, on a DDS domain of its own and in a folder of its own; close() ends
what was started. Programs are those of a build tree or of an installation.
"""

import fcntl
import json
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import termios
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import reserve_dds_domain  # noqa: E402

# A campaign under nohup ignores SIGHUP, and what ignores it hands that on to its programs, which
# then do as they are told. A handler is not handed on.
if signal.getsignal(signal.SIGHUP) == signal.SIG_IGN:
    signal.signal(signal.SIGHUP, lambda *_: None)

PATIENCE_S = 300.0
SERVICES = ("dyncal-analysis", "dyncal-dau", "dyncal-acs", "dyncal-guard")
READY = {
    "dyncal-analysis": "analysis ready",
    "dyncal-dau": "listening at UDP",
    "dyncal-acs": ", source ",
    "dyncal-dso": " is ready",
    "dyncal-guard": "guarding the output",
    "dyncal-recorder": "recorder ready",
    "dyncal-web": "web ready",
    "dyncal-virtual-bench": "datagrams to",
}
FAST_DDS_IN_MIXED = ("dyncal", "dyncal-acs", "dyncal-dso", "dyncal-web")
ON_BUS = sorted({*READY, "dyncal"} - {"dyncal-virtual-bench"})
VENDORS = {
    "cyclonedds": dict.fromkeys(ON_BUS, "cyclonedds"),
    "fastdds": dict.fromkeys(ON_BUS, "fastdds"),
    "mixed": {
        program: "fastdds" if program in FAST_DDS_IN_MIXED else "cyclonedds" for program in ON_BUS
    },
}


class Failure(Exception):
    """What a laboratory did that it must not do."""


def wait_until(condition, what, patience_s=PATIENCE_S, interval_s=0.02):
    deadline = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > deadline:
            raise Failure(f"waited {patience_s:.0f} s for {what}")
        time.sleep(interval_s)  # between two looks at the condition


# Linux does not give these ports to clients, of which a laboratory starts many before it listens.
ports_for_units = iter(random.sample(range(61_000, 65_536), 4_536))


def free_udp_port():
    for port in ports_for_units:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", port))
                return port
            except OSError:
                continue
    raise Failure("no free UDP port is left")


def take_terminal():
    fcntl.ioctl(0, termios.TIOCSCTTY)


def guards_output(process):
    try:
        command = pathlib.Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return False  # it has ended
    return b"guard-output" in command.split(b"\0")


class Program:
    """`terminal`: the end of a pseudo terminal that is the program's own, as in a window.

    What guards its generator's output outlives it, and is ended with it by end() alone."""

    def __init__(self, command, log, environment=None, terminal=None):
        self.log = log
        self.guards = set()  # of its output, that were seen
        with open(log, "w", encoding="utf-8") as errors:
            self.process = subprocess.Popen(
                command,
                stdout=subprocess.DEVNULL,
                stderr=errors,
                stdin=subprocess.DEVNULL if terminal is None else terminal,
                start_new_session=terminal is not None,
                preexec_fn=None if terminal is None else take_terminal,
                cwd=log.parent,
                env={**os.environ, **(environment or {})},
            )

    def errors(self):
        return self.log.read_text(encoding="utf-8", errors="replace")

    def runs(self):
        return self.process.poll() is None

    def wait_for_text(self, text, patience_s=PATIENCE_S):
        wait_until(
            lambda: text in self.errors() or not self.runs(),
            f"'{text}' in {self.log}",
            patience_s,
        )
        if text not in self.errors():
            raise Failure(f"{self.log}: ended with {self.process.returncode}: {self.errors()}")

    def look_for_guards(self):
        parent = self.process.pid
        try:
            children = pathlib.Path(f"/proc/{parent}/task/{parent}/children").read_text("ascii")
        except OSError:
            return  # it has ended
        self.guards |= {int(child) for child in children.split() if guards_output(child)}

    def is_guarded(self):
        return any(guards_output(guard) for guard in self.guards)

    def send(self, number):
        self.look_for_guards()
        if self.runs():
            self.process.send_signal(number)

    def wait(self, patience_s=PATIENCE_S):
        try:
            return self.process.wait(patience_s)
        except subprocess.TimeoutExpired as error:
            raise Failure(f"{self.log}: still runs after {patience_s:.0f} s") from error

    def end(self):
        self.send(signal.SIGCONT)
        self.send(signal.SIGTERM)
        try:
            self.process.wait(20.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        for guard in filter(guards_output, self.guards):
            os.kill(guard, signal.SIGKILL)


class BenchLaboratory:
    """Virtual bench, source services, analysis and guard; `vendors` a key of VENDORS.

    Several on one DDS domain: give the `domain` of another, names of their own, and `services`
    without the analysis to all but one. `environments`: variables of a program, by its name.
    """

    preset = "mpu9250-ptb"  # of the virtual bench
    channels = 3  # of its sensor
    sensor_uncertainty = "adc_delay_s = 1e-6"
    terminal = None  # of the programs that are started from now on
    run_s = 11.0  # about what an undisturbed run takes, from its first word to its last

    def __init__(
        self,
        programs,
        folder,
        vendors,
        frequencies=("40", "80", "125"),
        name="live",
        domain=None,
        services=SERVICES,
        acs_rate_hz=20000,
        environments=None,
    ):
        self.programs = pathlib.Path(programs)
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.vendors = VENDORS[vendors]
        self.frequencies = frequencies
        self.name = name
        self.acs_rate_hz = acs_rate_hz
        self.environments = environments or {}
        self.domain, self.keeper = (domain, None) if domain else reserve_dds_domain()
        self.started = []
        self.services = {}
        self.start_virtual_bench()
        for service in services:
            self.restart(service)

    def start_virtual_bench(self):
        self.dau = f"127.0.0.1:{free_udp_port()}"
        ports_file = self.folder / "ports.json"
        bench = self.start_program(
            "dyncal-virtual-bench",
            ["--preset", self.preset, "--dau", self.dau, "--ports-file", ports_file]
            + ["--truth", self.folder / "truth.json"]
            + ["--frequencies", ",".join(self.frequencies), "--levels", "20"]
            + ["--acs-rate", self.acs_rate_hz],
        )
        bench.wait_for_text(READY["dyncal-virtual-bench"])
        self.ports = json.loads(ports_file.read_text(encoding="utf-8"))
        self.bench_file = self.folder / "bench.toml"
        self.bench_file.write_text(self.bench_text(), encoding="utf-8")

    def bench_text(self):
        frequencies = ", ".join(f'"{one}"' for one in self.frequencies)
        return f"""bench = "{self.name}"
[excitation]
frequencies_hz = [{frequencies}]
level = 20.0
settling_s = 0.5
duration_s = 1.5
[generator]
driver = "scpi"
address = "{self.generator_host()}:{self.ports['generator']}"
level_per_volt = 50.0
[sources.acs]
driver = "socket"
address = "127.0.0.1:{self.ports['acs']}"
{self.sensor_text()}
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1.7e-3
acs_delay_s = 1e-8
{self.sensor_uncertainty}
"""

    def sensor_text(self):
        """Its sources, and the method."""
        return f"""[sources.dau]
driver = "smartup"
sensor = "0xbccb0100"
listen = "{self.dau}"
channels = {{ Data_11 = "sync" }}
time_base = "utc"
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_x", "dau/acceleration_y", "dau/acceleration_z"]"""

    def start_program(self, program, arguments, on_host=()):
        place = self.folder / f"{len(self.started):02}-{program}"
        place.mkdir(exist_ok=True)
        command = [*on_host, str(self.programs / program), *map(str, arguments)]
        environment = {
            "XDG_CACHE_HOME": str(self.folder / "cache"),
            "XDG_STATE_HOME": str(self.folder / "state"),
        }
        environment.update(self.environments.get(program, {}))
        self.started.append(Program(command, place / "log.txt", environment, self.terminal))
        return self.started[-1]

    def on_bus(self, program, arguments):
        place = ["--domain", self.domain, "--dds", self.vendors[program]]
        return self.start_program(program, [*arguments, *place])

    def restart(self, service):
        arguments = {
            "dyncal-analysis": [],
            "dyncal-recorder": ["--folder", self.recordings()],
            "dyncal-web": ["--listen", "127.0.0.1:0", "--store", "none"],
        }.get(service, [self.bench_file])
        self.services[service] = self.on_bus(service, arguments)
        self.services[service].wait_for_text(READY[service])

    def recordings(self):
        return self.folder / "recordings"

    def run(self, *arguments):
        return self.on_bus(
            "dyncal", ["run", self.bench_file, "--output", self.folder / "run.json", *arguments]
        )

    def result(self):
        return json.loads((self.folder / "run.json").read_text(encoding="utf-8"))

    def expect_whole_result(self, flagged_by_chance=0):
        """Every value is there, valid, without loss and without flag; returns the values.

        Noise passes each check of a value now and then (about 3e-4 of values): of a long run so
        many may be flagged.
        """
        points = self.result()["points"]
        if len(points) != len(self.frequencies) * self.channels:
            raise Failure(f"{self.name}: {len(points)} values")
        flagged = 0
        for point in points:
            flagged += bool(point["flags"])
            if not point["valid"] or point["lost"] or flagged > flagged_by_chance:
                raise Failure(f"{self.name}: {point['problem'] if not point['valid'] else point}")
        return points

    def generator_host(self):
        return "127.0.0.1"

    def output_is_on(self):
        """What the generator itself answers."""
        place = (self.generator_host(), self.ports["generator"])
        with socket.create_connection(place, 10.0) as link:
            link.settimeout(10.0)
            link.sendall(b":OUTPut1?\n")
            return link.makefile().readline().strip() == "ON"

    def close(self):
        for program in reversed(self.started):
            program.end()
        if self.keeper:
            self.keeper.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
