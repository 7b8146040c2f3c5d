"""The judge itself: what it must not let pass."""

import math
import sys
import unittest

try:
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}; install python3-numpy")
    sys.exit(77)

import bench_simulator
import coverage
import expected_outcomes
import fault_classes
from expected_row import PHASE, Row
from judgement import (
    CHANCE,
    COVERED,
    COVERED_AND_NARROW,
    COVERED_AS_STUDENT,
    COVERED_NO_FLAG,
    COVERED_NO_MORE,
    COVERED_OR_FLAGGED,
    COVERED_WITH_BOUND,
    FLAGGED,
    MOSTLY_FLAGGED,
    Claim,
    Tally,
    at_most,
    claims_of,
    least_rms,
    refusal,
)

WANTED = (
    COVERED_NO_FLAG,
    COVERED_AND_NARROW,
    COVERED_WITH_BOUND,
    COVERED,
    COVERED_NO_MORE,
    COVERED_AS_STUDENT,
    COVERED_OR_FLAGGED,
    FLAGGED,
)
TRUTH = bench_simulator.Truth(
    magnitude={"10": 1.0, "20": 0.9},
    phase_rad={"10": -0.1, "20": -0.2},
    sample_rate_hz=1000.0,
    lost={},
    repetitions=1,
)


def normal_claims(n, error=1.0, flagged=False):
    """Errors of a normal distribution, `error` times what U says."""
    errors = error * np.random.default_rng(1).standard_normal(n)
    return [Claim(one, 2.0, flagged) for one in errors]


def point(frequency_hz, magnitude, phase_rad, **more):
    point = {"frequency_hz": frequency_hz, "repetition": 1, "valid": True, "flags": []}
    point.update(magnitude=magnitude, u_magnitude=0.01, phase_rad=phase_rad, u_phase_rad=0.01)
    return {**point, **more}


def result(points):
    means = [one for one in points if one["valid"]]
    return {"points": points, "transfer_function": means, "sample_clock": []}


def of(claims, what):
    return [claim for name, claim in claims if name == what]


class TallyOfClaims(unittest.TestCase):
    def test_nothing_judged_is_a_finding_whatever_is_wanted(self):
        for wanted in WANTED:
            self.assertIn("nothing was judged", Tally([]).finding(wanted))

    def test_claims_without_numbers_are_not_covered(self):
        claims = [Claim() for _ in range(60)]
        for wanted in WANTED:
            self.assertNotEqual(Tally(claims).finding(wanted), "", wanted)

    def test_normal_errors_are_covered(self):
        for wanted in (COVERED_NO_FLAG, COVERED_WITH_BOUND, COVERED, COVERED_OR_FLAGGED):
            self.assertEqual(Tally(normal_claims(360)).finding(wanted), "", wanted)

    def test_too_small_an_uncertainty_is_found(self):
        for wanted in (COVERED_NO_FLAG, COVERED_WITH_BOUND, COVERED, COVERED_OR_FLAGGED):
            self.assertIn("not covered", Tally(normal_claims(72, 1.8)).finding(wanted))

    def test_too_large_an_uncertainty_is_found_where_nothing_is_wrong(self):
        self.assertIn("times the rms", Tally(normal_claims(72, 0.6)).finding(COVERED_NO_FLAG))
        self.assertIn("u is too large", Tally(normal_claims(360, 0.6)).finding(COVERED_NO_FLAG))
        self.assertIn("u is too large", Tally(normal_claims(360, 0.6)).finding(COVERED_NO_MORE))
        self.assertEqual(Tally(normal_claims(72, 0.6)).finding(COVERED), "")

    def test_a_bound_may_widen_by_half_and_no_more(self):
        self.assertEqual(Tally(normal_claims(360, 1 / 1.4)).finding(COVERED_WITH_BOUND), "")
        self.assertIn(
            "times the rms", Tally(normal_claims(360, 1 / 1.8)).finding(COVERED_WITH_BOUND)
        )
        self.assertIn(
            "u is too large", Tally(normal_claims(5000, 1 / 1.8)).finding(COVERED_WITH_BOUND)
        )
        claims = normal_claims(69) + normal_claims(3, flagged=True)
        self.assertIn("carry a flag", Tally(claims).finding(COVERED_WITH_BOUND))

    def test_a_row_may_judge_low_frequencies_alone_and_never_passes_over_a_refusal(self):
        row = Row("a class", PHASE, COVERED_NO_FLAG, below_hz=30.0)
        self.assertTrue(row.judges(Claim(frequency="20")))
        self.assertFalse(row.judges(Claim(frequency="210")))
        self.assertTrue(row.judges(Claim(refused=True)))

    def test_what_the_page_says_may_be_silent_is_flagged_mostly(self):
        wrong = [Claim(error=9.0, expanded=1.0)] * 3
        flagged = [Claim(error=9.0, expanded=1.0, flagged=True)] * 60
        self.assertEqual(Tally(flagged + wrong).finding(MOSTLY_FLAGGED), "")
        self.assertIn("without a flag", Tally(flagged + 10 * wrong).finding(MOSTLY_FLAGGED))

    def test_clean_intervals_are_as_wide_as_errors_from_a_tenth_less_to_a_half_more(self):
        for width in (1.0, 1.3):
            self.assertEqual(Tally(normal_claims(360, 1 / width)).finding(COVERED_AND_NARROW), "")
        for n in (72, 360):
            tally = Tally(normal_claims(n, 1 / 1.7))
            self.assertIn("times the rms", tally.finding(COVERED_AND_NARROW))
        # Of another seed a chance is added, which is small of many.
        few, many = Tally(normal_claims(72, 1 / 1.7)), Tally(normal_claims(3600, 1 / 1.8))
        self.assertEqual(few.finding(COVERED_AND_NARROW, 1e-6), "")
        self.assertIn("times the rms", many.finding(COVERED_AND_NARROW, 1e-6))
        self.assertNotEqual(Tally(normal_claims(720, 1 / 0.8)).finding(COVERED_AND_NARROW), "")
        claims = normal_claims(69) + normal_claims(3, flagged=True)
        self.assertIn("carry a flag", Tally(claims).finding(COVERED_AND_NARROW))

    def test_an_interval_that_holds_everything_is_found_everywhere(self):
        for wanted in (COVERED_NO_FLAG, COVERED, COVERED_NO_MORE, COVERED_OR_FLAGGED):
            self.assertNotEqual(Tally(normal_claims(360, 0.01)).finding(wanted), "", wanted)

    def test_one_error_of_many_u_is_found(self):
        claims = normal_claims(360) + [Claim(10.0, 2.0)]
        self.assertIn("more than 3 U", Tally(claims).finding(COVERED))

    def test_one_far_off_of_few_degrees_of_freedom_is_chance_of_another_seed(self):
        another_seed = CHANCE / 700
        for far_off, expected in (([6.5], False), ([6.5, -6.5], True), ([12.5], True)):
            claims = normal_claims(50, 0.9) + [Claim(error, 2.0) for error in far_off]
            self.assertIn("more than 3 U", Tally(claims).finding(COVERED))
            finding = Tally(claims).finding(COVERED, another_seed)
            self.assertEqual("more than 3 U" in finding, expected, far_off)
        self.assertEqual(Tally(claims, few_repeats=True).finding(COVERED), "")

    def test_a_mean_may_be_as_wide_as_the_factor_that_it_states(self):
        def finding(k, u_too_large, wanted):
            claims = [
                Claim(one.error, k * u_too_large, k=k) for one in normal_claims(720)
            ]
            return Tally(claims, few_repeats=True).finding(wanted)

        self.assertEqual(finding(4.5, 1.0, COVERED_AS_STUDENT), "")
        self.assertEqual(finding(2.0, 1.1, COVERED_AS_STUDENT), "")
        for k, u_too_large in ((4.5, 1.5), (2.8, 1.5), (2.0, 1.5)):
            self.assertIn("times the rms", finding(k, u_too_large, COVERED_AS_STUDENT))

    def test_of_few_claims_no_width_is_judged_but_their_numbers_are(self):
        for wanted in WANTED:
            claims = normal_claims(2, 0.1, flagged=wanted == FLAGGED)
            for few_repeats in (False, True):
                self.assertEqual(Tally(claims, few_repeats).finding(wanted), "", wanted)

    def test_results_without_any_mean_are_no_pass(self):
        for n in (1, 2, 60):
            refused = [Claim(refused=True) for _ in range(n)]
            for wanted in set(WANTED) - {FLAGGED, COVERED_OR_FLAGGED}:
                finding = Tally(refused, few_repeats=True).finding(wanted)
                self.assertIn("nothing was judged", finding, wanted)

    def test_the_bound_of_a_width_is_that_of_the_chance(self):
        self.assertAlmostEqual(least_rms(240), 0.86, 2)
        self.assertLess(least_rms(240, 1e-5), 0.82)
        errors = np.random.default_rng(5).standard_normal((2000, 24))
        rms = np.sqrt(np.mean(errors**2, axis=1))
        for chance in (0.02, 0.1):
            self.assertAlmostEqual(np.mean(rms < least_rms(24, chance)) / chance, 1.0, delta=0.4)

    def test_the_factor_is_that_of_the_result(self):
        given = result([point(10.0, 1.0, -0.1, k_magnitude=3.0, k_phase=4.0)])
        claims = claims_of(given, TRUTH)
        self.assertEqual(of(claims, "mean magnitude")[0].k, 3.0)
        self.assertEqual(of(claims, "mean phase")[0].k, 4.0)

    def test_an_uncertainty_of_zero_covers_nothing(self):
        claims = [Claim(1e-9, 0.0) for _ in range(12)]
        self.assertIn("not covered", Tally(claims).finding(COVERED_OR_FLAGGED))

    def test_flags_excuse_only_where_they_may(self):
        claims = normal_claims(72, 30.0, flagged=True)
        self.assertEqual(Tally(claims).finding(COVERED_OR_FLAGGED), "")
        self.assertEqual(Tally(claims).finding(FLAGGED), "")
        self.assertIn("not covered", Tally(claims).finding(COVERED))

    def test_a_flag_on_clean_results_is_found(self):
        claims = normal_claims(69) + normal_claims(3, flagged=True)
        self.assertIn("3 of 72 carry a flag", Tally(claims).finding(COVERED_NO_FLAG))

    def test_missing_flags_are_found(self):
        claims = normal_claims(66, flagged=True) + normal_claims(6)
        self.assertIn("6 of 72 carry no flag", Tally(claims).finding(FLAGGED))

    def test_binomial_probabilities(self):
        self.assertAlmostEqual(at_most(1, 3, 0.5), 0.5)
        self.assertAlmostEqual(at_most(3, 3, 0.9545), 1.0)
        self.assertAlmostEqual(at_most(0, 2, 0.99), 1e-4)


class ClaimsOfResult(unittest.TestCase):
    def test_errors_are_against_the_truth_and_phases_turn_round(self):
        claims = claims_of(
            result([point(10.0, 1.01, -0.1 + 2.0 * math.pi), point(20.0, 0.9, -0.2)]), TRUTH
        )
        self.assertAlmostEqual(of(claims, "magnitude")[0].error, 0.01)
        self.assertAlmostEqual(of(claims, "phase")[0].error, 0.0)
        self.assertEqual(of(claims, "magnitude")[0].expanded, 0.02)
        self.assertEqual(len(of(claims, "mean phase")), 2)

    def test_a_point_that_is_missing_is_a_claim_that_is_not_covered(self):
        claims = claims_of(result([point(10.0, 1.0, -0.1)]), TRUTH)
        self.assertEqual(len(of(claims, "magnitude")), 2)
        self.assertFalse(of(claims, "magnitude")[1].covered)
        self.assertFalse(of(claims, "magnitude")[1].warned)

    def test_a_sample_clock_without_report_is_a_claim_that_is_not_covered(self):
        claims = claims_of(result([point(10.0, 1.0, -0.1), point(20.0, 0.9, -0.2)]), TRUTH)
        self.assertEqual(len(of(claims, "rate")), 1)
        self.assertFalse(of(claims, "rate")[0].covered)

    def test_a_refusal_counts_only_with_a_reason_that_does_not_mislead(self):
        def warned(problem):
            bad = point(10.0, None, None, valid=False, problem=problem)
            return of(claims_of(result([bad]), TRUTH), "phase")[0].warned

        self.assertTrue(warned("acs/ref: at its end stops"))
        self.assertFalse(warned(""))
        self.assertFalse(warned("no steady sine of 10 Hz; is the sync signal connected?"))
        self.assertFalse(of(refusal(TRUTH, " \n"), "phase")[0].warned)
        self.assertEqual(len(of(refusal(TRUTH, "refused"), "phase")), 2)

    def test_an_expanded_uncertainty_that_is_given_counts(self):
        def expanded(**more):
            given = result([point(10.0, 1.0, -0.1, **more)])
            return of(claims_of(given, TRUTH), "magnitude")[0].expanded

        self.assertEqual(expanded(U_magnitude=0.05), 0.05)
        self.assertEqual(expanded(k_magnitude=4.0), 0.04)

    def test_an_unknown_uncertainty_is_a_refusal(self):
        claims = claims_of(result([point(10.0, 1.0, -0.1, u_magnitude=None)]), TRUTH)
        self.assertTrue(of(claims, "magnitude")[0].refused)


class TableOfOutcomes(unittest.TestCase):
    def test_every_class_has_a_row_and_every_row_a_class(self):
        self.assertEqual(
            set(fault_classes.CLASSES), {row.fault_class for row in expected_outcomes.EXPECTED}
        )

    def test_a_known_failure_that_holds_is_not_as_expected(self):
        row = expected_outcomes.Row("clean", ("phase",), COVERED, fails_at="point 0")
        tallies = {"phase": Tally(normal_claims(72))}
        self.assertIn("holds now", coverage.not_as_expected(row, tallies, {"phase": ""})[0])
        self.assertEqual(coverage.not_as_expected(row, tallies, {"phase": "wrong"}), [])

    def test_a_known_failure_without_claims_is_not_as_expected(self):
        row = expected_outcomes.Row("clean", ("phase",), COVERED, fails_at="point 0")
        self.assertIn("no claims", coverage.not_as_expected(row, {"phase": Tally([])}, {})[0])


if __name__ == "__main__":
    unittest.main()
