"""Compares a result of `dyncal analyse` with the truth, and many of these with what is wanted.

A claim is one number that dyncal gave or should have given: its error, its expanded uncertainty at
95.45 %, and whether a person was warned. Bounds are exact binomial: what happens by chance less
than once in a thousand on that side is a finding.
"""

import collections
import dataclasses
import math
import statistics

import numpy as np

PROBABILITY = 0.9545
FLAGGED_RUNS = 0.99
MOST = 0.85
# Of clean calibrations 0.99 have no flag, and each has six claims.
UNFLAGGED_CLAIMS = 0.998
CHANCE = 1e-3
# No error of a number that is right is so many U, but for one of as many as Student's t of 15
# degrees of freedom gives: a step of 1.5 s holds so many pieces of noise that is 5 Hz wide. The
# fixed seed has none, and other seeds none of twice as many.
FAR_OFF = 3.0
FAR_OFF_BY_CHANCE = 1e-5
# An interval so wide that it always holds the truth says nothing: U against the rms of the errors.
WIDEST = 12.0
# The same where nothing is wrong, but u holds a bound of what the data cannot exclude: 1.5 times 2.
WIDEST_BOUND = 3.0
# As many as such a U holds.
PROBABILITY_OF_BOUND = 0.9973
# U against 2 rms of the errors, where nothing is wrong that U must hold.
NARROWEST_CLEAN, WIDEST_CLEAN = 0.9, 1.5
# Claims of the fixed seed whose rms is known to a tenth: no chance is added to the upper end.
KNOWN_RMS = 60
# By how much U of a mean may exceed what Student's factor alone, as stated, makes of the errors.
BEYOND_STUDENT = 1.2
# Sync is always connected here.
MISLEADING = "is the sync signal connected"
# Members of a point that count samples which did not count.
LOSSES = ("lost", "not_trusted", "not_measured", "out_of_order")

# What is wanted of the claims of a class.
COVERED_NO_FLAG = "covered, no flag"  # nothing is wrong, and no person is bothered
COVERED_AND_NARROW = "covered, 0.9 to 1.5"  # the same, however few: U against 2 rms of the errors
COVERED_WITH_BOUND = "covered, with a bound"  # nor is here, but u may be larger than errors say
COVERED = "covered"  # flags are free
COVERED_NO_MORE = "covered, no more"  # by as many as stated; for the scatter of repetitions
COVERED_AS_STUDENT = "covered, as Student"  # of few repetitions: as wide as the k they state
COVERED_OR_FLAGGED = "covered or flagged"  # never wrong in silence
FLAGGED = "flagged"  # a person must know, whatever the number is
MOSTLY_FLAGGED = "covered or mostly flagged"  # what-it-cannot-see.md says of which it may be silent


@dataclasses.dataclass
class Claim:
    error: float = math.nan
    expanded: float = math.nan
    flagged: bool = False
    refused: bool = False  # no number, and a reason that does not mislead
    frequency: str = ""
    k: float = 2.0  # as stated

    @property
    def warned(self):
        return self.flagged or self.refused

    @property
    def covered(self):
        return abs(self.error) <= self.expanded

    def far_off(self, times=FAR_OFF):
        return abs(self.error) > times * self.expanded


def expanded_uncertainty(entry, quantity):
    """U as given, or k u as given, or 2 u of a normal distribution."""
    if entry.get(f"U_{quantity}") is not None:
        return entry[f"U_{quantity}"]
    u = entry.get(f"u_{quantity}")
    return math.nan if u is None else coverage_factor(entry, quantity) * u


def coverage_factor(entry, quantity):
    """As stated, or that of a normal distribution."""
    return entry.get(f"k_{quantity.removesuffix('_rad')}") or 2.0


def claim_of(entry, quantity, error, flagged, frequency=""):
    value, expanded = entry.get(quantity), expanded_uncertainty(entry, quantity)
    if value is None or math.isnan(expanded):  # null: it says that it does not know
        return Claim(flagged=flagged, refused=True, frequency=frequency)
    k = coverage_factor(entry, quantity)
    return Claim(error(value), expanded, flagged, frequency=frequency, k=k)


def phase_error(phase_rad, true_rad):
    return math.remainder(phase_rad - true_rad, 2.0 * math.pi)


def at_frequency(entries, text):
    return [one for one in entries if math.isclose(one["frequency_hz"], float(text))]


def claims_on_values(entries, text, truth, flagged):
    """Magnitude and phase of each entry; `flagged` tells whether an entry is."""
    true_magnitude, true_phase = truth.magnitude[text], truth.phase_rad[text]
    for entry in entries:
        if entry.get("valid") is False:
            reason = entry.get("problem", "")
            refused = Claim(refused=bool(reason) and MISLEADING not in reason)
            yield "magnitude", refused
            yield "phase", refused
            continue
        flag = flagged(entry)
        yield "magnitude", claim_of(entry, "magnitude", lambda v: v - true_magnitude, flag, text)
        yield "phase", claim_of(
            entry, "phase_rad", lambda v: phase_error(v, true_phase), flag, text
        )


def claims_on_losses(points, text, truth):
    """Samples that did not arrive or were not measured. Ends of the evaluated part may differ by a
    frame, and a third more or less is no lie; nothing said is one."""
    for point in points:
        true = truth.lost[text, point["repetition"]]
        told = sum(point.get(name) or 0 for name in LOSSES)
        yield "losses", Claim(told - true, max(5.0, true / 3.0), bool(point["flags"]))


def claims_on_rate(result, truth):
    if math.isnan(truth.sample_rate_hz):
        return
    if not result["sample_clock"]:
        yield "rate", Claim()
    for report in result["sample_clock"]:
        entry = {"rate_hz": report["mean_rate_hz"]}
        if report["u_mean_interval_s"] is not None:
            entry["u_rate_hz"] = report["u_mean_interval_s"] * report["mean_rate_hz"] ** 2
        flagged = bool(report.get("flags"))
        yield "rate", claim_of(entry, "rate_hz", lambda v: v - truth.sample_rate_hz, flagged)


def refusal(truth, reason):
    """The program gave no result at all: a refusal of every claim, when it gives a reason."""
    refused = Claim(refused=bool(reason.strip()) and MISLEADING not in reason)
    claims = [("rate", refused)]
    for _ in truth.magnitude:
        claims += [("mean magnitude", refused), ("mean phase", refused)]
        points = [("magnitude", refused), ("phase", refused), ("losses", refused)]
        claims += points * truth.repetitions
    return claims


def claims_of(result, truth):
    """All claims as (what, Claim). What is missing is a claim without a number."""
    claims = list(claims_on_rate(result, truth))
    for text in truth.magnitude:
        points = at_frequency(result["points"], text)
        means = at_frequency(result["transfer_function"], text)
        claims += claims_on_values(points, text, truth, lambda point: bool(point["flags"]))
        of_points = any(point["flags"] for point in points)
        for what, claim in claims_on_values(
            means, text, truth, lambda mean: bool(mean.get("flags")) or of_points
        ):
            claims.append((f"mean {what}", claim))
        if truth.lost:
            claims += claims_on_losses(points, text, truth)
        for _ in range(truth.repetitions - len(points)):
            claims += [("magnitude", Claim()), ("phase", Claim())]
        if not means:
            refused = Claim(refused=not any(point["valid"] for point in points))
            claims += [("mean magnitude", refused), ("mean phase", refused)]
    return claims


def at_most(k, n, p):
    """Probability of at most k out of n."""
    logs = [
        math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1)
        + i * math.log(p) + (n - i) * math.log1p(-p)
        for i in range(k + 1)
    ]
    return math.fsum(map(math.exp, logs))


def too_few(k, n, p, chance=CHANCE):
    return at_most(k, n, p) < chance


def too_many(k, n, p, chance=CHANCE):
    return at_most(n - k, n, 1.0 - p) < chance


def least_rms(n, chance=CHANCE):
    """What the rms of n normal deviates falls below by this chance (Wilson and Hilferty)."""
    deviate = statistics.NormalDist().inv_cdf(1.0 - chance)
    return max(0.0, 1.0 - 2.0 / (9.0 * n) - deviate * math.sqrt(2.0 / (9.0 * n))) ** 1.5


def widest_of(usual, n, chance=CHANCE):
    """What U over the rms of n errors exceeds by this chance, where it is `usual` in the long run.
    Of so few that their rms may be next to nothing, it may be anything."""
    least = least_rms(n, chance)
    return usual / least if least > 0.0 else math.inf


def most_rms(n, chance=CHANCE):
    """What it exceeds by this chance."""
    deviate = statistics.NormalDist().inv_cdf(1.0 - chance)
    return (1.0 - 2.0 / (9.0 * n) + deviate * math.sqrt(2.0 / (9.0 * n))) ** 1.5


@dataclasses.dataclass
class Tally:
    """Claims of one quantity over all draws of a class. `few_repeats`: their intervals come from
    the scatter of few repetitions, so that a rare error may be many U."""

    claims: list
    few_repeats: bool = False

    def __post_init__(self):
        self.numbers = [one for one in self.claims if math.isfinite(one.error)]
        self.covered = sum(one.covered for one in self.numbers)
        self.warned = sum(one.warned for one in self.claims)
        self.silent = [one for one in self.claims if not one.warned]
        self.silent_covered = sum(one.covered for one in self.silent)
        self.width = self._width()

    def _width(self):
        """The usual U of a frequency against its errors (2: as it should be), over all of them."""
        expanded = collections.defaultdict(list)
        for one in self.numbers:
            expanded[one.frequency].append(one.expanded)
        usual = {frequency: float(np.median(all_of)) for frequency, all_of in expanded.items()}
        if not usual or min(usual.values()) <= 0.0:
            return 0.0
        errors = np.array([one.error / usual[one.frequency] for one in self.numbers])
        rms = float(np.sqrt(np.mean(errors**2)))
        return 1.0 / rms if rms > 0.0 else 0.0  # a count that is exact is not too wide

    def finding(self, wanted, chance=CHANCE):
        """What is wrong in a sentence; empty when nothing is."""
        n = len(self.claims)
        if n == 0:
            return "no claims at all: nothing was judged"
        if not self.numbers and wanted not in (FLAGGED, COVERED_OR_FLAGGED, MOSTLY_FLAGGED):
            return f"none of {n} has a number: nothing was judged"
        if wanted == FLAGGED:
            enough = not too_few(self.warned, n, FLAGGED_RUNS, chance)
            return "" if enough else f"{n - self.warned} of {n} carry no flag"
        if wanted == MOSTLY_FLAGGED:
            good = sum(one.warned or one.covered for one in self.claims)
            enough = not too_few(good, n, MOST, chance)
            return "" if enough else f"{n - good} of {n} are wrong without a flag"
        if wanted == COVERED_OR_FLAGGED:
            silent = self._wrong_among(self.silent, chance, "without a flag ")
            return silent or self._too_wide(self._widest_at_all(chance))
        finding = self._wrong_among(self.claims, chance)
        if finding or wanted == COVERED:
            return finding or self._too_wide(self._widest_at_all(chance))
        if wanted == COVERED_AS_STUDENT:
            return self._too_wide(self.widest_mean(chance))
        if wanted == COVERED_AND_NARROW:
            return self._flagged_clean(n, chance) or self._not_as_wide_as_errors(n, chance)
        most = PROBABILITY_OF_BOUND if wanted == COVERED_WITH_BOUND else PROBABILITY
        if too_many(self.covered, n, most, chance):
            return f"{self.covered} of {n} are covered: u is too large"
        if wanted == COVERED_WITH_BOUND:
            widest = widest_of(WIDEST_BOUND, n, chance)
            return self._flagged_clean(n, chance) or self._too_wide(widest)
        if wanted == COVERED_NO_MORE:
            return ""
        widest = self.widest_mean(chance) if self.few_repeats else widest_of(2.0, n, chance)
        return self._flagged_clean(n, chance) or self._too_wide(widest)

    def _flagged_clean(self, n, chance):
        flagged = too_few(n - self.warned, n, UNFLAGGED_CLAIMS, chance)
        return f"{self.warned} of {n} carry a flag" if flagged else ""

    def _widest_at_all(self, chance):
        return max(WIDEST, widest_of(2.0, len(self.numbers), chance)) if self.numbers else WIDEST

    def _not_as_wide_as_errors(self, n, chance):
        least, most = 2.0 * NARROWEST_CLEAN / most_rms(n, chance), 2.0 * WIDEST_CLEAN
        # A smaller chance is that of another seed, for all rows together.
        is_known = n >= KNOWN_RMS and chance >= CHANCE
        most = most if is_known else widest_of(most, n, chance)
        narrow = self.width < least
        return f"U is {self.width:.1f} times the rms" if narrow else self._too_wide(most)

    def widest_mean(self, chance=CHANCE):
        """U against the rms of the errors, by the usual factor of those that the results state.
        REQUIRES: numbers."""
        k = float(np.median([one.k for one in self.numbers]))
        return widest_of(BEYOND_STUDENT * k, len(self.numbers), chance)

    def _wrong_among(self, claims, chance, which=""):
        n, covered = len(claims), sum(one.covered for one in claims)
        if n and too_few(covered, n, PROBABILITY, chance):
            return f"{n - covered} of {n} {which}are not covered"
        far_off = 0 if self.few_repeats else self._far_off_among(claims, chance)
        return f"{far_off} of {n} {which}are off by more than {FAR_OFF:g} U" if far_off else ""

    @staticmethod
    def _far_off_among(claims, chance):
        """How many, unless that is chance of another seed."""
        far_off = sum(one.far_off() for one in claims)
        is_chance = (
            chance < CHANCE
            and not any(one.far_off(2.0 * FAR_OFF) for one in claims)
            and not too_many(far_off, len(claims), FAR_OFF_BY_CHANCE, chance)
        )
        return 0 if is_chance else far_off

    def _too_wide(self, widest):
        return f"U is {self.width:.1f} times the rms of the errors" if self.width > widest else ""
