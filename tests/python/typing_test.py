"""`mypy --strict` is content with the package and with a program that uses it:
typing_test.py FOLDER"""

import importlib.resources
import pathlib
import subprocess
import sys
import unittest

PROGRAM = """
import numpy
import dyncal
import dyncal.acs
from dyncal import dds

t = numpy.arange(1000, dtype=numpy.int64)
y = numpy.zeros(1000)
one: dyncal.SineFit = dyncal.fit_sine("80", t, y, reference_ns=5)
several: list[dyncal.SineFit] = dyncal.fit_sine(80.0, t, [y, y])
named: dict[str, dyncal.SineFit] = dyncal.fit_sine("80", t, {"z": y})
phasor: complex = one.phasor
rows: list[str] = [row.name for row in dyncal.evaluate_analogue(
    "80", stamps_ns=t, reference=dyncal.Channel("r", y), dut=[dyncal.Channel("z", y)]
).points[0].budget]
frame = dyncal.read_result("result.json").to_pandas()
samples = dyncal.read_recording("run").source("dau")["z"]
for result in dds.Reader("CalibrationResult").messages(timeout_s=1):
    print(result.magnitude)
dds.types.SampleBlock(bench="a", source="b", values=[1.0]).stamps_ns.append(1)
try:
    pass
except dyncal.Error as error:
    code: str = error.code
"""
MISTAKES = {
    "dyncal.fit_sine(t, y)": "fit_sine",
    "dyncal.fit_sine('80', t, y).amplitud": "amplitud",
    "x: int = dyncal.fit_sine('80', t, y).phasor": "int",
    "dyncal.dds.types.SampleBlock(bench=1)": "bench",
}


class Typing(unittest.TestCase):
    def check(self, *what):
        words = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(FOLDER / "cache")]
        return subprocess.run(
            [*words, *map(str, what)], cwd=FOLDER, capture_output=True, text=True, check=False
        )

    def test_the_package_is_clean(self):
        done = self.check("-p", "dyncal")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertTrue(importlib.resources.files("dyncal").joinpath("py.typed").is_file())

    def test_the_bridge_is_clean(self):
        folder = pathlib.Path(__file__).resolve().parents[2] / "deploy/python/bridge"
        done = self.check(
            "--config-file", folder / "pyproject.toml", folder / "dyncal_bridge"
        )
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_program_is_checked(self):
        (FOLDER / "program.py").write_text(PROGRAM)
        done = self.check("program.py")
        self.assertEqual(done.returncode, 0, done.stdout)
        wrong = "import dyncal, numpy\nimport dyncal.dds.types\n"
        wrong += "t = numpy.arange(9, dtype=numpy.int64)\ny = numpy.zeros(9)\n"
        (FOLDER / "wrong.py").write_text(wrong + "\n".join(MISTAKES) + "\n")
        said = self.check("wrong.py").stdout
        for number, word in enumerate(MISTAKES.values(), 5):
            line = [one for one in said.splitlines() if one.startswith(f"wrong.py:{number}:")]
            self.assertTrue(line and any(word in one for one in line), (word, said))


if __name__ == "__main__":
    FOLDER = pathlib.Path(sys.argv[1]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
