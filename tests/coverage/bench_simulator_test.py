"""The simulator against plain least squares in numpy: its records hold the truth that it states."""

import pathlib
import sys
import tempfile
import unittest

try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}; install python3-numpy")
    sys.exit(77)

import bench_simulator
import disturbances
from bench_settings import BenchSettings
from bench_simulator import Calibration

QUIET = {
    "sensor_noise_rel": 1e-6,
    "reference_noise_rel": 1e-6,
    "sync_noise_rel": 1e-6,
    "harmonics_rel": (),
    "u_reference_magnitude_rel": 0.0,
    "u_reference_phase_rad": 0.0,
    "u_adc_lag_rad": 0.0,
    "u_acs_delay_s": 0.0,
    "acs_rate_error_rel": 0.0,
    "frequencies": ("31.5", "160"),
}


def phasor(times_s, values, frequency_hz):
    turn = 2.0 * np.pi * frequency_hz * times_s
    design = np.column_stack([np.sin(turn), np.cos(turn), np.ones_like(turn)])
    sine, cosine, _ = np.linalg.lstsq(design, values, rcond=None)[0]
    return complex(sine, cosine)


def shot_of(path):
    lines = path.read_text("utf-8").splitlines()
    keys = dict(line[2:].split(" = ", 1) for line in lines if line.startswith("# "))
    return keys, np.array([float(line) for line in lines[len(keys) + 1 :]])


class Simulator(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def steady(self, name, epoch_ns, step, settings):
        """Time and columns of a record in the evaluated part of a step."""
        rows = np.load(self.folder / name)
        times_s = (rows["t_ns"] - epoch_ns) * 1e-9
        begin_s, end_s = step.evaluated_s(settings)
        inside = (times_s > begin_s) & (times_s < end_s)
        return times_s[inside], rows[inside]

    def assert_truth(self, h, text, truth):
        self.assertAlmostEqual(abs(h) / truth.magnitude[text], 1.0, delta=2e-6)
        turned = h * np.exp(-1j * truth.phase_rad[text])
        self.assertAlmostEqual(np.angle(turned), 0.0, delta=5e-5)  # sync has a 12-bit converter

    def test_sample_stamping_holds_its_truth(self):
        settings = BenchSettings(**QUIET)
        calibration = Calibration(settings, 1)
        truth = calibration.write(self.folder)
        for step in calibration.steps:
            f = step.frequency_hz
            acs_s, acs = self.steady("acs.npy", bench_simulator.ACS_EPOCH_NS, step, settings)
            dau_s, dau = self.steady("dau.npy", bench_simulator.DAU_EPOCH_NS, step, settings)
            sync_acs, sync_dau = phasor(acs_s, acs["sync"], f), phasor(dau_s, dau["sync"], f)
            sync_dau *= np.exp(2j * np.pi * f * bench_simulator.ADC_DELAY_S)
            link = sync_acs / abs(sync_acs) / (sync_dau / abs(sync_dau))
            h = phasor(dau_s, dau["dos"], f) / phasor(acs_s, acs["ref"], f) * link
            self.assert_truth(h, step.frequency_text, truth)

    def test_series_hold_their_truth(self):
        settings = BenchSettings(
            **QUIET, method="series-timestamping", trace_noise_v=1e-6, trace_step_v=1e-9, shots=2
        )
        calibration = Calibration(settings, 1)
        truth = calibration.write(self.folder)
        for number, step in enumerate(calibration.steps, 1):
            f = step.frequency_hz
            acs_s, acs = self.steady("acs.npy", bench_simulator.ACS_EPOCH_NS, step, settings)
            keys, trace = shot_of(self.folder / f"dso/step-{number}-shot-2.csv")
            trace_s = float(keys["first_sample_s"]) + np.arange(trace.size) / float(
                keys["nominal_rate_hz"]
            )
            _, series = shot_of(self.folder / f"tss/step-{number}-shot-2.csv")
            series_s = bench_simulator.DSO_DELAY_S + np.arange(series.size) / truth.sample_rate_hz
            sync, reference = phasor(acs_s, acs["sync"], f), phasor(acs_s, acs["ref"], f)
            trigger = phasor(trace_s, trace, f)
            link = sync / abs(sync) / reference / (trigger / abs(trigger))
            self.assert_truth(phasor(series_s, series, f) * link, step.frequency_text, truth)

    def test_the_same_seed_writes_the_same_bytes(self):
        contents = []
        for name in ("one", "other"):
            (self.folder / name).mkdir()
            Calibration(BenchSettings(frequencies=("20",)), 7).write(self.folder / name)
            contents.append({p.name: p.read_bytes() for p in (self.folder / name).iterdir()})
        self.assertEqual(len(contents[0]), 4)
        self.assertEqual(contents[0], contents[1])

    def test_losses_are_counted_in_what_is_evaluated(self):
        settings = BenchSettings(lost_rel=0.1, not_measured_rel=0.1, frequencies=("20",))
        truth = Calibration(settings, 3).write(self.folder)
        samples = settings.duration_s * truth.sample_rate_hz
        self.assertAlmostEqual(truth.lost["20", 1] / samples, 0.19, delta=0.04)


class Disturbances(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(5)

    def test_disordered_stamps_are_single_ones(self):
        stamps_ns = 1000 * np.arange(1000, dtype=np.int64)
        disordered = disturbances.disordered_stamps(stamps_ns, 10, self.rng)
        self.assertEqual(np.count_nonzero(disordered != stamps_ns), 10)
        self.assertEqual(np.count_nonzero(np.diff(disordered) <= 0), 10)
        self.assertEqual(np.count_nonzero(np.diff(disordered) == 0), 5)

    def test_as_many_samples_are_lost_as_asked_for(self):
        kept = disturbances.lost_samples(10_000, 0.01, self.rng)
        self.assertAlmostEqual(10_000 - kept.size, 100, delta=5)

    def test_drift_is_as_large_as_asked_for(self):
        drift = disturbances.slow_drift(np.linspace(3.0, 5.0, 100), 0.02, self.rng)
        self.assertAlmostEqual(np.ptp(drift), 0.02)


if __name__ == "__main__":
    unittest.main()
