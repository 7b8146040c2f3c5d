"""A laboratory for `dyncal doctor`: programs on hosts, network namespaces with names of their own.

The doctor runs on HERE. Needs root, ip, nft and unshare.
"""

import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from bench_laboratory import Failure  # noqa: E402
from hosts import Hosts  # noqa: E402

DOMAIN = 45
READY_S = 60.0
HERE, THERE = "lab-1", "lab-2"
ADDRESS = {HERE: "10.98.0.1", THERE: "10.98.0.2", "lab-3": "10.98.0.3"}
BENCH = """
bench = "{bench}"
[excitation]
frequencies_hz = ["10"]
level = 1.0
[sources.acs]
driver = "file"
path = "record.csv"
serial = "7"
units = {{ reference = "m/s^2", dut = "V" }}
[method]
kind = "analogue"
reference = "acs/reference"
dut = ["acs/dut"]
"""


class Laboratory:
    """Programs on hosts; `close()` ends all."""

    def __init__(self, programs, hosts=(HERE, THERE), domain=DOMAIN):
        self.programs = programs
        self.domain = domain
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-doctor-"))
        self.hosts = Hosts(hosts)
        self.names = {host: host for host in hosts}
        self.running = []
        record = "t_ns,reference,dut\n0,0,0\n1000000,1,1\n2000000,0,0\n"
        (self.folder / "record.csv").write_text(record, encoding="utf-8")

    def bench(self, name="netns"):
        path = self.folder / f"{name}.toml"
        path.write_text(BENCH.format(bench=name), encoding="utf-8")
        return path

    def on(self, host, *command):
        named = ["unshare", "--uts", "sh", "-c", 'hostname "$0"; exec "$@"', self.names[host]]
        return [*self.hosts.command(host), *named, *map(str, command)]

    def start(self, host, program, *arguments, environment=None):
        """A daemon that serves once this returns."""
        command = [self.programs / program, *arguments, "--domain", self.domain]
        log = self.folder / f"{len(self.running)}.log"
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            manager.bind(str(log.with_suffix(".notify")))
            manager.settimeout(READY_S)
            told = {**(environment or {}), "NOTIFY_SOCKET": manager.getsockname()}
            self.run_on(self.on(host, *command), log, told)
            try:
                while b"READY=1" not in manager.recv(4096):
                    pass
            except TimeoutError as late:
                raise Failure(f"{program} does not serve: {log.read_text('utf-8')}") from late

    def run_on(self, command, log, environment=None):
        with open(log, "w", encoding="utf-8") as stderr:
            self.running.append(
                subprocess.Popen(
                    command,
                    stdout=stderr,
                    stderr=stderr,
                    cwd=self.folder,
                    env={**os.environ, **(environment or {})},
                )
            )

    def nft(self, host, rule):
        """Drops what comes to this host and fits `rule`."""
        chain = f"chain input {{ type filter hook input priority 0; iifname lab {rule} drop; }}"
        name = f"doctor{len(list(self.folder.glob('*.nft')))}"
        (self.folder / f"{name}.nft").touch()
        words = [*self.hosts.command(host), "nft", f"table ip {name} {{ {chain}; }}"]
        subprocess.run(words, check=True)

    def doctor(self, *arguments, seconds=5, environment=None):
        """The report; where it could not look, its sentence as a problem."""
        command = [self.programs / "dyncal", "doctor", "--json", "--seconds", seconds, *arguments]
        if "--domain" not in arguments:
            command += ["--domain", self.domain]
        done = subprocess.run(
            self.on(HERE, *command),
            check=False,
            capture_output=True,
            text=True,
            cwd=self.folder,
            env={**os.environ, **(environment or {})},
        )
        if not done.stdout.startswith("{"):
            return {"findings": [{"severity": "problem", "check": "", "sentence": done.stderr}]}
        return json.loads(done.stdout)

    def close(self):
        for one in self.running:
            one.kill()
        for one in self.running:
            one.wait()
        self.hosts.close()
        shutil.rmtree(self.folder)
