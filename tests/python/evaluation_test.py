"""What the evaluation says in Python is what the programs say: evaluation_test.py PROGRAMS FOLDER

Sample clock as `dyncal intervals`, group delay as the result file, methods and interferometer
against drawn truths, budgets and coverage against their own rows.
"""

import json
import math
import pathlib
import subprocess
import sys
import unittest

import drawn_records
import numpy as np

import dyncal

FREQUENCY = "79.9"
W = 2 * math.pi * float(FREQUENCY)


def clock(samples, rate_hz, offset_s, rng):
    """Stamps of a clock that is off, and the true times, s."""
    true_s = np.arange(samples) / rate_hz + rng.uniform(0, 1e-3)
    return np.round((true_s + offset_s) * 1e9).astype(np.int64), true_s


class Evaluation(unittest.TestCase):
    def step(self, number):
        """One excitation step of two clocks, and the true H."""
        rng = np.random.default_rng((drawn_records.SEED, number))
        h = rng.uniform(0.5, 2) * np.exp(1j * rng.uniform(-3, 3))
        acs_t, acs_s = clock(40_000, 20_000, 0.123, rng)
        dau_t, dau_s = clock(2_000, 1_003, 1_700_000.0, rng)
        noise = lambda n, sd: sd * rng.standard_normal(n)
        reference = 10 * np.sin(W * acs_s) + noise(len(acs_s), 1e-3)
        sync = lambda s: 5 * np.sin(W * s + 0.3) + noise(len(s), 1e-3)
        sensor = 10 * abs(h) * np.sin(W * dau_s + np.angle(h)) + noise(len(dau_s), 1e-2)
        result = dyncal.evaluate_sample_stamping(
            FREQUENCY,
            acs_stamps_ns=acs_t,
            reference=dyncal.Channel("acs/reference", reference),
            sync_acs=dyncal.Channel("acs/sync", sync(acs_s)),
            dau_stamps_ns=dau_t,
            sync_dau=dyncal.Channel("dau/sync", sync(dau_s)),
            dut=[dyncal.Channel("dau/z", sensor)],
            systematic=dyncal.SystematicUncertainty(
                reference_magnitude_rel=1e-3, reference_phase_rad=1.7e-3
            ),
        )
        return h, result

    def test_sample_stamping_finds_the_truth_within_its_budget(self):
        for number in range(12):
            with self.subTest(seed=drawn_records.SEED, number=number):
                h, result = self.step(number)
                point = result.points[0]
                self.assertEqual(point.channel, "dau/z")
                # The reference is right here: what is left is noise, a part of u.
                self.assertLess(abs(point.magnitude / abs(h) - 1), 3e-3)
                self.assertLess(abs(np.angle(point.h / h)), 3e-3)
                rows = math.sqrt(sum(row.u_magnitude_rel**2 for row in point.budget))
                self.assertAlmostEqual(rows, point.u_magnitude / point.magnitude, delta=1e-3 * rows)
                self.assertIn("reference", [row.kind for row in point.budget])

    def test_repetitions_and_group_delay_follow_on(self):
        delay_s = 2.5e-3
        rows = [dyncal.Contribution("mine", u_magnitude_rel=1e-3, u_phase_rad=2e-3)]
        rows.append(dyncal.Contribution("noise", u_magnitude_rel=1e-4, u_phase_rad=1e-4,
                                        repeats="anew"))
        frequencies = []
        for hz in (10.0, 20.0, 40.0, 80.0, 160.0):
            h = np.exp(-2j * math.pi * hz * delay_s)
            one = [dyncal.make_repetition(h, rows, sweep) for sweep in (1, 2, 3)]
            frequencies.append(dyncal.RepeatedFrequency(hz, one))
        means = dyncal.means_of_repetitions(frequencies)
        self.assertEqual([mean.repetitions for mean in means], [3] * 5)
        points = [
            dyncal.PhasePoint(one.frequency_hz, mean.phase_rad, mean.u_independent_phase_rad)
            for one, mean in zip(frequencies, means)
        ]
        delay = dyncal.evaluate_group_delay(points)
        self.assertAlmostEqual(delay.delay_s, delay_s, places=9)
        self.assertFalse(delay.polarity_inverted)
        with self.assertRaises(dyncal.Error) as caught:
            dyncal.evaluate_group_delay(points[:1])
        self.assertEqual(caught.exception.code, "too_few_samples")

    def test_the_sample_clock_is_that_of_the_program(self):
        compared = 0
        for number, record in enumerate(drawn_records.records()[:8]):
            path = FOLDER / f"clock-{number}.npy"
            record.save(path)
            done = subprocess.run(
                [PROGRAMS / "dyncal", "intervals", path, "--json"],
                capture_output=True,
                text=True,
                check=False,
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            stated = json.loads(done.stdout)
            ours = dyncal.SampleClock()
            half = len(record.stamps_ns) // 2
            ours.push(0, record.stamps_ns[:half])
            ours.push(half, record.stamps_ns[half:])
            found = ours.statistics()
            names = {"mean_interval_s": "mean_interval_s", "sd_s": "sd_s", "median_s": "median_s"}
            for key, name in names.items():
                if key in stated:
                    self.assertEqual(stated[key], getattr(found, name), (number, key))
                    compared += 1
        self.assertGreater(compared, 8)

    def test_interferometer_gives_the_acceleration(self):
        rng = np.random.default_rng(drawn_records.SEED)
        rate_hz, wavelength_m, acceleration = 2e5, 632.82e-9, 20.0
        t = np.arange(200_000) / rate_hz
        displacement = -acceleration / W**2 * np.sin(W * t + 0.4)
        phase = 4 * math.pi * displacement / wavelength_m + 0.7
        u1 = 0.1 + 1.2 * np.cos(phase) + 1e-3 * rng.standard_normal(len(t))
        u2 = -0.2 + 1.0 * np.sin(phase - 0.1) + 1e-3 * rng.standard_normal(len(t))
        ellipse = dyncal.ellipse_of_record(u1, u2).ellipse
        self.assertAlmostEqual(ellipse.alpha_rad, 0.1, places=3)
        unwrapped = dyncal.QuadraturePhase(ellipse)
        blocks = [slice(0, 777), slice(777, None)]
        turns = np.concatenate([unwrapped.push(u1[block], u2[block]) for block in blocks])
        self.assertEqual(unwrapped.statistics.doubtful, 0)
        displacement_m = turns * dyncal.displacement_per_turn_m(wavelength_m)
        stamps = np.round(t * 1e9).astype(np.int64)
        motion = dyncal.motion_of_step(FREQUENCY, stamps, displacement_m)
        acceleration_m_s2 = -(W**2) * motion.values
        fit = dyncal.fit_sine(FREQUENCY, motion.stamps_ns, acceleration_m_s2, reference_ns=0)
        self.assertAlmostEqual(fit.amplitude, acceleration, delta=2e-3 * acceleration)
        self.assertAlmostEqual(fit.phase_rad, 0.4, places=2)

    def test_uncertainty_follows_the_gum(self):
        self.assertAlmostEqual(dyncal.coverage_factor(math.inf), 2.0, places=6)
        self.assertAlmostEqual(dyncal.coverage_factor(10, 0.95), 2.228, places=3)
        both = dyncal.combine([dyncal.UncertaintyPart(3.0, 4), dyncal.UncertaintyPart(4.0)])
        self.assertAlmostEqual(both.u, 5.0, delta=0.4)
        inputs = [dyncal.InputQuantity("a", 1.0, 0.1), dyncal.InputQuantity("b", 2.0, 0.2)]
        law = dyncal.propagate_uncertainty(inputs, [(0, 1, 1.0)])
        self.assertAlmostEqual(law.u, 0.3)
        drawn = dyncal.propagate_distributions(
            inputs, lambda values: [sum(values)], correlations=[(0, 1, 0.5)], max_trials=50_000
        )[0]
        self.assertAlmostEqual(drawn.u, math.sqrt(0.01 + 0.04 + 0.02), delta=0.01)
        with self.assertRaises(ZeroDivisionError):
            dyncal.propagate_distributions(inputs, lambda values: [1 / 0])
        with self.assertRaises(dyncal.Error):
            dyncal.standard_uncertainty("square", 1.0)


if __name__ == "__main__":
    PROGRAMS, FOLDER = map(pathlib.Path, sys.argv[1:3])
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
