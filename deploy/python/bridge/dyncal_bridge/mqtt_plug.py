"""MQTT 3.1.1: results and states, retained; samples where they are asked for: package paho-mqtt.

Topics below PREFIX ("dyncal"), JSON, QoS 1, retained:

    PREFIX/bridge                                             {"state": "online"}, or "offline"
    PREFIX/benches/BENCH/state
    PREFIX/benches/BENCH/sources/SOURCE
    PREFIX/benches/BENCH/points/SOURCE/CHANNEL/STEP/REPETITION
    PREFIX/benches/BENCH/transfer_functions/SOURCE/CHANNEL

and QoS 0, not retained: PREFIX/benches/BENCH/samples/SOURCE/CHANNEL. In names, % / + # $ and
control characters are written as %25, %2F and so on. When a run begins, what is retained of earlier
runs of its bench is removed from the broker, also what an earlier bridge has left there.

At most 200 messages are on their way to the broker; the rest waits in the queue of the plug. After
each connection everything is sent again: the broker may have forgotten it.
"""

from __future__ import annotations

import collections
import json
import logging
import math
import re
import time
from collections.abc import Sequence
from typing import Any
from urllib.parse import unquote

import paho.mqtt.client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

from dyncal_bridge.document import ChannelSamples, Document, Item, NewRun
from dyncal_bridge.plug import Plug, path_of
from dyncal_bridge.settings import MqttSettings

MAX_ON_THE_WAY = 200
MAX_FOUND = 50_000  # retained topics of an earlier bridge
KEEP_ALIVE_S = 20
SEARCH_S = 5.0  # for what is retained, after a connection
FAREWELL_S = 0.5
TO_ESCAPE = re.compile(r"[%/+#$\x00-\x1f]")
OF_A_RUN = ("points", "transfer_functions")


def level(name: str) -> str:
    """A name as one level of a topic."""
    return TO_ESCAPE.sub(lambda found: f"%{ord(found[0]):02X}", name)


def text_of(members: dict[str, Any]) -> str:
    return json.dumps(members, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def known(values: Sequence[float]) -> list[float | None]:
    return [value if math.isfinite(value) else None for value in values]


class MqttPlug(Plug):
    def __init__(self, settings: MqttSettings) -> None:
        super().__init__("mqtt", settings.max_rate_hz)
        self._settings = settings
        self._client: mqtt.Client | None = None
        self._is_connected = False
        self._connected_s = 0.0
        self._is_searching = False
        self._on_the_way: collections.deque[mqtt.MQTTMessageInfo] = collections.deque()
        self._again: collections.deque[str] = collections.deque()
        self._current: dict[str, str] = {}
        self._run_of: dict[str, tuple[str, str]] = {}  # retained topic: (bench, run)
        self._found: collections.deque[tuple[str, str, str]] = collections.deque(maxlen=MAX_FOUND)

    def wanted(self, bench: str, source: str, channels: Sequence[str]) -> set[str]:
        asked = set()
        for one in self._settings.samples:
            of_bench, of_source, of_channel = one.split("/", 2)
            if of_bench in ("*", bench) and of_source in ("*", source):
                asked |= {name for name in channels if of_channel in ("*", name)}
        return asked

    def open(self) -> None:
        one = self._settings
        client = mqtt.Client(CallbackAPIVersion.VERSION2, reconnect_on_failure=True)
        client.enable_logger(logging.getLogger("dyncal-bridge.mqtt.library"))
        client.will_set(self._topic("bridge"), text_of({"state": "offline"}), qos=1, retain=True)
        if one.user:
            password = one.password_file.read_text().strip() if one.password_file else None
            client.username_pw_set(one.user, password)
        if one.tls_ca:
            client.tls_set(
                str(one.tls_ca),
                str(one.tls_certificate) if one.tls_certificate else None,
                str(one.tls_key) if one.tls_key else None,
            )
        client.max_inflight_messages_set(MAX_ON_THE_WAY)
        client.reconnect_delay_set(1, 30)
        client.on_connect = self._on_connect
        client.on_connect_fail = self._on_connect_fail
        client.on_disconnect = self._on_disconnect
        client.on_message = self._on_message
        client.connect_async(one.broker.host, one.broker.port, KEEP_ALIVE_S)
        self._client = client
        client.loop_start()

    def close(self) -> None:
        client, self._client = self._client, None
        if client is None:
            return
        if self._is_connected:
            self._is_connected = False
            farewell = client.publish(
                self._topic("bridge"), text_of({"state": "offline"}), qos=1, retain=True
            )
            deadline_s = time.monotonic() + FAREWELL_S
            while not farewell.is_published() and time.monotonic() < deadline_s:
                farewell.wait_for_publish(0.05)
        client.disconnect()
        client.loop_stop()
        self._on_the_way.clear()

    def is_ready(self) -> bool:
        while self._on_the_way and self._on_the_way[0].is_published():
            self._on_the_way.popleft()
        return self._is_connected and len(self._on_the_way) < MAX_ON_THE_WAY

    def serve(self, item: Item) -> None:
        if isinstance(item, ChannelSamples):
            self._publish_samples(item)
        elif isinstance(item, NewRun):
            self._remove_earlier(item)
        else:
            topic = self._topic_of(item)
            self._current[topic] = text_of(item.members)
            if item.run and item.kind != "state":
                self._run_of[topic] = item.bench, item.run
            self._publish(topic, self._current[topic])

    def idle(self) -> None:
        while self._again and self.is_ready():
            topic = self._again.popleft()
            self._publish(topic, self._current.get(topic, ""))
        while self._found and self.is_ready():
            topic, bench, run = self._found.popleft()
            self._run_of.setdefault(topic, (bench, run))
            newest = self.runs.get(bench, run)
            if self._run_of[topic][1] != newest:
                self._remove(topic)
        if self._is_searching and time.monotonic() - self._connected_s > SEARCH_S:
            self._is_searching = False
            if self._client:
                self._client.unsubscribe(self._trees())

    def _topic(self, *levels: str) -> str:
        return "/".join((self._settings.topic, *levels))

    def _trees(self) -> list[str]:
        return [self._topic("benches", "+", one, "#") for one in OF_A_RUN]

    def _topic_of(self, document: Document) -> str:
        return self._topic("benches", level(document.bench), *map(level, path_of(document)))

    def _publish(self, topic: str, text: str, retain: bool = True) -> None:
        if self._client:
            sent = self._client.publish(topic, text, qos=1 if retain else 0, retain=retain)
            if sent.rc == mqtt.MQTT_ERR_SUCCESS:  # else the connection is lost: all comes again
                self._on_the_way.append(sent)

    def _publish_samples(self, rows: ChannelSamples) -> None:
        topic = self._topic(
            *("benches", level(rows.bench), "samples", level(rows.source), level(rows.channel))
        )
        members = {
            "bench": rows.bench,
            "source": rows.source,
            "channel": rows.channel,
            "unit": rows.unit,
            "session": rows.session,
            "step": rows.step,
            "numbers": rows.numbers.tolist(),
            "stamps_ns": rows.stamps_ns.tolist(),
            "values": known(rows.values.tolist()),
            "minima": known(rows.minima.tolist()),
            "maxima": known(rows.maxima.tolist()),
        }
        self._publish(topic, text_of(members), retain=False)

    def _remove_earlier(self, begun: NewRun) -> None:
        for topic, (bench, run) in list(self._run_of.items()):
            if bench == begun.bench and run != begun.run:
                self._remove(topic)

    def _remove(self, topic: str) -> None:
        self._run_of.pop(topic, None)
        self._current.pop(topic, None)
        self._publish(topic, "")

    # What the client calls, in a thread of its own.

    def _on_connect(
        self, client: mqtt.Client, _data: Any, _flags: Any, reason: Any, _properties: Any
    ) -> None:
        if reason.is_failure:
            self.log.error(
                "the broker %s:%d refuses the bridge: %s; look at user and password_file",
                *(self._settings.broker.host, self._settings.broker.port, reason),
            )
            return
        self.log.info("connected to %s:%d", self._settings.broker.host, self._settings.broker.port)
        client.publish(self._topic("bridge"), text_of({"state": "online"}), qos=1, retain=True)
        client.subscribe([(tree, 0) for tree in self._trees()])
        self._again = collections.deque(list(self._current))
        self._is_connected = self._is_searching = True
        self._connected_s = time.monotonic()

    def _on_connect_fail(self, _client: mqtt.Client, _data: Any) -> None:
        one = self._settings.broker
        self.log.warning("the broker %s:%d cannot be reached; is it running?", one.host, one.port)

    def _on_disconnect(
        self, _client: mqtt.Client, _data: Any, _flags: Any, reason: Any, _properties: Any
    ) -> None:
        if self._is_connected:
            self.log.warning("the connection to the broker is lost: %s", reason)
        self._is_connected = False

    def _on_message(self, _client: mqtt.Client, _data: Any, message: mqtt.MQTTMessage) -> None:
        if not message.retain or not message.payload:
            return
        try:
            run = str(json.loads(message.payload)["run"])
        except (ValueError, KeyError, TypeError):
            return  # not of a bridge
        bench = unquote(message.topic.removeprefix(self._topic("benches") + "/").partition("/")[0])
        self._found.append((message.topic, bench, run))
