"""Reads the bus: every state and result of the benches, and the samples that a plug asks for.

One thread waits for messages, makes documents of them (`bench_view`) and offers them to the plugs,
none of which can make it wait. Readers of states and results are reliable with a history of one a
key, as the contract has it; samples are best effort. Nothing is ever written on the bus.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Sequence

from cyclonedds.core import (
    GuardCondition,
    InstanceState,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.domain import DomainParticipant
from cyclonedds.util import duration
from dyncal import dds

from dyncal_bridge.bench_view import BenchView
from dyncal_bridge.document import Item
from dyncal_bridge.plug import Plug
from dyncal_bridge.sample_feed import SampleFeed

TOPICS = (
    *("SourceDescription", "SourceStatus", "Measurement", "Excitation"),
    *("ServiceStatus", "CalibrationResult", "TransferFunction"),
)
MESSAGES_AT_ONCE = 256
TICK_S = 1.0
log = logging.getLogger("dyncal-bridge")


class Laboratory:
    """benches: names, or "*" for all."""

    def __init__(
        self,
        participant: DomainParticipant,
        domain: int,
        benches: Sequence[str],
        plugs: Sequence[Plug],
    ) -> None:
        self.view = BenchView()
        self.refused_messages = 0
        self._plugs = plugs
        self._stopping = threading.Event()
        self._wants_changed = threading.Event()
        self._waits = WaitSet(participant)
        self._wake = GuardCondition(participant)
        self._waits.attach(self._wake)
        self.feed = SampleFeed(participant, self._waits, plugs)
        self._readers = []
        for topic in TOPICS:
            for bench in benches:
                reader = dds.Reader(topic, bench, domain)
                condition = ReadCondition(
                    reader.entity, ViewState.Any | InstanceState.Any | SampleState.NotRead
                )
                self._waits.attach(condition)
                self._readers.append((topic, reader, condition))
        for plug in plugs:
            plug.wants_changed = self.wants_changed
        self._thread = threading.Thread(target=self._run, name="laboratory", daemon=True)
        self.turned_s = time.monotonic()

    def start(self) -> None:
        self._thread.start()

    def stop(self, timeout_s: float) -> bool:
        """Whether it has ended in that time."""
        self._stopping.set()
        self._wake.set(True)
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def wants_changed(self) -> None:
        """A plug asks for other samples than before. Any thread."""
        self._wants_changed.set()
        self._wake.set(True)

    def _run(self) -> None:
        next_tick_s = time.monotonic() + TICK_S
        while not self._stopping.is_set():
            wait_s = max(0.0, next_tick_s - time.monotonic())
            self._waits.wait(duration(milliseconds=1 + int(1000 * wait_s)))
            self._wake.set(False)
            self.turned_s = now_s = time.monotonic()
            if self._wants_changed.is_set():
                self._wants_changed.clear()
                self.feed.update()
            for topic, reader, condition in self._readers:
                self._take(topic, reader, condition, now_s)
            try:
                self.feed.hand_on()
            except Exception as problem:
                self._refuse("samples", problem)
            if now_s >= next_tick_s:
                next_tick_s = now_s + TICK_S
                for item in self.view.tick(now_s, time.time_ns()):
                    self._offer(item)

    def _take(
        self, topic: str, reader: dds.Reader, condition: ReadCondition, now_s: float
    ) -> None:
        try:
            messages = reader.entity.take(MESSAGES_AT_ONCE, condition=condition)
        except Exception as problem:  # of a foreign writer: the package cannot decode it
            self._refuse(topic, problem)
            return
        for message in messages:
            if not message.sample_info.valid_data:
                continue
            time_ns = message.sample_info.source_timestamp
            try:
                if topic == "SourceDescription":
                    self.feed.describe(message)
                for item in self.view.take(topic, message, time_ns, now_s):
                    self._offer(item)
            except Exception as problem:  # whatever it is, the other benches go on
                self._refuse(topic, problem)

    def _offer(self, item: Item) -> None:
        for plug in self._plugs:
            plug.offer(item)

    def _refuse(self, topic: str, problem: Exception) -> None:
        self.refused_messages += 1
        if self.refused_messages in (1, 10, 100, 1000) or self.refused_messages % 10_000 == 0:
            log.warning(
                "%s: a message cannot be used (%d so far): %r",
                *(topic, self.refused_messages, problem),
            )
