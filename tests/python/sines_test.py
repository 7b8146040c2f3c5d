"""Sines have the same bits as `dyncal fit`: sines_test.py PROGRAMS FOLDER"""

import json
import pathlib
import subprocess
import sys
import unittest

import drawn_records

import dyncal


class Sines(unittest.TestCase):
    def fit(self, record, number, *options):
        path = FOLDER / f"record-{number}.npy"
        record.save(path)
        done = subprocess.run(
            [PROGRAMS / "dyncal", "fit", path, "--json", *options],
            capture_output=True,
            text=True,
            check=False,
        )
        path.unlink()
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def assert_same(self, stated, fit):
        """Every number of the program's, to the last bit."""
        expected = (fit.sine, fit.cosine, fit.offset, fit.amplitude, fit.phase_rad)
        names = ("A_sin", "B_cos", "C", "amplitude", "phase_rad")
        self.assertEqual(tuple(stated[name] for name in names), expected)
        expected = (fit.u_amplitude, fit.u_phase_rad, list(fit.covariance), fit.rss, fit.samples)
        names = ("u_amplitude", "u_phase_rad", "covariance", "rss", "samples")
        self.assertEqual(tuple(stated[name] for name in names), expected)

    def test_a_record_is_fitted_as_by_the_program(self):
        plain = 0
        for number, record in enumerate(drawn_records.records()):
            with self.subTest(seed=drawn_records.SEED, number=number):
                stated = self.fit(record, number, "--frequency", record.frequency)
                values = list(record.channels.values())
                ours = dyncal.fit_record(record.stamps_ns, values, record.frequency)
                sines = dyncal.fit_sine(record.frequency, record.stamps_ns, record.channels)
                self.assertEqual(list(stated["columns"]), list(record.channels))
                for name, fit in zip(record.channels, ours.fits):
                    column = stated["columns"][name]
                    self.assert_same(column, fit)
                    if "corrected_shortening_rel" not in column:
                        plain += 1
                        known = (sines[name].sine, sines[name].cosine, sines[name].offset)
                        self.assertEqual(known, (column["A_sin"], column["B_cos"], column["C"]))
                        self.assertEqual(sines[name].rss, column["rss"])
        self.assertGreater(plain, drawn_records.COUNT // 2)

    def test_an_unknown_frequency_is_fitted_as_by_the_program(self):
        for number, record in enumerate(drawn_records.records()[: drawn_records.COUNT // 4]):
            with self.subTest(seed=drawn_records.SEED, number=number):
                stated = self.fit(record, number)
                ours = dyncal.fit_record(record.stamps_ns, list(record.channels.values()))
                self.assertEqual(stated["frequency_hz"], ours.frequency.hz)
                self.assertEqual(stated["u_frequency_hz"], ours.u_frequency_hz)
                for name, fit in zip(record.channels, ours.fits):
                    self.assert_same(stated["columns"][name], fit)

    def test_further_lines_are_fitted_as_by_the_program(self):
        for number, record in enumerate(drawn_records.records()[: drawn_records.COUNT // 4]):
            with self.subTest(seed=drawn_records.SEED, number=number):
                options = ["--frequency", record.frequency, "--drift", "2", "--harmonics", "2"]
                hum = str(float(record.frequency) * 0.61803)
                try:
                    ours = dyncal.fit_record(
                        record.stamps_ns,
                        list(record.channels.values()),
                        record.frequency,
                        drift=2,
                        harmonics=2,
                        lines=[hum],
                    )
                except dyncal.Error as error:
                    self.assertEqual(error.code, "ill_conditioned")
                    continue
                stated = self.fit(record, number, *options, "--hum", hum)
                for name, fit in zip(record.channels, ours.fits):
                    self.assert_same(stated["columns"][name], fit)

    def test_forms_of_channels_give_the_same(self):
        record = drawn_records.Record(0)
        values = list(record.channels.values())
        one = dyncal.fit_sine(record.frequency, record.stamps_ns, values[0])
        first = dyncal.fit_sine(record.frequency, record.stamps_ns, values)[0]
        self.assertEqual((one.sine, one.cosine, one.rss), (first.sine, first.cosine, first.rss))
        self.assertEqual(one.phasor, complex(one.sine, one.cosine))
        refined = dyncal.fit_sine_and_frequency(record.frequency, record.stamps_ns, values)
        self.assertLess(
            abs(refined.frequency.hz - float(record.frequency)), 6 * refined.u_frequency_hz + 1e-9
        )


if __name__ == "__main__":
    PROGRAMS, FOLDER = map(pathlib.Path, sys.argv[1:3])
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
