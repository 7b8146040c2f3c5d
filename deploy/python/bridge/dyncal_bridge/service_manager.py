"""What systemd is told: ready, alive, at its end (sd_notify). Nothing where it did not start us."""

from __future__ import annotations

import os
import socket


def notify(state: str) -> None:
    """READY=1, WATCHDOG=1, STOPPING=1, STATUS=... of sd_notify(3)."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address:
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as to_manager:
        try:
            to_manager.sendto(state.encode(), address.replace("@", "\0", 1))
        except OSError:
            pass  # as libsystemd: a manager that does not listen is no fault of the service
