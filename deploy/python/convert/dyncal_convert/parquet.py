"""Parquet (library: pyarrow): a column a channel.

Time is the column `t_ns` (int64 nanoseconds since 1970), the only column of timestamps, or the one
that --time names; without one, --rate. `sample_number` shows gaps. The unit of a column stands in
its field's metadata (`unit` or `units`) or in brackets behind its name (`sync [V]`). A null is a
value that was not measured, but not in the column of time.
"""

import pathlib
import re
from typing import Any

import numpy as np

from dyncal_convert.series import (
    Channel,
    Conversion,
    ConversionError,
    Series,
    library,
    regular_stamps,
)

NANOSECONDS_PER = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}


def name_and_unit(field: Any) -> tuple[str, str]:
    metadata = field.metadata or {}
    for key in (b"unit", b"units"):
        if key in metadata:
            return field.name, metadata[key].decode("utf-8", "replace")
    in_brackets = re.fullmatch(r"(.+?) \[(.+)\]", field.name)
    return (in_brackets[1], in_brackets[2]) if in_brackets else (field.name, "")


def time_column(schema: Any, named: str | None, place: str) -> str | None:
    types = library("pyarrow.types", "parquet")
    if named is not None:
        if named not in schema.names:
            raise ConversionError(f"{place}: has no column '{named}': {', '.join(schema.names)}")
        return named
    if "t_ns" in schema.names:
        return "t_ns"
    stamps = [field.name for field in schema if types.is_timestamp(field.type)]
    if len(stamps) > 1:
        raise ConversionError(f"{place}: has several times, name one with --time: {stamps}")
    return stamps[0] if stamps else None


def without_nulls(column: Any, name: str, place: str) -> None:
    if column.null_count:
        row = column.is_null().to_pylist().index(True)
        raise ConversionError(f"{place}: column '{name}', row {row + 1}: is null")


def stamps_of(table: Any, name: str, place: str) -> tuple[Any, bool]:
    """And whether they are UTC."""
    types = library("pyarrow.types", "parquet")
    pyarrow = library("pyarrow", "parquet")
    column = table.column(name)
    without_nulls(column, name, place)
    if types.is_timestamp(column.type):
        factor = NANOSECONDS_PER[column.type.unit]
        counts = column.cast(pyarrow.int64()).to_numpy()
        if counts.size and max(-int(counts.min()), int(counts.max())) > (2**63 - 1) // factor:
            raise ConversionError(f"{place}: column '{name}' has times beyond the year 2262")
        return counts * factor, column.type.tz is not None
    if types.is_integer(column.type):
        return column.cast(pyarrow.int64()).to_numpy(), False
    raise ConversionError(
        f"{place}: column '{name}' is {column.type}: a time is a timestamp, or whole nanoseconds"
    )


def numbers_of(table: Any, place: str) -> Any:
    types = library("pyarrow.types", "parquet")
    if "sample_number" not in table.schema.names:
        return np.arange(table.num_rows, dtype=np.uint64)
    column = table.column("sample_number")
    without_nulls(column, "sample_number", place)
    if not types.is_integer(column.type):
        raise ConversionError(f"{place}: column 'sample_number' is {column.type}, no whole number")
    numbers = column.to_numpy().astype(np.int64)
    wrong = np.flatnonzero(np.diff(numbers) <= 0)
    if len(numbers) and numbers[0] < 0 or len(wrong):
        row = int(wrong[0]) + 2 if len(wrong) else 1
        raise ConversionError(f"{place}: column 'sample_number', row {row}: does not rise")
    return numbers.astype(np.uint64)


def values_of(column: Any) -> Any:
    """Whole numbers with nulls become float64, others keep their type."""
    pyarrow = library("pyarrow", "parquet")
    types = library("pyarrow.types", "parquet")
    if types.is_boolean(column.type):
        column = column.cast(pyarrow.uint8())
    if column.null_count and types.is_integer(column.type):
        column = column.cast(pyarrow.float64(), safe=True)
    values = column.to_numpy()
    return values.astype(np.float32) if values.dtype == np.float16 else values


def channels_of(table: Any, others: set[str | None], place: str, notes: list[str]) -> list[Channel]:
    types = library("pyarrow.types", "parquet")
    channels = []
    for field in table.schema:
        if field.name in others:
            continue
        is_number = types.is_integer(field.type) or types.is_floating(field.type)
        if not (is_number or types.is_boolean(field.type)):
            notes.append(f"{place}: column '{field.name}' is {field.type} and left out")
            continue
        name, unit = name_and_unit(field)
        try:
            values = values_of(table.column(field.name))
        except Exception as problem:
            raise ConversionError(f"{place}: column '{field.name}': {problem}") from problem
        channels.append(Channel(name, values, unit))
    return channels


def read(path: pathlib.Path, rate_hz: float | None, time_name: str | None) -> Conversion:
    parquet = library("pyarrow.parquet", "parquet")
    place = str(path)
    try:
        table = parquet.read_table(path)
    except Exception as problem:
        raise ConversionError(f"{path}: is no whole Parquet file: {problem}") from problem
    result = Conversion()
    time = time_column(table.schema, time_name, place)
    is_utc = False
    if rate_hz is not None:
        stamps = regular_stamps(0, 1.0 / rate_hz, table.num_rows)
        if time is not None:
            result.notes.append(f"{place}: column '{time}' is left out: --rate gives the times")
    elif time is not None:
        stamps, is_utc = stamps_of(table, time, place)
    else:
        raise ConversionError(f"{place}: has no column of times: name one with --time, or --rate")
    channels = channels_of(table, {time, "sample_number"}, place, result.notes)
    if not channels or table.num_rows == 0:
        return result
    result.series.append(
        Series(
            name=path.stem,
            stamps_ns=stamps,
            sample_numbers=numbers_of(table, place),
            channels=channels,
            is_utc=is_utc,
        )
    )
    return result
