#!/usr/bin/env python3
"""`dyncal-convert` against the public libraries: what it makes of a file is read by dyncal as the
library reads the file.

    convert_test.py SERIES_VALUES WORK [TEST...]

Draws DYNCAL_DRAWN_FILES files of each format (4 unless stated) from the seed DYNCAL_FILE_SEED on,
cuts them, and gives others for them. Needs pyuff, obspy, pyarrow, pyxdf and h5py of PyPI, which are
installed into WORK once; skips with a line where they cannot be had.
"""

import os
import pathlib
import random
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "recording")]
PACKAGE = HERE.parents[2] / "deploy/python/convert"
LIBRARIES = ("numpy", "h5py", "pyuff", "obspy", "pyarrow", "pyxdf", "mypy")
SKIPPED = 77
FORMATS = ("uff", "mseed", "parquet", "xdf")
INSTALL_LIMIT_S = 900
PROGRAM, WORK = sys.argv[1], pathlib.Path(sys.argv[2])
SEED = int(os.environ.get("DYNCAL_FILE_SEED", "1"))
COUNT = int(os.environ.get("DYNCAL_DRAWN_FILES", "4"))


def convert(*words):
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "PYTHONWARNINGS": "ignore"}
    return subprocess.run([sys.executable, "-m", "dyncal_convert", *map(str, words)],
                          env=environment, capture_output=True, text=True, check=False)


class Conversion(unittest.TestCase):
    def setUp(self):
        import draw_files  # pylint: disable=import-outside-toplevel
        self.draw = draw_files.DRAW
        self.folder = WORK / self.id().rpartition(".")[2]
        subprocess.run(["rm", "-rf", self.folder], check=True)
        self.folder.mkdir(parents=True)

    def as_dyncal_reads(self, path, series):
        """Channels with units, sample numbers, stamps and values."""
        import numpy as np  # pylint: disable=import-outside-toplevel
        output = self.folder / "ours.values"
        done = subprocess.run([PROGRAM, path, output, "--group", series.group],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        channels = [line.split("\t") for line in done.stdout.splitlines()]
        data = output.read_bytes()
        samples = len(data) // 8 // (2 + len(channels))
        whole = np.frombuffer(data, np.int64)
        values = np.frombuffer(data[16 * samples:], np.float64).reshape(len(channels), samples)
        return dict(map(tuple, channels)), whole[:samples], whole[samples:2 * samples], values

    def check(self, output, series):
        import h5py  # pylint: disable=import-outside-toplevel
        import numpy as np  # pylint: disable=import-outside-toplevel
        units, numbers, stamps, values = self.as_dyncal_reads(output, series)
        self.assertEqual(units, {name: unit for name, (unit, _) in series.channels.items()})
        np.testing.assert_array_equal(numbers - numbers[0], series.numbers - series.numbers[0])
        np.testing.assert_array_equal(stamps, series.stamps_ns)
        for name, row in zip(units, values):
            np.testing.assert_array_equal(row, np.asarray(series.channels[name][1], np.float64))
        with h5py.File(output) as file:
            flags = np.asarray(file[f"RAWDATA/{series.group}/Stamp_flags"])
            self.assertEqual(int((flags != 0).sum()), series.untrusted)

    def check_format(self, kind):
        for seed in range(SEED, SEED + COUNT):
            with self.subTest(format=kind, seed=seed):
                path, output = self.folder / f"{seed}.{kind}", self.folder / f"{seed}.h5"
                expected, options = self.draw[kind](path, seed)
                done = convert(path, output, *options)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(expected)
                for series in expected:
                    self.check(output, series)
                self.assertEqual(list(self.folder.glob("*.part")), [])

    def test_uff58_is_what_pyuff_reads(self):
        self.check_format("uff")

    def test_miniseed_is_what_obspy_reads(self):
        self.check_format("mseed")

    def test_parquet_is_what_pyarrow_reads(self):
        self.check_format("parquet")

    def test_xdf_is_what_pyxdf_reads(self):
        self.check_format("xdf")

    def test_cut_files_are_refused_with_their_place(self):
        for kind in FORMATS:
            path = self.folder / f"cut.{kind}"
            _, options = self.draw[kind](path, SEED)
            whole = path.read_bytes()
            for at in random.Random(SEED).sample(range(1, len(whole) - 1), 4):
                if kind == "mseed" and at % 256 == 0:
                    continue  # a whole file of fewer records
                with self.subTest(format=kind, bytes=at):
                    path.write_bytes(whole[:at])
                    self.check_refused(convert(path, self.folder / "cut.h5", *options), path)

    def check_refused(self, done, path):
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertNotIn("Traceback", done.stderr)
        last = done.stderr.splitlines()[-1]
        self.assertTrue(last.startswith("dyncal-convert: "), last)
        self.assertIn(str(path), last)
        self.assertFalse((self.folder / "cut.h5").exists())

    def test_files_of_other_formats_are_refused(self):
        for kind in FORMATS:
            for other in FORMATS:
                if kind == other:
                    continue
                with self.subTest(format=kind, other=other):
                    path = self.folder / f"{other}.{kind}"
                    self.draw[other](path, SEED)
                    self.check_refused(convert(path, self.folder / "cut.h5"), path)

    def test_overlapping_records_are_refused_with_their_place(self):
        import draw_files  # pylint: disable=import-outside-toplevel
        import numpy as np  # pylint: disable=import-outside-toplevel
        path = self.folder / "overlap.mseed"
        values = np.arange(500, dtype=np.int32)
        first = draw_files.records(values, "HNX", draw_files.START_NS, 100, 100, 512)
        second = draw_files.records(values, "HNX", draw_files.START_NS + 4_970_000_000, 100, 100,
                                    512)
        path.write_bytes(first + second)
        done = convert(path, self.folder / "cut.h5")
        self.check_refused(done, path)
        self.assertIn(f"record at byte {len(first)} begins 3 samples before", done.stderr)

    def test_nothing_is_written_over(self):
        path = self.folder / "a.parquet"
        self.draw["parquet"](path, SEED)
        (self.folder / "a.h5").write_text("mine")
        self.assertEqual(convert(path).returncode, 1)
        self.assertEqual((self.folder / "a.h5").read_text(), "mine")

    def test_a_missing_library_is_named_with_how_to_get_it(self):
        path = self.folder / "a.parquet"
        self.draw["parquet"](path, SEED)
        (self.folder / "pyarrow.py").write_text("raise ImportError('not here')\n")
        environment = {**os.environ, "PYTHONPATH": f"{self.folder}:{PACKAGE}"}
        done = subprocess.run([sys.executable, "-m", "dyncal_convert", path], env=environment,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("pip install pyarrow", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_its_types_are_sound(self):
        done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "dyncal_convert",
                               "--cache-dir", self.folder], cwd=PACKAGE, capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)


def main():
    if "--inside" not in sys.argv:
        import public_reader  # pylint: disable=import-outside-toplevel
        WORK.mkdir(parents=True, exist_ok=True)
        python = public_reader.interpreter(WORK, LIBRARIES, INSTALL_LIMIT_S)
        if python is None:
            print(f"skipped: the Python libraries {', '.join(LIBRARIES)} are not there, and no "
                  f"PyPI either")
            return SKIPPED
        return subprocess.run([python, "-B", __file__, *sys.argv[1:3], "--inside", *sys.argv[3:]],
                              check=False).returncode
    sys.argv.remove("--inside")
    print(f"seed {SEED}, {COUNT} files of each format")
    program = unittest.main(argv=[sys.argv[0], *sys.argv[3:]], exit=False)
    return 0 if program.result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
