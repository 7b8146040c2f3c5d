"""Writes series as HDF5 of the public SmartUp receiver, which dyncal reads (drivers/files).

    RAWDATA/SERIES  attributes Name, Time_base ("utc" or "local")
      Absolutetime              1 x N, ns
      Absolutetime_uncertainty  1 x N, standard u in ns (Coverage_factor = 1); 0: not known
      Sample_number             1 x N
      Stamp_flags               1 x N; 0: trusted
      CHANNEL                   1 x N, attribute Unit
    QUALITY/SERIES    what the file said of its stamps; dyncal does not look at it

A channel keeps the type of its numbers. The file is written whole or not at all, and none is
written over.
"""

import os
import pathlib
import re
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

from dyncal_convert.series import ConversionError, Series, unique

OF_TIME = {
    "Absolutetime",
    "Absolutetime_uncertainty",
    "Sample_number",
    "Stamp_flags",
    "Time_ticks",
}


def channel_name(text: str) -> str:
    """As dyncal names the channel of a dataset: lower case, _ for what is no letter or digit."""
    return re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_") or "channel"


def group_name(text: str) -> str:
    return re.sub(r"[/\x00-\x1f]+", "_", text).strip(". ") or "series"


def write_series(group: h5py.Group, series: Series) -> None:
    count = len(series.stamps_ns)
    flags = series.stamp_flags if series.stamp_flags is not None else np.zeros(count, np.uint8)
    uncertainties = np.full(count, series.u_stamp_ns, dtype=np.uint32)
    group.attrs["Name"] = series.device or series.name
    group.attrs["Time_base"] = "utc" if series.is_utc else "local"
    rows: dict[str, npt.NDArray[Any]] = {
        "Absolutetime": series.stamps_ns,
        "Absolutetime_uncertainty": uncertainties,
        "Sample_number": series.sample_numbers,
        "Stamp_flags": flags,
    }
    for name, row in rows.items():
        group.create_dataset(name, data=row.reshape(1, -1), compression="gzip", shuffle=True)
    for name in ("Absolutetime", "Absolutetime_uncertainty"):
        group[name].attrs["Unit"] = "\\nano\\second"
    group["Absolutetime_uncertainty"].attrs["Coverage_factor"] = 1.0
    taken = {channel_name(name) for name in OF_TIME}
    for channel in series.channels:
        name = unique(channel_name(channel.name), taken)
        data = np.ascontiguousarray(channel.values).reshape(1, -1)
        dataset = group.create_dataset(name, data=data, compression="gzip", shuffle=True)
        dataset.attrs["Unit"] = channel.unit


def write_quality(group: h5py.Group, series: Series) -> None:
    for name, (unit, numbers) in series.quality.items():
        group.create_dataset(name, data=numbers).attrs["Unit"] = unit


def write(path: pathlib.Path, series: list[Series]) -> None:
    if path.exists():
        raise ConversionError(f"{path}: is there already, and nothing is written over")
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        with h5py.File(part, "w-") as file:
            taken: set[str] = set()
            for one in series:
                name = unique(group_name(one.name), taken)
                write_series(file.create_group(f"RAWDATA/{name}"), one)
                if one.quality:
                    write_quality(file.create_group(f"QUALITY/{name}"), one)
        os.link(part, path)
    except FileExistsError as exists:
        raise ConversionError(f"{path}: is there already, and nothing is written over") from exists
    except OSError as problem:
        raise ConversionError(f"{path}: cannot be written: {problem}") from problem
    finally:
        part.unlink(missing_ok=True)
