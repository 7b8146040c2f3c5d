"""The program `dyncal-bridge`."""

from __future__ import annotations

import argparse
import importlib
import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Sequence

from dyncal.dds.security import revoked_list

from dyncal_bridge.document import BridgeError
from dyncal_bridge.laboratory import Laboratory
from dyncal_bridge.options import arguments
from dyncal_bridge.participant import NetworkOptions, check_security, join
from dyncal_bridge.plug import Plug
from dyncal_bridge.service_manager import notify
from dyncal_bridge.settings import Settings, read_settings

STOP_WITHIN_S = 1.5
LOOK_S = 1.0
REPORT_S = 60.0
MAX_TURN_S = 15.0  # the reading thread hangs beyond it; systemd is told nothing more
# The table of a plug: its module, class, and the package of PyPI that it needs.
PLUGS = {
    "foxglove": ("foxglove_plug", "FoxglovePlug", "foxglove-sdk"),
    "mqtt": ("mqtt_plug", "MqttPlug", "paho-mqtt"),
    "opcua": ("opcua_plug", "OpcuaPlug", "asyncua"),
}
log = logging.getLogger("dyncal-bridge")


def plugs_of(settings: Settings) -> list[Plug]:
    """Those whose table is there; a package is imported when its plug is wanted."""
    plugs: list[Plug] = []
    for name, (module, class_name, package) in PLUGS.items():
        of_plug = getattr(settings, name)
        if of_plug is None:
            continue
        try:
            imported = importlib.import_module(f"dyncal_bridge.{module}")
        except ImportError as missing:
            raise BridgeError(
                f"[{name}] needs the Python package {package}: pip install "
                f"'dyncal-bridge[{name}]' ({missing})"
            ) from None
        plugs.append(getattr(imported, class_name)(of_plug))
    return plugs


def network_options(options: argparse.Namespace) -> NetworkOptions:
    return NetworkOptions(
        options.domain,
        options.interface,
        options.peer,
        not options.no_multicast,
        options.security,
    )


def report(plugs: Sequence[Plug], laboratory: Laboratory, said: dict[str, str]) -> None:
    """What was not handed on, where that has changed."""
    lines = {plug.name: ", ".join(f"{k} {v}" for k, v in plug.counts().items()) for plug in plugs}
    left_out = laboratory.view.left_out
    lines["laboratory"] = (
        f"messages beyond limits {left_out.beyond_limits}, of earlier runs "
        f"{left_out.of_earlier_runs}, refused {laboratory.refused_messages}; blocks of samples "
        f"lost {laboratory.feed.lost_blocks}"
    )
    for name, line in lines.items():
        if said.get(name, line) != line:
            log.info("%s: %s", name, line)
        said[name] = line


def serve(
    plugs: Sequence[Plug],
    laboratory: Laboratory,
    ending: threading.Event,
    revoked: RevokedCertificates,
) -> None:
    """Until it is to end, or the list of revoked certificates is another one."""
    for plug in plugs:
        plug.start()
    laboratory.start()
    notify("READY=1\nSTATUS=hands on to " + ", ".join(plug.name for plug in plugs))
    log.info("hands on to %s", ", ".join(plug.name for plug in plugs))
    said: dict[str, str] = {}
    report(plugs, laboratory, said)
    next_report_s = time.monotonic() + REPORT_S
    while not ending.wait(LOOK_S) and not revoked.have_changed():
        now_s = time.monotonic()
        if now_s - laboratory.turned_s < MAX_TURN_S:
            notify("WATCHDOG=1")
        if now_s >= next_report_s:
            next_report_s = now_s + REPORT_S
            report(plugs, laboratory, said)
    report(plugs, laboratory, said)


def stop(plugs: Sequence[Plug], laboratory: Laboratory) -> None:
    """Asks all at once, and waits for none of them longer than STOP_WITHIN_S together."""
    deadline_s = time.monotonic() + STOP_WITHIN_S
    for plug in plugs:
        plug.stop()
    late = [] if laboratory.stop(deadline_s - time.monotonic()) else ["laboratory"]
    for plug in plugs:
        if not plug.join(max(0.0, deadline_s - time.monotonic())):
            late.append(plug.name)
    if late:
        log.warning("ended without waiting for %s", ", ".join(late))


class RevokedCertificates:
    """The list as it was when this program joined; Cyclone DDS looks at it then, and never again.

    One that is copied once more changes nothing, and one that is half copied is not taken: it is
    another list when two looks, one after the other, find the same whole one. folder: that of a
    secured program, or "".
    """

    def __init__(self, folder: str) -> None:
        self._file = revoked_list(folder) if folder else None
        self._joined_with = self._seen = self._read()

    def have_changed(self) -> bool:
        before, self._seen = self._seen, self._read()
        is_whole = self._seen.rstrip().endswith(b"-----END X509 CRL-----")
        return is_whole and self._seen == before and self._seen != self._joined_with

    def _read(self) -> bytes:
        try:
            return self._file.read_bytes() if self._file else b""
        except OSError:
            return b""  # it is being renewed


def run(options: argparse.Namespace) -> int:
    settings = read_settings(options.settings)
    network = network_options(options)
    check_security(network.security)
    plugs = plugs_of(settings)
    if options.check:
        secured = f", secured by {network.security}" if network.security else ""
        names = ", ".join(plug.name for plug in plugs)
        print(f"ok: {options.settings} hands on to {names}{secured}")
        return 0
    ending = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: ending.set())
    benches = settings.benches or ("*",)
    revoked = RevokedCertificates(network.security)
    laboratory = Laboratory(join(network), network.domain, benches, plugs)
    serve(plugs, laboratory, ending, revoked)
    if ending.is_set():
        notify("STOPPING=1")
    else:
        log.info("the list of revoked certificates is another one: joining anew")
    stop(plugs, laboratory)
    logging.shutdown()
    sys.stdout.flush()
    if not ending.is_set():
        os.execv(sys.executable, sys.orig_argv)
    os._exit(0)  # threads of libraries that still wait for a peer do not hold it up


def main() -> int:
    """0: it has ended as asked; 2: settings or options cannot be used, 1: anything else."""
    options = arguments().parse_args()
    logging.basicConfig(
        stream=sys.stderr,
        level=logging.INFO,
        format="%(asctime)s %(name)s %(levelname)s: %(message)s",
    )
    try:
        return run(options)
    except BridgeError as problem:
        print(f"dyncal-bridge: {problem}", file=sys.stderr)
        return 2
