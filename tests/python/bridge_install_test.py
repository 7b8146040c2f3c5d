"""deploy/python/install.sh: bridge_install_test.py BUILD FOLDER

A folder of wheels is filled once, from PyPI and this tree (with the analysis library of BUILD);
from it the bridge is installed without a network, twice, and starts; its unit is right. Skips where
the wheels cannot be had.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
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
        self.check_unit(prefix)

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

    def test_wrong_options_are_refused(self):
        cases = {
            ("--plugs", "smoke"): (1, "'smoke' is none of foxglove, mqtt, opcua"),
            ("--prefx", "x"): (2, "'--prefx' is none of --prefix"),
            ("--prefix",): (1, "--prefix needs a value"),
            ("--wheels", FOLDER): (1, "holds no wheel of dyncal-bridge"),
        }
        for words, (status, sentence) in cases.items():
            done = install(*words)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertIn(sentence, done.stderr)


def make_wheels():
    if list(WHEELS.glob("dyncal_bridge-*.whl")):
        shutil.rmtree(WHEELS)  # of an earlier tree
    done = install("--make-wheels", WHEELS)
    if done.returncode != 0:
        print(f"SKIPPED: the wheels cannot be had: {done.stderr[-1000:]}")
        sys.exit(SKIPPED)
    print(done.stdout)


if __name__ == "__main__":
    BUILD, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    WHEELS = FOLDER / "wheels"
    make_wheels()
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
