"""dyncal.models against drawn truths and against `dyncal model`: models_test.py PROGRAMS FOLDER"""

import cmath
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

import numpy as np
import virtual_result

import dyncal
from dyncal import models

SEED = int(os.environ.get("DYNCAL_PYTHON_SEED", "1"))
FREQUENCIES_HZ = [5.0 * 2 ** (i / 3) for i in range(22)]
TRUTH = {"gain": 2.0, "delay_s": 1e-3, "resonance_hz": 900.0, "damping": 0.4}


def true_response(frequency_hz, gain, delay_s, resonance_hz, damping):
    x = frequency_hz / resonance_hz
    return gain * cmath.exp(-2j * math.pi * frequency_hz * delay_s) / (1 - x * x + 2j * damping * x)


class Models(unittest.TestCase):
    def drawn(self, rng, truth, u):
        points = []
        for frequency_hz in FREQUENCIES_HZ:
            h = true_response(frequency_hz, *truth.values())
            h *= 1 + u * complex(rng.standard_normal(), rng.standard_normal())
            points.append(models.ResponsePoint(frequency_hz, h, u, u))
        return points

    def test_parameters_are_found_within_their_uncertainty(self):
        rng = np.random.default_rng(SEED)
        deviations = []
        for _ in range(8):
            truth = {
                "gain": rng.uniform(0.5, 20),
                "delay_s": rng.uniform(1e-4, 3e-3),
                "resonance_hz": rng.uniform(900, 2000),
                "damping": rng.uniform(0.1, 0.9),
            }
            points = self.drawn(rng, truth, 1e-3)
            choice = models.choose_response(points)
            self.assertTrue(choice.fits)
            self.assertEqual(choice.best.kind, "second_order_with_delay")
            fit = models.fit_response("second_order_with_delay", points)
            self.assertEqual([one.name for one in fit.parameters], list(truth))
            for one in fit.parameters:
                deviations.append((one.value - truth[one.name]) / one.u)
                self.assertAlmostEqual(one.expanded, one.k * one.u)
            at = fit.response_at(100.0)
            self.assertLess(
                abs(at - true_response(100.0, *truth.values())) / abs(at),
                6 * fit.uncertainty_at(100.0).magnitude_rel + 6 * fit.uncertainty_at(100).phase_rad,
            )
        self.assertLess(max(map(abs, deviations)), 5)
        self.assertTrue(0.5 < np.std(deviations) < 1.6, np.std(deviations))

    def test_a_filter_undoes_the_response(self):
        points = self.drawn(np.random.default_rng(SEED), TRUTH, 1e-4)
        fit = models.fit_response("second_order_with_delay", points)
        made = models.design_compensation(fit, rate_hz=4000.0, cutoff_hz=600.0, poles=6)
        self.assertEqual((made.b.dtype, len(made.a)), (np.dtype("float64"), 7))
        self.assertEqual(len(made.covariance_b), len(made.b) ** 2)
        w = 2 * math.pi * 200.0 / made.rate_hz
        delays = np.exp(-1j * w * np.arange(max(len(made.a), len(made.b))))
        quotient = made.b @ delays[: len(made.b)] / (made.a @ delays[: len(made.a)])
        self.assertAlmostEqual(abs(quotient - made.response_at(200.0)), 0.0, places=10)
        undone = quotient * fit.response_at(200.0) * cmath.exp(1j * w * made.delay_samples)
        self.assertLess(abs(undone - 1), made.ripple + 1e-9)

    def test_the_program_states_the_same(self):
        virtual_result.make(PROGRAMS, FOLDER, ["10", "20", "40", "80", "160", "250"])
        done = subprocess.run(
            [PROGRAMS / "dyncal", "model", "result.json", "--output", "model.json"],
            cwd=FOLDER,
            capture_output=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        [stated] = json.loads((FOLDER / "model.json").read_text())["models"]
        points = [
            models.ResponsePoint(
                one["frequency_hz"],
                cmath.rect(one["magnitude"], one["phase_rad"]),
                one["u_own_magnitude_rel"],
                one["u_own_phase_rad"],
            )
            for one in stated["points"]
        ]
        self.assertGreater(len(points), 4)
        shared = stated["common"]
        common = models.CommonResponseUncertainty(
            shared["u_gain_rel"], shared["u_delay_s"], shared["u_phase_rad"]
        )
        choice = models.choose_response(points, common)
        self.assertEqual((choice.best.kind, choice.fits), (stated["kind"], stated["fits"]))
        for ours, theirs in zip(choice.best.fit.parameters, stated["parameters"]):
            self.assertEqual(ours.name, theirs["name"])
            self.assertLess(abs(ours.value - theirs["value"]), 1e-6 * theirs["u"])

    def test_wrong_words_are_refused_in_a_sentence(self):
        points = self.drawn(np.random.default_rng(SEED), TRUTH, 1e-3)
        for work in (
            lambda: models.fit_response("third_order", points),
            lambda: models.fit_response("gain", points, loss="cauchy"),
            lambda: models.fit_response("gain", [models.ResponsePoint(0.0, 1, 1e-3, 1e-3)] * 5),
        ):
            with self.assertRaises(dyncal.Error) as raised:
                work()
            self.assertEqual(raised.exception.code, "invalid_argument")
            self.assertGreater(len(str(raised.exception)), 20)
        with self.assertRaises(dyncal.Error) as raised:
            models.fit_response("second_order", points[:1])
        self.assertEqual(raised.exception.code, "too_few_samples")


if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
