"""The command line of `dyncal-bridge`. Imports no package, so that it is known without them."""

from __future__ import annotations

import argparse
import os
import pathlib

MAX_DOMAIN = 232


def domain_number(text: str) -> int:
    if not text.isdigit() or int(text) > MAX_DOMAIN:
        raise argparse.ArgumentTypeError(f"'{text}' is no DDS domain from 0 to {MAX_DOMAIN}")
    return int(text)


def arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="dyncal-bridge",
        description="hands live samples, results and states of benches on to Foxglove, MQTT and "
        "OPC UA; reads only",
    )
    parser.add_argument("settings", type=pathlib.Path, help="settings file (TOML)")
    parser.add_argument("--check", action="store_true", help="look at the settings and end")
    parser.add_argument(
        "--domain",
        type=domain_number,
        default=os.environ.get("DYNCAL_DOMAIN", "0"),
        help="DDS domain: one per laboratory (or DYNCAL_DOMAIN; default: 0)",
    )
    parser.add_argument("--interface", default="", help="network interface (name or address)")
    parser.add_argument("--peer", action="append", default=[], help="address of another host")
    parser.add_argument("--no-multicast", action="store_true", help="find others by --peer alone")
    parser.add_argument(
        "--dds",
        choices=["cyclonedds", "fastdds"],
        default="cyclonedds",
        help="accepted as of every program of dyncal; the bridge is always over Cyclone DDS, "
        "which understands both",
    )
    parser.add_argument(
        "--security",
        default=os.environ.get("DYNCAL_SECURITY", ""),
        metavar="FOLDER",
        help="folder with the identity of this program in a secured laboratory, role watcher (or "
        "DYNCAL_SECURITY); needs the bridge of 'install.sh --secured'",
    )
    return parser
