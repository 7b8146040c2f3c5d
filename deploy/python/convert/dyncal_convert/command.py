"""The program `dyncal-convert`."""

import argparse
import pathlib
import sys
from collections.abc import Callable

from dyncal_convert import hdf5_file, miniseed, parquet, uff58, xdf
from dyncal_convert.series import Conversion, ConversionError, Series

Reader = Callable[[pathlib.Path, argparse.Namespace], Conversion]
READERS: dict[str, Reader] = {
    "uff": lambda path, options: uff58.read(path, options.rate),
    "mseed": lambda path, options: miniseed.read(path, options.least_timing_quality),
    "parquet": lambda path, options: parquet.read(path, options.rate, options.time),
    "xdf": lambda path, options: xdf.read(path),
}
ENDINGS = {
    ".uff": "uff",
    ".unv": "uff",
    ".uf": "uff",
    ".58": "uff",
    ".mseed": "mseed",
    ".miniseed": "mseed",
    ".ms": "mseed",
    ".parquet": "parquet",
    ".pq": "parquet",
    ".xdf": "xdf",
}


def positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < 1e12:
        raise argparse.ArgumentTypeError(f"'{text}' is no rate above 0, in Hz")
    return value


def percent(text: str) -> int:
    value = int(text)
    if not 0 <= value <= 100:
        raise argparse.ArgumentTypeError(f"'{text}' is not from 0 to 100")
    return value


def arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="dyncal-convert",
        description="converts recorded series to HDF5 that dyncal reads (driver = \"file\")",
    )
    parser.add_argument("input", type=pathlib.Path, help="UFF58, MiniSEED, Parquet or XDF file")
    parser.add_argument("output", type=pathlib.Path, nargs="?", help="default: INPUT with .h5")
    parser.add_argument("--format", choices=sorted(READERS), help="default: by INPUT's ending")
    parser.add_argument("--rate", type=positive, help="sample rate in Hz (UFF58, Parquet)")
    parser.add_argument("--time", help="name of the column of times (Parquet)")
    parser.add_argument(
        "--least-timing-quality",
        type=percent,
        default=1,
        metavar="PERCENT",
        help="stamps of MiniSEED records below it are not trusted (default: 1)",
    )
    return parser


def line_of(series: Series) -> str:
    """What was written of a series, with what its reader must know."""
    names = ", ".join(hdf5_file.channel_name(channel.name) for channel in series.channels)
    line = f"{series.name}: {len(series.stamps_ns)} samples of {names}"
    line += ", UTC" if series.is_utc else ", time base of its own"
    if series.lost:
        line += f", {series.lost} samples lost in gaps"
    untrusted = 0 if series.stamp_flags is None else int((series.stamp_flags != 0).sum())
    if untrusted:
        line += f", {untrusted} stamps not trusted"
    return line


def convert(options: argparse.Namespace) -> None:
    path: pathlib.Path = options.input
    kind = options.format or ENDINGS.get(path.suffix.lower())
    if kind is None:
        raise ConversionError(
            f"{path}: its ending tells no format: name one with --format ({', '.join(READERS)})"
        )
    if not path.is_file():
        raise ConversionError(f"{path}: does not exist or is not a file")
    conversion = READERS[kind](path, options)
    for note in conversion.notes:
        print(f"note: {note}", file=sys.stderr)
    if not conversion.series:
        raise ConversionError(f"{path}: holds no series of numbers")
    output: pathlib.Path = options.output or path.with_suffix(".h5")
    hdf5_file.write(output, conversion.series)
    for series in conversion.series:
        print(line_of(series))
    print(f"wrote {output}")


def main() -> int:
    try:
        convert(arguments().parse_args())
    except ConversionError as problem:
        print(f"dyncal-convert: {problem}", file=sys.stderr)
        return 1
    return 0
