"""deploy/python/install.sh: bridge_install_test.py BUILD FOLDER [CMAKE]

A folder of wheels is filled once, from PyPI and this tree (with the analysis library of BUILD);
from it the bridge is installed without a network, twice, and starts; its unit is right. The same
on a host with systemd and without a network: nothing runs unless it is configured, the results of a
run come to the broker, a bridge that is killed or hangs is started again by systemd, wrong settings
are not tried again, and it stops with success. Skips where the wheels, or such a host, cannot be
had.
"""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(TOP / "tests/systemd"))
from bridge_peers import messages_in, wait_until  # noqa: E402
from systemd_host import Failure, SystemdHost, why_not  # noqa: E402

INSTALL = TOP / "deploy/python/install.sh"
SKIPPED = 77
PATIENCE_S = 1500


def install(*words):
    no_index = {"PIP_INDEX_URL": "http://127.0.0.1:9/", "PIP_RETRIES": "0"}
    settings = {"DYNCAL_BUILT": str(BUILD), "PYTHON": sys.executable}
    environment = {**os.environ, **settings, **({} if "--make-wheels" in words else no_index)}
    return subprocess.run(
        [INSTALL, *map(str, words)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )


class Installation(unittest.TestCase):
    def test_it_is_installed_from_wheels(self):
        prefix = FOLDER / "prefix"
        shutil.rmtree(prefix, ignore_errors=True)
        first = install("--prefix", prefix, "--wheels", WHEELS, "--plugs", "mqtt,foxglove")
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertIn("environment for mqtt,foxglove", first.stdout)
        self.assertEqual(first.stdout.count("installed"), 2, first.stdout)
        again = install("--prefix", prefix, "--wheels", WHEELS, "--plugs", "mqtt,foxglove")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("is as it should be", again.stdout)
        self.assertNotIn("installed", again.stdout)
        self.check_program(prefix / "bin/dyncal-bridge")
        self.check_closed_python(prefix, again)
        self.check_unit(prefix)

    def check_closed_python(self, prefix, last):
        """Who may go on to the unit is told so, who may not is told why."""
        places = (prefix / "bin", pathlib.Path(sys.executable))
        closed = [
            above
            for one in places
            for above in one.resolve().parents
            if not above.stat().st_mode & 1
        ]
        self.assertEqual("next: " in last.stdout, not closed, last.stdout)
        if closed:
            self.assertIn("systemd cannot start it, since only", last.stderr)

    def check_program(self, program):
        settings = FOLDER / "bridge.toml"
        settings.write_text("[mqtt]\n[foxglove]\n")
        done = subprocess.run([program, settings, "--check"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("hands on to foxglove, mqtt", done.stdout)
        settings.write_text("[opcua]\n")
        done = subprocess.run([program, settings, "--check"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("[opcua] needs the Python package asyncua: pip install", done.stderr)

    def check_unit(self, prefix):
        unit = prefix / "lib/systemd/system/dyncal-bridge.service"
        self.assertIn(f"ExecStart={prefix}/bin/dyncal-bridge /etc/", unit.read_text())
        if not shutil.which("systemd-analyze"):
            print("skipped: the unit is not verified without systemd-analyze")
            return
        done = subprocess.run(
            ["systemd-analyze", "verify", unit], capture_output=True, text=True, check=False
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_one_for_a_secured_laboratory(self):
        if not any(pathlib.Path("/usr/lib").rglob("libddsc.so")):
            print("SKIPPED: nothing is secured without Debian's cyclonedds-dev")
            self.skipTest("no cyclonedds-dev")
        prefix = FOLDER / "secured"
        for folder in (SECURED_WHEELS, prefix):
            shutil.rmtree(folder, ignore_errors=True)
        made = install("--make-wheels", SECURED_WHEELS, "--secured", "--plugs", "mqtt")
        self.assertEqual(made.returncode, 0, made.stderr)
        done = install("--prefix", prefix, "--wheels", SECURED_WHEELS, "--plugs", "mqtt")
        self.assertEqual(done.returncode, 0, done.stderr)
        settings, authority = FOLDER / "bridge.toml", FOLDER / "authority"
        settings.write_text("[mqtt]\n")
        shutil.rmtree(authority, ignore_errors=True)
        folder = prefix / "watcher"
        dyncal = [BUILD / "bin/dyncal", "security"]
        subprocess.run([*dyncal, "init", authority, "--laboratory", "Test"], check=True)
        issue = ["issue", authority, "watcher", "--output", folder]
        subprocess.run([*dyncal, *issue], check=True)
        words = [prefix / "bin/dyncal-bridge", settings, "--check", "--security", folder]
        checked = subprocess.run(words, capture_output=True, text=True)
        self.assertEqual((checked.returncode, checked.stderr), (0, ""))
        self.assertIn(f"hands on to mqtt, secured by {folder}", checked.stdout)

    def test_wrong_options_are_refused(self):
        cases = {
            ("--plugs", "smoke"): (1, "'smoke' is none of foxglove, mqtt, opcua"),
            ("--prefx", "x"): (2, "'--prefx' is none of --prefix"),
            ("--prefix",): (1, "--prefix needs a value"),
            ("--wheels", FOLDER): (1, "holds no wheel of dyncal-bridge"),
            ("--secured", "--wheels", WHEELS): (1, "holds no cyclonedds 0.10.5; fill it by"),
        }
        for words, (status, sentence) in cases.items():
            done = install(*words)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertIn(sentence, done.stderr)


SYSTEM_USER = TOP / "deploy/debian/dyncal-daemons.sysusers"
UNIT = "dyncal-bridge"
DOMAIN = 7  # the host's network is its own
# The unit allows 30 s to a bridge that does not turn.
IMPATIENT = "[Service]\nWatchdogSec=6\nTimeoutStopSec=4\n"
BROKER = "/run/broker.conf"


def python_of_host():
    """Of the version that the wheels are for, and not in a home."""
    return shutil.which(f"python3.{sys.version_info.minor}", path="/usr/bin:/usr/local/bin")


def install_on(host, wheels, *more):
    python = f"PYTHON={python_of_host()}"
    done = host.call("env", python, INSTALL, "--wheels", wheels, *more)
    if done.returncode != 0 or "next: " not in done.stdout:
        raise AssertionError(f"install.sh on the host: {done.stdout}{done.stderr}")


class Service(unittest.TestCase):
    """The unit under a systemd of its own, with Debian's mosquitto beside it."""

    @classmethod
    def setUpClass(cls):
        missing = "" if python_of_host() else "no Python of this version is in /usr/bin"
        if not shutil.which("mosquitto_sub"):
            missing = "there is no mosquitto"
        if reason := why_not() or missing:
            print(f"SKIPPED: the unit is not tried: {reason}")
            raise unittest.SkipTest(reason)
        folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-bridge-unit-"))
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
        try:
            cls.host = SystemdHost(folder, BUILD, CMAKE)
        except Failure as failure:
            print(f"SKIPPED: systemd does not start here: {failure}")
            raise unittest.SkipTest("no systemd") from failure
        cls.addClassCleanup(cls.host.close)
        cls.shared = cls.host.shared
        install_on(cls.host, WHEELS)

    def test_the_unit(self):
        host = self.host
        host.write("etc/dyncal/options", f"DYNCAL_OPTIONS=--domain {DOMAIN}\n")
        host.write(f"etc/systemd/system/{UNIT}.service.d/impatient.conf", IMPATIENT)
        host.systemctl("daemon-reload")
        host.systemctl("start", UNIT)
        self.assertEqual(self.state(), "inactive")
        self.assertEqual(host.show(UNIT, "ConditionResult"), "no")
        host.write(BROKER, "listener 1883 127.0.0.1\nallow_anonymous true\n")
        broker = subprocess.Popen(host.command("mosquitto", "-c", BROKER))
        self.addCleanup(broker.wait)
        self.addCleanup(broker.kill)
        settings = '[mqtt]\nbroker = "127.0.0.1:1883"\n[foxglove]\n[opcua]\n'
        host.write("etc/dyncal/bridge.toml", settings)
        if host.call("systemctl", "start", UNIT).returncode != 0:
            self.fail(f"{UNIT} does not start: {host.journal(UNIT)[-3000:]}")
        self.assertEqual(self.state(), "active")
        print(f"{UNIT}: {host.show(UNIT, 'StatusText')}")
        self.wait_for_journal("connected to 127.0.0.1")
        self.a_run_comes_to_the_broker()
        self.is_started_again_after(signal.SIGKILL)
        self.is_started_again_after(signal.SIGSTOP)
        host.systemctl("stop", UNIT)
        self.assertEqual((self.state(), host.show(UNIT, "Result")), ("inactive", "success"))
        host.write("etc/dyncal/bridge.toml", "[smoke]\n")
        self.assertNotEqual(host.call("systemctl", "start", UNIT).returncode, 0)
        self.assertEqual((self.state(), self.restarts()), ("failed", 0))
        self.assertIn("smoke", host.journal(UNIT))

    def test_the_unit_of_a_secured_laboratory(self):
        """Its folder belongs to the user of the unit: such a host hands on no credentials."""
        if not SECURED_WHEELS.exists():
            self.skipTest("there are no wheels of a secured one")
        host, keys = self.host, "/etc/dyncal/keys"
        authority = self.shared / "authority"
        for words in (
            ("init", authority, "--laboratory", "Test"),
            ("issue", authority, "watcher", "--output", keys),
            ("issue", authority, "web", "--output", self.shared / "web"),
            ("revoke", authority, "web"),
        ):
            done = host.call("dyncal", "security", *words)
            self.assertEqual(done.returncode, 0, done.stderr)
        host.write("etc/sysusers.d/dyncal.conf", SYSTEM_USER.read_text(encoding="utf-8"))
        host.call("systemd-sysusers")
        host.call("chown", "-R", "dyncal", keys)
        drop_in = f"/etc/systemd/system/{UNIT}.service.d/security.conf"
        host.write(drop_in, f"[Service]\nEnvironment=DYNCAL_SECURITY={keys}\n")
        host.write("etc/dyncal/bridge.toml", "[mqtt]\n")
        host.write("etc/dyncal/options", f"DYNCAL_OPTIONS=--domain {DOMAIN + 1}\n")
        install_on(host, SECURED_WHEELS, "--plugs", "mqtt")
        host.systemctl("daemon-reload")
        self.addCleanup(host.call, "rm", "-r", drop_in, keys)
        if host.call("systemctl", "start", UNIT).returncode != 0:
            self.fail(f"{UNIT} does not start: {host.journal(UNIT)[-3000:]}")
        self.assertEqual(self.state(), "active")
        before = host.show(UNIT, "MainPID")
        host.call("cp", authority / "revoked.pem", f"{keys}/revoked.pem")
        self.wait_for_journal("joining anew")
        wait_until(lambda: host.journal(UNIT).count("hands on to mqtt") == 2, "it to be back")
        self.assertEqual((host.show(UNIT, "MainPID"), self.restarts()), (before, 0))
        host.systemctl("stop", UNIT)

    def a_run_comes_to_the_broker(self):
        demo = ["dyncal", "demo", "--domain", DOMAIN, "--output", self.shared / "demo"]
        done = self.host.call(*demo, "--repetitions", 1)
        self.assertEqual(done.returncode, 0, done.stderr)
        (result,) = self.shared.rglob("result.json")
        stated = {
            (point["channel"], point["step"]): point["magnitude"]
            for point in json.loads(result.read_text())["points"]
        }
        self.assertGreater(len(stated), 10)
        wait_until(lambda: self.points().keys() == stated.keys(), "all points at the broker")
        self.assertEqual(self.points(), stated)

    def points(self):
        """What is retained of them."""
        words = ["mosquitto_sub", "-v", "-t", "dyncal/benches/+/points/#", "--retained-only"]
        seen = self.host.call(*words, "-W", 2).stdout
        return {(m["channel"], m["step"]): m["magnitude"] for _, m in messages_in(seen)}

    def is_started_again_after(self, number):
        before = self.restarts()
        self.host.signal_unit(UNIT, number)
        wait_until(
            lambda: self.restarts() == before + 1 and self.state() == "active",
            f"systemd to start the bridge again after {number.name}",
        )

    def wait_for_journal(self, text):
        wait_until(lambda: text in self.host.journal(UNIT), f"'{text}' in the journal")

    def state(self):
        return self.host.show(UNIT, "ActiveState")

    def restarts(self):
        return int(self.host.show(UNIT, "NRestarts"))


def make_wheels():
    for wheels in (WHEELS, SECURED_WHEELS):
        shutil.rmtree(wheels, ignore_errors=True)  # of an earlier tree
    done = install("--make-wheels", WHEELS)
    if done.returncode != 0:
        print(f"SKIPPED: the wheels cannot be had: {done.stderr[-1000:]}")
        sys.exit(SKIPPED)
    print(done.stdout)


if __name__ == "__main__":
    BUILD, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    WHEELS, SECURED_WHEELS = FOLDER / "wheels", FOLDER / "secured-wheels"
    make_wheels()
    CMAKE = sys.argv[3] if len(sys.argv) > 3 else "cmake"
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
