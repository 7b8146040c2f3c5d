"""A run of a demo, exported, as other programs read it: values equal to the last bit.

exported_recording_test.py PROGRAMS PUBLISHER FOLDER [RECORDING...]; with RECORDINGS (.mcap) these
are taken in place of a demo. Needs h5py and numpy in Debian's interpreter, else it is skipped.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

PATIENCE_S = 300
# Debian's interpreter by its path: another python3 may be in PATH.
PYTHON = "/usr/bin/python3"
COMPARE = pathlib.Path(__file__).resolve().with_name("exported_values.py")

class ExportedRecording(unittest.TestCase):
    def setUp(self):
        self.dyncal = pathlib.Path(ARGUMENTS[0]) / "dyncal"
        self.folder = pathlib.Path(ARGUMENTS[2])
        probe = subprocess.run([PYTHON, "-c", "import h5py"], capture_output=True, check=False)
        if probe.returncode != 0:
            self.skipTest("SKIPPED: no h5py (Debian: python3-h5py)")
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)

    def run_dyncal(self, *arguments, status=(0,)):
        done = subprocess.run(
            [str(self.dyncal), *map(str, arguments)],
            capture_output=True,
            text=True,
            check=False,
            timeout=PATIENCE_S,
        )
        self.assertIn(done.returncode, status, done.stderr)
        return done

    def recorded_demo(self):
        self.run_dyncal(
            *("demo", "--preset", "mpu9250-ptb", "--repetitions", "1", "--duration", "0.5"),
            *("--domain", own_dds_domain()),
            *("--output", self.folder / "demo", "--folder", self.folder / "runs"),
            status=(0, 1),
        )
        recordings = sorted((self.folder / "runs").glob("*/*/recording.mcap"))
        self.assertEqual(len(recordings), 1)
        return recordings

    def check(self, recording, name):
        exported = {
            "h5": self.folder / f"{name}.h5",
            "npz": self.folder / f"{name}.npz",
            "csv": self.folder / name,
            "rows": self.folder / f"{name}-rows.mcap",
        }
        for target in exported.values():
            self.run_dyncal("export", recording, "--output", target)
        refused = self.run_dyncal("analyse", exported["h5"], status=(1, 2))
        self.assertIn("the recording (.mcap)", refused.stderr)
        compared = subprocess.run(
            [PYTHON, str(COMPARE), *map(str, exported.values())],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(compared.returncode, 0, compared.stderr)
        figures = json.loads(compared.stdout)
        print(name, figures)
        self.assertGreater(figures["samples"], 1000)
        self.assertGreater(figures["values"], figures["samples"])

    def test_gives_the_same_values(self):
        recordings = list(map(pathlib.Path, ARGUMENTS[3:])) or self.recorded_demo()
        for number, recording in enumerate(recordings):
            with self.subTest(recording=str(recording)):
                self.check(recording, f"export-{number}")


if __name__ == "__main__":
    ARGUMENTS = sys.argv[1:]
    unittest.main(argv=sys.argv[:1])
