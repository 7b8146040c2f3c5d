"""An analogue calibration system of one's own: a stream that dyncal-acs reads.

    from dyncal.acs import Channel, Stream
    channels = [
        Channel("reference", "Acceleration", r"\\metre\\second\\tothe{-2}", -50, 50),
        Channel("sync", "Voltage", r"\\volt", -10, 10),
    ]
    with Stream(5026, "My card", "17", 20000, channels) as stream:
        while True:
            stream.send(card.read())  # (samples, channels)

The protocol is that of drivers/acs/README.md, version 1. A thread serves the one connection; `send`
never waits for the network: up to `buffer_s` of samples wait for a receiver that is slow, then
whole blocks are left out, which shows in the numbers and in `lost`. While nobody is connected
samples are counted and forgotten.
"""

from __future__ import annotations

import collections
import dataclasses
import fractions
import json
import math
import socket
import struct
import threading
from types import TracebackType
from typing import Any

import numpy
import numpy.typing

from .errors import Error

HEADER = struct.Struct("<4sIQ")
MAGIC = b"ACSF"
MAX_FRAME = 65536  # samples
POLL_S = 0.1  # between looks whether the stream was closed


@dataclasses.dataclass(frozen=True)
class Channel:
    """unit: D-SI, e.g. r"\\volt". minimum, maximum: range in the unit; None: not known.
    scale: unit per count, where integers are sent; then it is also the resolution."""

    name: str
    quantity: str
    unit: str
    minimum: float | None = None
    maximum: float | None = None
    scale: float | None = None

    def description(self) -> dict[str, Any]:
        """As the stream announces it: what is known alone."""
        return {key: value for key, value in dataclasses.asdict(self).items() if value is not None}


class Stream:
    """Serves the samples of a card to dyncal-acs.

    port: of TCP; 0: any, see `port`. rate: samples a second, as the card's own clock counts: a
    whole number or a Fraction, exact. origin_ns: stamp of sample 0. time_base: "utc" only where
    stamps are true. Blocks are float64 in the units, or int32 counts where channels have a scale.
    Thread rule: `send` by one thread. Raises Error (invalid_argument).
    """

    def __init__(
        self,
        port: int,
        device: str,
        serial: str,
        rate: int | fractions.Fraction,
        channels: list[Channel],
        *,
        host: str = "0.0.0.0",
        firmware: str = "",
        origin_ns: int = 0,
        time_base: str = "local",
        buffer_s: float = 5.0,
    ) -> None:
        exact = fractions.Fraction(rate)
        if exact <= 0 or not channels:
            raise Error("invalid_argument", "a stream needs a positive rate and channels")
        scales = [channel.scale is not None for channel in channels]
        if any(scales) and not all(scales):
            raise Error("invalid_argument", "all channels have a scale, or none has one")
        if time_base not in ("local", "utc"):
            raise Error("invalid_argument", f"time_base is '{time_base}', not 'local' or 'utc'")
        self._type = numpy.dtype("<i4" if all(scales) else "<f8")
        self._width = len(channels)
        description = {
            "protocol": "dyncal-acs-stream",
            "version": 1,
            "device": device,
            "serial": serial,
            "firmware": firmware,
            "sample_rate_hz": {"numerator": exact.numerator, "denominator": exact.denominator},
            "origin_ns": origin_ns,
            "time_base": time_base,
            "values": "int32" if all(scales) else "float64",
            "channels": [channel.description() for channel in channels],
        }
        self._hello = json.dumps(description).encode() + b"\n"
        self._room = max(1, math.ceil(buffer_s * exact))  # samples
        self._next = 0
        self._lost = 0
        self._waiting: collections.deque[tuple[int, bytes]] = collections.deque()
        self._waiting_samples = 0
        self._connected = False
        self._closed = False
        self._ended = False  # the card has, so the receiver is told
        self._changed = threading.Condition()
        self._server = socket.create_server((host, port))
        self._server.settimeout(POLL_S)
        self._thread = threading.Thread(target=self._serve, name="dyncal-acs-stream", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        number: int = self._server.getsockname()[1]
        return number

    @property
    def lost(self) -> int:
        """Samples that a connected receiver did not get: it did not keep up."""
        return self._lost

    @property
    def connected(self) -> bool:
        return self._connected

    def send(
        self, block: numpy.typing.NDArray[Any], first_sample: int | None = None
    ) -> None:
        """The next samples of all channels: (samples, channels), or (samples,) of one channel.

        first_sample: number of the first of them, where the card has lost samples before it; None:
        they follow on the last ones. Raises Error (invalid_argument).
        """
        rows = numpy.atleast_2d(block.T).T if block.ndim == 1 else block
        if rows.ndim != 2 or rows.shape[1] != self._width:
            raise Error(
                "invalid_argument",
                f"a block has the shape {block.shape}, but must be (samples, {self._width})",
            )
        if not numpy.can_cast(rows.dtype, self._type, "safe"):
            raise Error(
                "invalid_argument",
                f"a block is of {rows.dtype}, but the stream sends {self._type.name}: float64 "
                "values, or int32 counts of channels with a scale",
            )
        first = self._next if first_sample is None else first_sample
        if first < self._next:
            raise Error(
                "invalid_argument", f"sample numbers go back from {self._next} to {first}"
            )
        for begin in range(0, len(rows), MAX_FRAME):
            self._queue(rows[begin : begin + MAX_FRAME], first + begin)
        self._next = first + len(rows)

    def wait_for_receiver(self, timeout_s: float | None = None) -> bool:
        """Whether somebody is connected, at the latest after timeout_s (None: no limit)."""
        with self._changed:
            return self._changed.wait_for(lambda: self._connected or self._closed, timeout_s)

    def close(self, patience_s: float = 5.0) -> None:
        """Ends the stream: what waits is sent, then the receiver is told that nothing follows."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._connected, patience_s)
            self._closed = True
            self._changed.notify_all()
        self._thread.join()
        self._server.close()

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _queue(self, rows: numpy.typing.NDArray[Any], first: int) -> None:
        data = numpy.ascontiguousarray(rows, self._type).tobytes()
        with self._changed:
            if not self._connected:
                return
            if self._waiting_samples + len(rows) > self._room:
                self._lost += len(rows)
                return
            self._waiting.append((len(rows), HEADER.pack(MAGIC, len(rows), first) + data))
            self._waiting_samples += len(rows)
            self._changed.notify_all()

    def _serve(self) -> None:
        while not self._closed:
            try:
                client, _ = self._server.accept()
            except TimeoutError:
                continue
            with client:
                try:
                    self._serve_one(client)
                except OSError:
                    pass  # the receiver has left; it may come again
            with self._changed:
                self._connected = False
                self._waiting.clear()
                self._waiting_samples = 0
                self._changed.notify_all()

    def _serve_one(self, client: socket.socket) -> None:
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client.sendall(self._hello)
        with self._changed:
            self._connected = True
            self._changed.notify_all()
        while frame := self._take():
            client.sendall(frame)
        client.sendall(HEADER.pack(MAGIC, 0, self._next))

    def _take(self) -> bytes | None:
        """The next frame; None: nothing follows."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._ended or self._closed)
            if not self._waiting or self._closed:
                return None
            samples, frame = self._waiting.popleft()
            self._waiting_samples -= samples
            return frame
