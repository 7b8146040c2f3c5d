"""Result files of dyncal as pandas data frames and xarray data sets.

`read_result` reads what `dyncal run` and `dyncal analyse` wrote, by the rules of the programs
(services/views/report/stored_result.hpp): another schema, a version it does not know, or a file
that deviates from the schema is refused with the sentence of the programs. Numbers are those of the
file, to the last bit; what is not known is NaN, and degrees of freedom without an end are infinite.
pandas and xarray are imported when they are asked
for.
"""

from __future__ import annotations

import functools
import importlib.resources
import json
import math
import os
import pathlib
from typing import TYPE_CHECKING, Any

from ._dyncal import contribution_identifier
from .errors import Error
from .schema import deviation_from

if TYPE_CHECKING:
    import pandas
    import xarray

SCHEMA_VERSION = 2
# Of the means: what a data set has as variables over channel and frequency.
MEAN_UNITS = {
    "magnitude": "",  # that of the channel
    "u_magnitude": "",
    "U_magnitude": "",
    "k_magnitude": "1",
    "phase_rad": "rad",
    "u_phase_rad": "rad",
    "U_phase_rad": "rad",
    "k_phase": "1",
    "unwrapped_phase_rad": "rad",
    "scatter_magnitude": "",
    "scatter_phase_rad": "rad",
    "repetitions": "1",
}


class Result:
    """A result file. `json` is its content as it stands there, None where it has null."""

    def __init__(self, content: dict[str, Any], path: pathlib.Path) -> None:
        self.json = content
        self.path = path

    def to_pandas(self) -> pandas.DataFrame:
        """The means over repetitions, a row a channel and frequency: `transfer_function`.

        Columns are the members of result.schema.json with their units in their names; U_ is
        expanded, u_ standard uncertainty. `flag_names` is a list: look at it before you use a
        value. Phase is lead in rad.
        """
        return _frame(self.json["transfer_function"])

    def points(self) -> pandas.DataFrame:
        """Every single result, a row a step, channel and repetition: `points`.

        Points without a value have `valid` False and their reason in `problem`.
        """
        return _frame(self.json["points"])

    def budgets(self) -> pandas.DataFrame:
        """The rows of all budgets, each with channel, step, repetition and frequency of its point.

        `u_magnitude_rel` is relative, `u_phase_rad` in rad; both standard uncertainties.
        """
        rows = []
        for point in self.json["points"]:
            place = {
                name: point[name] for name in ("channel", "step", "repetition", "frequency_hz")
            }
            rows += [{**place, **row} for row in point.get("budget", [])]
        return _frame(rows)

    def group_delays(self) -> pandas.DataFrame:
        """A row a channel: `value_s`, `u_s`, `intercept_rad`, ...: `group_delay`."""
        return _frame(self.json["group_delay"])

    def to_xarray(self) -> xarray.Dataset:
        """The means over (channel, frequency_hz), one excitation level each.

        `h` is complex; `u_` and `U_` are variables of their own; units are in the attributes, those
        of magnitudes in the coordinate `unit` of the channel. Raises Error (invalid_argument) where
        a channel has a frequency twice, as at several levels: take to_pandas() then.
        """
        import numpy
        import xarray

        rows = self.json["transfer_function"]
        channels = list(dict.fromkeys(row["channel"] for row in rows))
        frequencies = sorted({row["frequency_hz"] for row in rows})
        shape = len(channels), len(frequencies)
        values = {name: numpy.full(shape, math.nan) for name in MEAN_UNITS}
        filled = set()
        units = dict.fromkeys(channels, "")
        for row in rows:
            place = channels.index(row["channel"]), frequencies.index(row["frequency_hz"])
            if place in filled:
                raise Error(
                    "invalid_argument",
                    f"{row['channel']} has {row['frequency_text_hz']} Hz twice, at several levels "
                    "or axes: a data set has room for one; take to_pandas()",
                )
            filled.add(place)
            units[row["channel"]] = row["unit"] or ""
            for name, array in values.items():
                array[place] = math.nan if row[name] is None else row[name]
        dims = ("channel", "frequency_hz")
        variables: dict[str, Any] = {
            name: (dims, array, {"units": MEAN_UNITS[name]}) for name, array in values.items()
        }
        phasors = values["magnitude"] * numpy.exp(1j * values["phase_rad"])
        variables["h"] = (dims, phasors, {"phase": "lead, a delay is negative"})
        coordinates = {
            "channel": channels,
            "frequency_hz": ("frequency_hz", frequencies, {"units": "Hz"}),
            "unit": ("channel", list(units.values())),
        }
        attributes = {name: self.json[name] for name in ("bench", "run", "method", "software")}
        return xarray.Dataset(variables, coordinates, attributes)

    def __repr__(self) -> str:
        means = len(self.json["transfer_function"])
        return f"Result({str(self.path)!r}, run {self.json['run']!r}, {means} means)"


def read_result(path: str | os.PathLike[str]) -> Result:
    """The result file of a run; a folder stands for the result.json in it.

    Raises Error (bad_file): it is not there, is not JSON, has another schema or version, deviates
    from it, or has single results but no means.
    """
    file = pathlib.Path(path)
    file = file / "result.json" if file.is_dir() else file
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Error("bad_file", f"{file}: cannot be read: {error}") from None
    try:
        content = json.loads(text, parse_constant=_refuse_constant, parse_int=_whole)
    except ValueError:
        raise _refused(
            file,
            "not JSON, or not all of it; give a file that dyncal run or dyncal analyse wrote",
        ) from None
    if other := _other_schema(content):
        raise _refused(file, other)
    _upgrade(content)
    if deviation := deviation_from(_schema(), content):
        raise _refused(file, deviation)
    valid = sum(point["valid"] for point in content["points"])
    if valid and not content["transfer_function"]:
        raise _refused(
            file,
            f"transfer_function is empty, but {valid} single results have a value: its run lost "
            "its analysis before the means were taken, or the file was changed; evaluate the "
            "recording of the run once more with 'dyncal analyse'",
        )
    return Result(content, file)


@functools.cache
def _schema() -> dict[str, Any]:
    text = importlib.resources.files(__package__).joinpath("result.schema.json").read_text()
    schema: dict[str, Any] = json.loads(text)
    return schema


def _refused(file: pathlib.Path, why: str) -> Error:
    return Error("bad_file", f"{file}: {why}")


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not JSON")


def _whole(digits: str) -> int | float:
    """What 64 bits cannot hold is a double, as in the programs."""
    number = int(digits) if len(digits) < 25 else 2**64
    return number if -(2**63) <= number < 2**64 else float(digits)


def _other_schema(content: Any) -> str | None:
    schema = content.get("schema") if isinstance(content, dict) else None
    if not isinstance(schema, dict):
        return (
            "there is no 'schema' in it, so it is not a result that dyncal 0.2 or later wrote; "
            "evaluate the run again"
        )
    if schema.get("name") != "dyncal-result":
        name = json.dumps(schema.get("name"), ensure_ascii=False)[:60]
        return (
            f'its schema is {name}, not "dyncal-result", which dyncal run and dyncal analyse write'
        )
    version = schema.get("version")
    if isinstance(version, bool) or version not in (1, SCHEMA_VERSION):
        return (
            f"it has version {json.dumps(version, ensure_ascii=False)[:60]} of the schema, and "
            f"this dyncal reads versions 1 to {SCHEMA_VERSION}; use the dyncal that wrote it, or a "
            "newer one"
        )
    return None


def _upgrade(content: dict[str, Any]) -> None:
    """Names that meant two things have one meaning since version 2."""
    if content["schema"]["version"] != 1:
        return
    content["schema"]["version"] = SCHEMA_VERSION
    _rename(content, "flags", "flag_legend")
    for clock in _list(content, "sample_clock"):
        _rename(clock, "events", "event_count")
        _rename(clock, "event_list", "events")
    for point in _list(content, "points"):
        for row in _list(point, "budget"):
            if isinstance(row, dict) and isinstance(row.get("kind"), str):
                row["kind"] = contribution_identifier(row["kind"])


def _rename(member: Any, old: str, new: str) -> None:
    if isinstance(member, dict) and old in member:
        member[new] = member.pop(old)


def _list(content: Any, name: str) -> list[Any]:
    found = content.get(name) if isinstance(content, dict) else None
    return found if isinstance(found, list) else []


def _frame(rows: list[dict[str, Any]]) -> pandas.DataFrame:
    import pandas

    names = dict.fromkeys(name for row in rows for name in row)
    columns: dict[str, Any] = {}
    for name in names:
        values = [row.get(name) for row in rows]
        if all(value is None or _is_float(value) for value in values):
            if any(value is None or isinstance(value, float) for value in values):
                # A member that is not there is not known, whatever null would say.
                columns[name] = [
                    _number(name, value) if name in row else math.nan
                    for row, value in zip(rows, values)
                ]
                continue
        columns[name] = values
    return pandas.DataFrame(columns)


def _number(name: str, value: float | None) -> float:
    """null stands for degrees of freedom that are infinite, elsewhere for what is not known."""
    if value is None:
        is_freedom = name.startswith("nu_eff") or name == "degrees_of_freedom"
        return math.inf if is_freedom else math.nan
    return value


def _is_float(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
