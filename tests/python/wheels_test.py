"""Wheels that need no dyncal, made by deploy/python/wheels.sh: wheels_test.py FOLDER

With this Python and with the first of 3.12 and later that the machine has, in an environment with
nothing but numpy: names and tags, size, no foreign library, the bits of the wheel under test, and
what dyncal.models says where Ceres is missing. Minutes: the analysis library is compiled.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest
import zipfile

import drawn_records

import dyncal

TOP = pathlib.Path(__file__).resolve().parents[2]
MAX_BYTES = 2_000_000
FITS = """
import json, sys
import numpy as np
import dyncal
stamps_ns, values = np.load(sys.argv[1]), np.load(sys.argv[2])
fit = dyncal.fit_sine(sys.argv[3], stamps_ns, values)
try:
    import dyncal.models
    said = ""
except ImportError as error:
    said = str(error)
numbers = [fit.sine, fit.cosine, fit.offset, fit.u_amplitude]
print(json.dumps({"fit": [number.hex() for number in numbers], "models": said}))
"""


def base_of(python):
    """The interpreter that an environment is of."""
    return pathlib.Path(python).resolve()


def later_python():
    """The first interpreter of 3.12 or later that there is."""
    found = [shutil.which(f"python3.{minor}") for minor in range(12, 20)]
    home = pathlib.Path.home() / ".pyenv/versions"
    found += sorted(map(str, home.glob("3.1[2-9]*/bin/python3")))
    for python in filter(None, found):
        done = subprocess.run(
            [python, "-c", "import ensurepip, venv"], capture_output=True, check=False
        )
        if done.returncode == 0:
            return python
    return None


class Wheels(unittest.TestCase):
    def made(self, python):
        shutil.rmtree(FOLDER, ignore_errors=True)
        done = subprocess.run(
            [TOP / "deploy/python/wheels.sh", FOLDER, python],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "CMAKE_BUILD_PARALLEL_LEVEL": "2"},
        )
        self.assertEqual(done.returncode, 0, done.stderr[-3000:])
        print(done.stdout.strip())
        [wheel] = FOLDER.glob("*.whl")
        return wheel

    def check(self, wheel, python):
        self.assertLess(wheel.stat().st_size, MAX_BYTES)
        names = zipfile.ZipFile(wheel).namelist()
        foreign = [name for name in names if ".so" in name and "_dyncal" not in name]
        self.assertEqual(foreign, [])
        for name in ("dyncal/py.typed", "dyncal/_dyncal.pyi", "dyncal/dds/types.py"):
            self.assertIn(name, names)
        environment = FOLDER / "environment"
        subprocess.run([python, "-m", "venv", "--clear", environment], check=True)
        inside = environment / "bin/python3"
        subprocess.run([inside, "-m", "pip", "install", "-q", wheel], check=True)
        record = drawn_records.Record(0)
        values = record.channels["x"]
        (FOLDER / "fits.py").write_text(FITS)
        for name, array in (("stamps", record.stamps_ns), ("values", values)):
            drawn_records.np.save(FOLDER / f"{name}.npy", array)
        words = [FOLDER / "fits.py", FOLDER / "stamps.npy", FOLDER / "values.npy", record.frequency]
        said = json.loads(subprocess.check_output([inside, *words], cwd=FOLDER))
        ours = dyncal.fit_sine(record.frequency, record.stamps_ns, values)
        numbers = [ours.sine, ours.cosine, ours.offset, ours.u_amplitude]
        self.assertEqual(said["fit"], [number.hex() for number in numbers])
        self.assertRegex(said["models"], r"^dyncal\.models: .*without Ceres;.*DYNCAL_MODELS=ON")

    def test_a_wheel_of_this_python(self):
        python = base_of(sys.executable)
        wheel = self.made(python)
        tag = "cp311-cp311" if sys.version_info < (3, 12) else "cp312-abi3"
        self.assertTrue(re.search(rf"{tag}-manylinux_2_\d+_x86_64", wheel.name), wheel.name)
        self.check(wheel, python)

    def test_a_wheel_with_the_stable_abi(self):
        python = later_python()
        if python is None:
            print("SKIPPED: there is no Python 3.12 or later on this machine")
            self.skipTest("no Python 3.12")
        wheel = self.made(python)
        self.assertTrue(re.search(r"cp312-abi3-manylinux_2_\d+_x86_64", wheel.name), wheel.name)
        self.check(wheel, python)


if __name__ == "__main__":
    FOLDER = pathlib.Path(sys.argv[1]).resolve()
    unittest.main(argv=sys.argv[:1])
