"""Universal File Format, data sets 58 and 58b: responses over time (library: pyuff).

Its abscissa increment has six digits (1.95313e-05 s for 1/51200 s: 2.6e-6 off), so that the sample
rate should be stated. Times begin at the abscissa's minimum, in a clock of their own.
"""

import math
import pathlib
from typing import Any

import numpy as np

from dyncal_convert.series import (
    Channel,
    Conversion,
    ConversionError,
    Series,
    grouped,
    library,
    regular_stamps,
    unique,
)

TIME_RESPONSE = 1  # function type
REAL_TYPES = {2, 4}  # single, double
DIRECTIONS = {0: "", 1: "x", 2: "y", 3: "z", 4: "rx", 5: "ry", 6: "rz"}
NANOSECONDS = 1e9
MARK = b"    -1"  # a line before and behind each data set; behind numbers in binary no new line


def text_of(data: dict[str, Any], key: str) -> str:
    text = str(data.get(key) or "").strip()
    return "" if text.upper() in ("NONE", "NULL") else text


def name_of(data: dict[str, Any]) -> str:
    if name := text_of(data, "id1"):
        return name
    direction = int(data.get("rsp_dir") or 0)
    sign = "minus_" if direction < 0 else ""
    axis = DIRECTIONS.get(abs(direction), str(abs(direction)))
    return f"node_{int(data.get('rsp_node') or 0)}_{sign}{axis}"


def stamps_of(data: dict[str, Any], rate_hz: float | None, place: str) -> Any:
    if int(data["abscissa_spacing"]) == 0:
        return np.round(np.asarray(data["x"], dtype=np.float64) * NANOSECONDS).astype(np.int64)
    interval_s = 1.0 / rate_hz if rate_hz else float(data["abscissa_inc"])
    if not (math.isfinite(interval_s) and interval_s > 0.0):
        raise ConversionError(f"{place}: the abscissa increment is {interval_s}: state --rate")
    start_ns = round(float(data["abscissa_min"]) * NANOSECONDS)
    return regular_stamps(start_ns, interval_s, len(data["data"]))


def series_of(data: dict[str, Any], rate_hz: float | None, place: str, taken: set[str]) -> Series:
    values = np.asarray(data["data"])
    if len(values) != int(data["num_pts"]):
        raise ConversionError(
            f"{place}: states {int(data['num_pts'])} values and holds {len(values)}: the file is "
            f"cut or damaged"
        )
    unit = text_of(data, "ordinate_axis_units_lab")
    channel = Channel(unique(name_of(data), taken), values, unit)
    return Series(
        name="uff58",
        stamps_ns=stamps_of(data, rate_hz, place),
        sample_numbers=np.arange(len(values), dtype=np.uint64),
        channels=[channel],
    )


def rate_note(data: dict[str, Any]) -> str:
    rate_hz = 1.0 / float(data["abscissa_inc"])
    if abs(rate_hz - round(rate_hz)) <= 1e-9 * rate_hz:
        return ""
    return (
        f"its abscissa increment has few digits and makes {rate_hz:.10g} Hz: if the instrument "
        f"has another rate, state it with --rate"
    )


def read(path: pathlib.Path, rate_hz: float | None) -> Conversion:
    pyuff = library("pyuff", "uff")
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise ConversionError(f"{path}: cannot be read: {problem.strerror}") from problem
    if not content.lstrip().startswith(b"-1"):
        raise ConversionError(f"{path}: does not begin with a data set: it is no universal file")
    end = content.rstrip()
    if not end.endswith(MARK) or end.removesuffix(MARK).rstrip().endswith(b"\n" + MARK):
        raise ConversionError(f"{path}: the last data set does not end: the file is cut")
    result = Conversion()
    taken: set[str] = set()
    series: list[Series] = []
    file = pyuff.UFF(str(path))
    for number, kind in enumerate(file.get_set_types()):
        place = f"{path}: data set {number + 1}"
        if int(kind) != 58:
            result.notes.append(f"{place} is of type {int(kind)} and left out")
            continue
        try:
            data = file.read_sets(number)
        except Exception as problem:  # the library raises Exception itself
            raise ConversionError(f"{place}: cannot be read: {problem}") from problem
        if int(data["func_type"]) != TIME_RESPONSE or int(data["ord_data_type"]) not in REAL_TYPES:
            result.notes.append(f"{place} is no response over time and left out")
            continue
        series.append(series_of(data, rate_hz, place, taken))
        if rate_hz is None and int(data["abscissa_spacing"]) == 1 and (note := rate_note(data)):
            result.notes.append(f"{place}: {note}")
    result.series = grouped(series)
    return result
