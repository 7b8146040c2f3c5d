"""Foxglove's WebSocket protocol, for Foxglove, Lichtblick and PlotJuggler: package foxglove-sdk.

Topics, JSON with a schema each:

    /BENCH/state                                 the run, its step, its analysis
    /BENCH/sources/SOURCE                        state and counts of an instrument
    /BENCH/points/SOURCE/CHANNEL                 every single result, as it comes
    /BENCH/transfer_functions/SOURCE/CHANNEL     means over repetitions, at the end of a run
    /BENCH/samples/SOURCE/CHANNEL                rows of samples, while somebody looks

"/" and "%" within a name are written as %2F and %25. Who subscribes gets what there is of the
newest run again, and so do the others who look at the same topic. A client that does not read
loses the oldest of 8192 messages, in the server; the bridge does not wait for it.
"""

from __future__ import annotations

import collections
import json
import math
from collections.abc import Sequence
from typing import Any

import foxglove
from foxglove.websocket import ChannelView, Client, WebSocketServer

from dyncal_bridge.document import BridgeError, ChannelSamples, Document, Item, Members, NewRun
from dyncal_bridge.plug import Plug, path_of
from dyncal_bridge.schemas import schema_of
from dyncal_bridge.settings import FoxgloveSettings

BACKLOG = 8192  # messages a client
MAX_TOPICS = 4096


def topic_of(*names: str) -> str:
    """Slashes are only between names."""
    return "".join("/" + name.replace("%", "%25").replace("/", "%2F") for name in names)


class FoxglovePlug(Plug):
    def __init__(self, settings: FoxgloveSettings) -> None:
        super().__init__("foxglove", settings.max_rate_hz)
        self._settings = settings
        self._server: WebSocketServer | None = None
        self._context = foxglove.Context()
        self._channels: dict[str, foxglove.Channel] = {}
        self._kept: dict[str, dict[tuple[str, ...], Document]] = {}
        self._subscribers: dict[str, set[int]] = {}
        self._asked: collections.deque[str] = collections.deque(maxlen=MAX_TOPICS)
        self._beyond = 0

    def open(self) -> None:
        one = self._settings
        try:
            self._server = foxglove.start_server(
                name="dyncal",
                host=one.listen.host,
                port=one.listen.port,
                server_listener=self,  # type: ignore[arg-type]
                context=self._context,
                message_backlog_size=BACKLOG,
                tls_cert=one.tls_certificate.read_bytes() if one.tls_certificate else None,
                tls_key=one.tls_key.read_bytes() if one.tls_key else None,
            )
        except (OSError, RuntimeError) as problem:
            raise BridgeError(
                f"[foxglove] cannot listen on {one.listen.host}:{one.listen.port}: {problem}; "
                "does another program have the port?"
            ) from None
        self.log.info("listening on %s:%d", one.listen.host, self._server.port)

    def close(self) -> None:
        if self._server:
            self._server.stop()
            self._server = None
        self._subscribers.clear()
        self.wants_changed()

    def wanted(self, bench: str, source: str, channels: Sequence[str]) -> set[str]:
        return {
            one
            for one in channels
            if self._subscribers.get(topic_of(bench, "samples", source, one))
        }

    def serve(self, item: Item) -> None:
        if isinstance(item, ChannelSamples):
            self._log_samples(item)
        elif isinstance(item, NewRun):
            self._forget_earlier(item)
        else:
            self._take_document(item)

    def idle(self) -> None:
        while self._asked:
            for document in list(self._kept.get(self._asked.popleft(), {}).values()):
                self._log_document(document)

    def counts(self) -> dict[str, int]:
        return super().counts() | {"topics_left_out": self._beyond}

    # What the server calls, in threads of its own.

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        self._subscribers.setdefault(channel.topic, set()).add(client.id)
        self._asked.append(channel.topic)
        self.wants_changed()

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:
        self._subscribers.get(channel.topic, set()).discard(client.id)
        self.wants_changed()

    def _take_document(self, document: Document) -> None:
        topic = self._topic_of(document)
        if self._channel(topic, document.kind) is None:
            return
        self._kept.setdefault(topic, {})[document.key] = document
        if document.kind == "source":
            for channel in document.members.get("channels", []):
                name = topic_of(document.bench, "samples", document.name[0], channel["name"])
                self._channel(name, "samples")
        self._log_document(document)

    def _forget_earlier(self, begun: NewRun) -> None:
        for kept in self._kept.values():
            for key, one in list(kept.items()):
                if one.bench == begun.bench and one.run not in ("", begun.run):
                    del kept[key]

    def _topic_of(self, document: Document) -> str:
        path = path_of(document)
        # All steps of a channel are one topic, so that they make one plot.
        return topic_of(document.bench, *(path[:3] if document.kind == "point" else path))

    def _channel(self, topic: str, kind: str) -> foxglove.Channel | None:
        channel = self._channels.get(topic)
        if channel is None:
            if len(self._channels) >= MAX_TOPICS:
                self._beyond += 1
                return None
            channel = foxglove.Channel(topic, schema=schema_of(kind), context=self._context)
            self._channels[topic] = channel
        return channel

    def _log_document(self, document: Document) -> None:
        channel = self._channels[self._topic_of(document)]
        if channel.has_sinks():
            text = json.dumps(document.members, ensure_ascii=False, allow_nan=False)
            channel.log(text, log_time=document.time_ns)

    def _log_samples(self, rows: ChannelSamples) -> None:
        channel = self._channel(
            topic_of(rows.bench, "samples", rows.source, rows.channel), "samples"
        )
        if channel is None or not channel.has_sinks():
            return
        for number, time_ns, *values in zip(
            rows.numbers.tolist(),
            rows.times_ns.tolist(),
            rows.values.tolist(),
            rows.minima.tolist(),
            rows.maxima.tolist(),
        ):
            known: list[Any] = [value if math.isfinite(value) else None for value in values]
            members: Members = {"number": number, "step": rows.step}
            members |= dict(zip(("value", "minimum", "maximum"), known))
            channel.log(json.dumps(members, allow_nan=False), log_time=time_ns)
