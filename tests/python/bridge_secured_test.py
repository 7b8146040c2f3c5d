"""dyncal-bridge in a secured laboratory: bridge_secured_test.py PROGRAMS FOLDER

With version 0.10 of cyclonedds on Debian's library, and a folder of role watcher: the broker gets
the values of the result file, and the run is that of `dyncal analyse` to the last bit. Who has no
folder, or one of another authority, hears nothing; a list of revoked certificates that has become
another one makes the bridge join anew.
"""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests/faults"), str(TOP / "tests/python")]
from bridge_peers import PACKAGE, Broker, Process, messages_in, wait_until  # noqa: E402
from played_laboratory import PlayedLaboratory  # noqa: E402

BENCH = "played"
SAMPLES = 'samples = ["*/dau/acceleration_z"]\nmax_rate_hz = 10_000\n'


def dyncal(*words):
    subprocess.run([PROGRAMS / "dyncal", *map(str, words)], check=True, capture_output=True)


def make_authority(folder):
    """An authority, and a folder for each program of a run."""
    folder.mkdir(parents=True)
    dyncal("security", "init", folder / "authority", "--laboratory", "Test")
    for role in ("analysis", "source", "operator", "watcher"):
        bench = ["--bench", BENCH] if role in ("source", "operator") else []
        dyncal("security", "issue", folder / "authority", role, *bench, "--output", folder / role)


class Secured(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(FOLDER, ignore_errors=True)
        make_authority(FOLDER / "own")
        make_authority(FOLDER / "other")
        cls.laboratory = PlayedLaboratory(PROGRAMS, FOLDER / "laboratory", "cyclonedds")
        cls.addClassCleanup(cls.laboratory.close)
        cls.laboratory.service("dyncal-analysis", cls.secured_as("analysis"))
        cls.laboratory.service("dyncal-acs", cls.secured_as("source"))
        cls.bridges = {
            name: cls.start_bridge(name, *words)
            for name, words in (
                ("watcher", ("--security", FOLDER / "own/watcher")),
                ("stranger", ("--security", FOLDER / "other/watcher")),
                ("open", ()),
            )
        }
        broker, folder = cls.bridges["watcher"][1:]
        cls.samples = broker.subscriber(folder / "samples.log", "dyncal/benches/+/samples/#")
        cls.addClassCleanup(cls.samples.end)
        run = cls.laboratory.run(cls.secured_as("operator"))
        cls.laboratory.expect_same_bits(run)
        result = json.loads((cls.laboratory.folder / "run.json").read_text())
        cls.stated = {
            (point["channel"], point["step"], point["repetition"]): point["magnitude"]
            for point in result["points"]
        }

    @classmethod
    def secured_as(cls, role):
        return {"DYNCAL_SECURITY": str(FOLDER / "own" / role)}

    @classmethod
    def start_bridge(cls, name, *words):
        """With a broker of its own."""
        folder = FOLDER / name
        broker = Broker(folder)
        cls.addClassCleanup(broker.end)
        settings = folder / "bridge.toml"
        settings.write_text(f'[mqtt]\nbroker = "127.0.0.1:{broker.port}"\n{SAMPLES}')
        python = [sys.executable, "-B", "-m", "dyncal_bridge", settings]
        bridge = Process(
            [*python, "--domain", cls.laboratory.domain, *words],
            folder / "bridge.log",
            env={**os.environ, "PYTHONPATH": f"{os.environ['PYTHONPATH']}:{PACKAGE}"},
        )
        cls.addClassCleanup(bridge.end)
        bridge.wait_for("connected to 127.0.0.1")
        return bridge, broker, folder

    def retained(self, name):
        _, broker, folder = self.bridges[name]
        return broker.retained("dyncal/#", folder)

    def points(self, name):
        found = [m for topic, m in self.retained(name).items() if "/points/" in topic]
        return {(m["channel"], m["step"], m["repetition"]): m["magnitude"] for m in found}

    def test_the_watcher_sees_the_results(self):
        self.assertEqual(len(self.stated), 18)
        wait_until(lambda: self.points("watcher").keys() == self.stated.keys(), "all points")
        self.assertEqual(self.points("watcher"), self.stated)

    def test_the_watcher_sees_the_samples(self):
        with open(self.laboratory.folder / "dau.csv", encoding="utf-8") as lines:
            values = {float(row["acceleration_z"]) for row in csv.DictReader(lines)}
        seen = [v for _, rows in messages_in(self.samples.text()) for v in rows["values"]]
        self.assertGreater(len(seen), 1000)
        self.assertLessEqual(set(seen), values)

    def test_others_see_nothing(self):
        for name in ("stranger", "open"):
            self.assertEqual(self.retained(name), {"dyncal/bridge": {"state": "online"}}, name)

    def test_another_list_of_revoked_certificates(self):
        dyncal("security", "revoke", FOLDER / "own/authority", "operator-played")
        bridge, _, folder = self.bridges["watcher"]
        late = self.bridges["watcher"][1].subscriber(folder / "late.log", "dyncal/bridge")
        self.addCleanup(late.end)
        shutil.copy(FOLDER / "own/authority/revoked.pem", FOLDER / "own/watcher/revoked.pem")
        bridge.wait_for("joining anew")
        wait_until(lambda: bridge.text().count("connected to 127.0.0.1") == 2, "it to be back")
        states = [m["state"] for _, m in messages_in(late.text())]
        self.assertEqual(states[-1], "online")

    def test_a_folder_without_a_key_is_refused(self):
        folder = FOLDER / "keyless"
        shutil.copytree(FOLDER / "own/watcher", folder)
        (folder / "cyclonedds_key.pem").unlink()
        settings = FOLDER / "watcher/bridge.toml"
        done = subprocess.run(
            [sys.executable, "-B", "-m", "dyncal_bridge", settings, "--security", folder],
            capture_output=True,
            text=True,
            env={**os.environ, "PYTHONPATH": f"{os.environ['PYTHONPATH']}:{PACKAGE}"},
        )
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("cyclonedds_key.pem: cannot be read", done.stderr)
        self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    if not shutil.which("mosquitto_sub"):
        print("SKIPPED: there is no mosquitto (Debian: mosquitto, mosquitto-clients)")
        sys.exit(77)
    if not any(pathlib.Path("/usr/lib").rglob("libdds_security_auth.so")):
        print("SKIPPED: this Cyclone DDS has no plug-ins of DDS Security (Debian: libddsc0debian)")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
