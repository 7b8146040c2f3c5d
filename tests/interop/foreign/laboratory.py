"""Two hosts in network namespaces of their own, joined by a link that may lose packets: dyncal's
programs on one, the stack that is tried on the other. Needs root, ip and nft."""

import contextlib
import os
import shutil
import signal
import subprocess
import time

DOMAIN = "46"
ADDRESSES = ("10.98.0.1", "10.98.0.2")
PATIENCE_S = 60
BENCH = """\
bench = "interop"
[excitation]
frequencies_hz = ["20", "40", "80"]
level = 10.0
repetitions = 1
settling_s = 0.5
duration_s = 1.0
[generator]
driver = "scpi"
address = "127.0.0.1:5025"
level_per_volt = 50.0
maximum_level_m_s2 = 20.0
[sources.dau]
driver = "smartup"
listen = "127.0.0.1:7654"
sensor = "0xbccb0100"
channels = { Data_11 = "sync" }
[sources.acs]
driver = "socket"
address = "127.0.0.1:5026"
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
VIRTUAL_BENCH = [
    *("--frequencies", "20,40,80", "--levels", "10", "--acs-listen", "127.0.0.1:5026"),
    *("--generator-listen", "127.0.0.1:5025", "--dau", "127.0.0.1:7654"),
]


class CannotBeSetUp(Exception):
    """Why something could not be tried."""


class Laboratory:
    """dyncal's host is `own`, that of the stacks `other`; everything ends with the block."""

    def __init__(self, programs, folder, loss_percent):
        self.programs, self.folder, self.loss_percent = programs, folder, loss_percent
        self.own, self.other = f"dyncal-o-{os.getpid()}", f"dyncal-f-{os.getpid()}"
        self.processes = []

    def __enter__(self):
        if os.geteuid() != 0 or not shutil.which("ip") or not shutil.which("nft"):
            raise CannotBeSetUp("it needs root, ip and nft")
        self.folder.mkdir(parents=True, exist_ok=True)
        try:
            self.make_link()
        except CannotBeSetUp:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            self.end(process)
        for name in (self.own, self.other):
            subprocess.run(["ip", "netns", "delete", name], stderr=subprocess.DEVNULL, check=False)

    def make_link(self):
        network = [["ip", "netns", "add", name] for name in (self.own, self.other)]
        network.append(
            ["ip", "-n", self.own, "link", "add", "lab", "type", "veth"]
            + ["peer", "name", "lab", "netns", self.other]
        )
        for name, address in zip((self.own, self.other), ADDRESSES, strict=True):
            in_namespace = ["ip", "-n", name]
            network.append([*in_namespace, "link", "set", "lo", "up"])
            network.append([*in_namespace, "address", "add", f"{address}/24", "dev", "lab"])
            network.append([*in_namespace, "link", "set", "lab", "up"])
            if self.loss_percent:
                network.append(
                    ["ip", "netns", "exec", name, "nft", "table ip lossy { chain input { "]
                )
                network[-1][-1] += (
                    "type filter hook input priority 0; iifname lab meta l4proto udp "
                    f"numgen random mod 100 < {self.loss_percent} counter drop; }}; }}"
                )
        for words in network:
            done = subprocess.run(words, capture_output=True, text=True, check=False)
            if done.returncode:
                raise CannotBeSetUp(f"{' '.join(words[:6])}: {done.stderr.strip()}")
        for name in (self.own, self.other):
            self.wait_for_link(name)

    def wait_for_link(self, namespace):
        """The kernel says up to a second later that a link is up; until then Fast DDS and dust-dds
        find no network, and do not look again."""
        deadline = time.monotonic() + PATIENCE_S
        while not self.link_is_up(namespace):
            if time.monotonic() > deadline:
                raise CannotBeSetUp(f"the link of {namespace} does not come up")
            time.sleep(0.05)

    @staticmethod
    def link_is_up(namespace):
        shown = subprocess.run(
            ["ip", "-n", namespace, "-o", "link", "show", "lab"],
            capture_output=True,
            text=True,
            check=False,
        )
        return "state UP" in shown.stdout

    def start(self, name, namespace, words, ready=None, environment=None):
        """A program and its log; waits for `ready` in it."""
        path = self.folder / f"{name}.log"
        with open(path, "w", encoding="utf-8") as log:
            process = subprocess.Popen(
                ["ip", "netns", "exec", namespace, *map(str, words)],
                stdout=log,
                stderr=subprocess.STDOUT if ready else open(f"{path}.err", "w"),
                cwd=self.folder,
                env={**os.environ, **(environment or {})},
                start_new_session=True,
            )
        process.log = path
        self.processes.append(process)
        deadline = time.monotonic() + PATIENCE_S
        while ready and ready not in path.read_text(errors="replace"):
            if process.poll() is not None or time.monotonic() > deadline:
                raise CannotBeSetUp(f"{name} is not ready: {path.read_text()[-300:]}")
            time.sleep(0.05)
        return process

    def end(self, process):
        """Politely, then not."""
        for wanted, patience_s in ((signal.SIGINT, 15), (signal.SIGKILL, 15)):
            if process.poll() is None:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, wanted)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(patience_s)

    def dyncal(self, *words, patience_s=PATIENCE_S):
        """What a command on dyncal's host prints, and its exit status."""
        done = subprocess.run(
            ["ip", "netns", "exec", self.own, str(self.programs / "dyncal"), *map(str, words)],
            capture_output=True,
            text=True,
            check=False,
            cwd=self.folder,
            timeout=patience_s,
        )
        return done.returncode, done.stdout + done.stderr

    def serve(self):
        """A virtual bench with its services; they go on until the block ends."""
        (self.folder / "bench.toml").write_text(BENCH)
        network = ["--domain", DOMAIN, "--interface", "lab"]
        bench = self.programs / "dyncal-virtual-bench"
        self.start("virtual-bench", self.own, [bench, *VIRTUAL_BENCH])
        self.start(
            *("analysis", self.own, [self.programs / "dyncal-analysis", *network]),
            ready="analysis ready",
        )
        for name, ready in (("acs", ", source "), ("dau", " is there, from ")):
            words = [self.programs / f"dyncal-{name}", "bench.toml", *network]
            self.start(name, self.own, words, ready=ready)

    def run(self):
        """One run of the bench; its result file."""
        words = ["run", "bench.toml", "--domain", DOMAIN, "--interface", "lab"]
        output = self.folder / "result.json"
        output.unlink(missing_ok=True)
        status, said = self.dyncal(*words, "--output", output, patience_s=3 * PATIENCE_S)
        if not output.exists():
            raise CannotBeSetUp(f"dyncal run: {status}: {said[-300:]}")
        return output

    def lost_packets(self):
        rules = subprocess.run(
            ["ip", "netns", "exec", self.other, "nft", "list", "table", "ip", "lossy"],
            capture_output=True,
            text=True,
            check=False,
        ).stdout.split()
        return int(rules[rules.index("packets") + 1]) if "packets" in rules else 0
