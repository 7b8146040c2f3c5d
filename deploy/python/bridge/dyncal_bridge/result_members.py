"""Messages of results as members of the result file (share/dyncal/result.schema.json).

Names and numbers are those of `points`, `transfer_function`, `channels` and `group_delay` there, to
the last bit; so are the derived ones (degrees, k, nu_eff, U). Members of a point that the file has
and the bridge has not: budget, signals, source_samples, fit, monte_carlo and what is measured of
the excitation; they stand in the file of the run. Plain functions, any thread.
"""

from __future__ import annotations

import math
from typing import Any

import dyncal

from dyncal_bridge.document import Members

DEGREES = 180.0 / math.pi
COVERAGE_PROBABILITY = 0.95449973610364158  # of U, as the file states it


def number(value: float) -> float | None:
    """What is not finite is not known to JSON."""
    return value if math.isfinite(value) else None


def degrees(angle_rad: float) -> float | None:
    return number(angle_rad * DEGREES)


def word(value: Any, prefix: str) -> str:
    """SOURCE_RUNNING without its prefix, in small letters; an unknown number as it is."""
    name: str = getattr(value, "name", str(value))
    return name.removeprefix(prefix).lower()


def flags(message: Any) -> Members:
    return {"flags": list(message.flags), "flag_names": list(message.flag_names)}


def expanded(prefix: str, suffix: str, k: float, nu_eff: float, u_expanded: float) -> Members:
    return {
        f"k_{prefix}": number(k),
        f"nu_eff_{prefix}": number(nu_eff),
        f"U_{prefix}{suffix}": number(u_expanded),
    }


def freedom_of(budget: list[Any], member: str) -> float:
    """Effective degrees of freedom of a point by Welch and Satterthwaite over its budget."""
    try:
        parts = [
            dyncal.UncertaintyPart(getattr(row, member), row.degrees_of_freedom) for row in budget
        ]
        return dyncal.combine(parts).degrees_of_freedom
    except dyncal.Error:
        return math.nan


def point_uncertainty(message: Any) -> Members:
    members: Members = {"u_phase_deg": degrees(message.u_phase_rad)}
    for prefix, suffix, row_member, u in (
        ("magnitude", "", "u_magnitude_rel", message.u_magnitude),
        ("phase", "_rad", "u_phase_rad", message.u_phase_rad),
    ):
        nu_eff = freedom_of(message.budget, row_member)
        k = math.nan if math.isnan(nu_eff) else dyncal.coverage_factor(nu_eff)
        members |= expanded(prefix, suffix, k, nu_eff, k * u)
    u_phase = members["U_phase_rad"]
    members["U_phase_deg"] = None if u_phase is None else degrees(u_phase)
    return members | {"coverage_probability": COVERAGE_PROBABILITY}


def point(message: Any) -> Members:
    """Of a CalibrationResult: bench, run, provisional, and the members of a row of `points`."""
    members: Members = {
        "bench": message.bench,
        "run": message.run,
        "channel": message.channel,
        "step": message.step,
        "frequency_text_hz": message.frequency_text_hz,
        "frequency_hz": number(message.frequency_hz),
        "level_m_s2": number(message.level_m_s2),
        "repetition": message.repetition,
        "valid": message.valid,
        "provisional": message.provisional,
        "magnitude": number(message.magnitude),
        "u_magnitude": number(message.u_magnitude),
        "phase_rad": number(message.phase_rad),
        "phase_deg": degrees(message.phase_rad),
        "u_phase_rad": number(message.u_phase_rad),
        "unit": message.unit,
        "lost": message.lost,
        "samples": {one.source: one.used for one in message.samples},
        **flags(message),
        "data_sha256": message.data_sha256,
    }
    if message.excited_axis:
        members["excited_axis"] = message.excited_axis
    members |= point_uncertainty(message) if message.valid else {"problem": message.problem}
    if message.temperature_valid:
        members["temperature_degc"] = number(message.temperature_degc)
    if message.attempt > 1:
        members["attempt"] = message.attempt
    return members


def mean_uncertainty(point_message: Any, mean: Any) -> Members:
    """u and U of a mean, whose message has U / 2 and k."""
    members: Members = {}
    for prefix, suffix, half, k, nu_eff in (
        (
            "magnitude",
            "",
            point_message.u_magnitude,
            mean.k_magnitude,
            mean.degrees_of_freedom_magnitude,
        ),
        ("phase", "_rad", point_message.u_phase_rad, mean.k_phase, mean.degrees_of_freedom_phase),
    ):
        factor = k if math.isfinite(k) and k > 0.0 else 2.0
        members[f"u_{prefix}{suffix}"] = number(2.0 * half / factor)
        members |= expanded(prefix, suffix, factor, nu_eff, 2.0 * half)
    for name in ("u_phase", "U_phase"):
        in_rad = members[f"{name}_rad"]
        members[f"{name}_deg"] = None if in_rad is None else degrees(in_rad)
    members["coverage_probability"] = COVERAGE_PROBABILITY
    members["u_independent_phase_rad"] = number(mean.u_independent_phase_rad)
    return members


def mean_row(function: Any, at: int) -> Members:
    """A row of `transfer_function`, but for its flags, which are those of its points, too."""
    one = function.points[at]
    members: Members = {
        "channel": function.channel,
        "unit": function.unit,
        "frequency_text_hz": one.frequency_text_hz,
        "frequency_hz": number(one.frequency_hz),
        "level_m_s2": number(one.level_m_s2),
        "magnitude": number(one.magnitude),
        "phase_rad": number(one.phase_rad),
        "phase_deg": degrees(one.phase_rad),
        "unwrapped_phase_rad": number(one.unwrapped_phase_rad),
        "unwrapped_phase_deg": degrees(one.unwrapped_phase_rad),
        "scatter_magnitude": number(one.scatter_magnitude),
        "scatter_phase_rad": number(one.scatter_phase_rad),
        "repetitions": one.repetitions,
    }
    if function.excited_axis:
        members["excited_axis"] = function.excited_axis
    if at < len(function.mean_uncertainties):
        members |= mean_uncertainty(one, function.mean_uncertainties[at])
    return members


def group_delay(function: Any) -> Members | None:
    """The row of `group_delay`; None where the phase has none."""
    if not function.group_delay_valid or not function.k_group_delay > 0.0:
        return None
    return {
        "channel": function.channel,
        "value_s": number(function.group_delay_s),
        "u_s": number(function.combined_u_group_delay_s),
        "intercept_rad": number(function.intercept_rad),
        "intercept_deg": degrees(function.intercept_rad),
        "u_intercept_rad": number(function.combined_u_intercept_rad),
        "u_intercept_deg": degrees(function.combined_u_intercept_rad),
        "cov_delay_intercept_rad_s": number(function.cov_delay_intercept_rad_s),
        "chi_squared": number(function.group_delay_chi_squared),
        "degrees_of_freedom": number(function.group_delay_degrees_of_freedom),
        "polarity_inverted": function.polarity_inverted,
        "k": number(function.k_group_delay),
        "nu_eff": number(function.nu_eff_group_delay),
        "U_s": number(function.k_group_delay * function.combined_u_group_delay_s),
        "k_intercept": number(function.k_intercept),
        "nu_eff_intercept": number(function.nu_eff_intercept),
        "U_intercept_rad": number(function.k_intercept * function.combined_u_intercept_rad),
    }


def transfer_function(function: Any) -> Members:
    """Of a TransferFunction: bench, run, method, the row of `channels`, and the rows of the means.

    `flags` are those of the channel; those of single results stand with the points.
    """
    return {
        "bench": function.bench,
        "run": function.run,
        "channel": function.channel,
        "method": word(function.method, "METHOD_").replace("_", "-"),
        "unit": function.unit,
        "lost": function.lost,
        **flags(function),
        "group_delay_problem": function.group_delay_problem,
        "transfer_function": [mean_row(function, at) for at in range(len(function.points))],
        "group_delay": group_delay(function),
    }
