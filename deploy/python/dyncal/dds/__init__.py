"""The messages of dyncal on the public `cyclonedds` package: readers and writers by topic.

    from dyncal import dds
    for result in dds.Reader("CalibrationResult", bench="acc-1").messages(timeout_s=60):
        print(result.channel, result.frequency_text_hz, result.magnitude)

`dyncal.dds.types` has the messages as dataclasses; idl/README.md explains every member with its
unit and time base. Here are topics, their types and QoS profiles as that page states them. One
participant a domain serves the whole process. A domain is that of the laboratory: DYNCAL_DOMAIN
where it is set, else 0. DYNCAL_SECURITY names a folder where it is secured (`dyncal.dds.security`).
Needs the package, version 0.10 or 11: pip install dyncal[dds].
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from typing import Any

from cyclonedds.core import (
    InstanceState,
    Listener,
    Policy,
    Qos,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter, Publisher
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from . import types
from .security import identity

# Topic, its type and its QoS profile, as in idl/README.md.
TOPICS: dict[str, tuple[type[Any], str]] = {
    "SourceDescription": (types.SourceDescription, "state"),
    "SourceStatus": (types.SourceStatus, "state"),
    "DauSamples": (types.SampleBlock, "samples"),
    "AcsSamples": (types.SampleBlock, "samples"),
    "CanSamples": (types.SampleBlock, "samples"),
    "DsoRecord": (types.TriggeredRecord, "records"),
    "TssRecord": (types.TriggeredRecord, "records"),
    "Measurement": (types.Measurement, "state"),
    "Excitation": (types.Excitation, "state"),
    "CalibrationResult": (types.CalibrationResult, "results"),
    "TransferFunction": (types.TransferFunction, "results"),
    "SampleClockReport": (types.SampleClockReport, "results"),
    "ServiceStatus": (types.ServiceStatus, "state"),
    "RecorderStatus": (types.ServiceStatus, "state"),
    "Command": (types.Command, "command"),
}
UNLIMITED = -1
MESSAGES_AT_ONCE = 256
# Reader's history, writer's history, the reader's limit of samples an instance.
HISTORIES = {
    "samples": (Policy.History.KeepAll, Policy.History.KeepLast(250), 1500),
    "records": (Policy.History.KeepAll, Policy.History.KeepLast(32), 1500),
    "results": (Policy.History.KeepLast(1), Policy.History.KeepLast(1), 1),
    "state": (Policy.History.KeepLast(1), Policy.History.KeepLast(1), 1),
    "command": (Policy.History.KeepAll, Policy.History.KeepAll, 1000),
}

_participants: dict[int, DomainParticipant] = {}


def laboratory_domain() -> int:
    """DYNCAL_DOMAIN where it is set, else 0."""
    return int(os.environ.get("DYNCAL_DOMAIN", "0"))


def participant(domain: int | None = None, folder: str | None = None) -> DomainParticipant:
    """That of this process, made once for each domain.

    folder: that of a secured laboratory; None: DYNCAL_SECURITY, "": not secured. Raises
    dyncal.dds.security.SecurityError, or what the package raises where it cannot join.
    """
    number = laboratory_domain() if domain is None else domain
    if number not in _participants:
        secured = os.environ.get("DYNCAL_SECURITY", "") if folder is None else folder
        who = identity(secured) if secured else None
        _participants[number] = DomainParticipant(number, who)
    return _participants[number]


def qos(topic: str, writes: bool = False, late: bool = True) -> Qos:
    """The QoS of a topic's reader or writer. late: what was published before is asked for."""
    profile = TOPICS[topic][1]
    for_reader, for_writer, per_instance = HISTORIES[profile]
    keeps = profile != "command" and late
    policies = [
        Policy.Reliability.Reliable(duration(milliseconds=50)),
        Policy.Durability.TransientLocal if keeps else Policy.Durability.Volatile,
        for_writer if writes else for_reader,
        Policy.DataRepresentation(use_cdrv0_representation=True),
    ]
    if writes:
        policies.append(Policy.WriterDataLifecycle(autodispose=False))
    else:
        policies.append(Policy.ResourceLimits(UNLIMITED, UNLIMITED, per_instance))
    return Qos(*policies)


class _Matched(Listener):
    """How many of the other side there are; the one way that 0.10 and 11 have both."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]
        self.count = 0

    def on_publication_matched(self, writer: Any, status: Any) -> None:
        """Of a writer: its readers."""
        self.count = status.current_count

    def on_subscription_matched(self, reader: Any, status: Any) -> None:
        """Of a reader: its writers."""
        self.count = status.current_count


class Reader:
    """Reads a topic of one bench, or of all ("*").

    late: False gets only what is published from now on, which is what a reader of samples wants.
    The topic's type is `TOPICS[topic][0]`; `entity` is the reader of the cyclonedds package.
    """

    def __init__(
        self, topic: str, bench: str = "*", domain: int | None = None, late: bool = True
    ) -> None:
        if topic not in TOPICS:
            raise ValueError(f"there is no topic '{topic}'; there are {', '.join(TOPICS)}")
        own = self._participant = participant(domain)
        partition = Qos(Policy.Partition([bench]))
        self._matched = _Matched()
        self.entity: DataReader[Any] = DataReader(
            Subscriber(own, qos=partition),
            Topic(own, topic, TOPICS[topic][0]),
            qos=qos(topic, late=late),
            listener=self._matched,
        )

    def wait_for_writers(self, count: int = 1, timeout_s: float = 10.0) -> bool:
        """Whether as many writers have matched in that time."""
        return _wait_for(lambda: self._matched.count >= count, timeout_s)

    def messages(self, timeout_s: float | None = None) -> Iterator[Any]:
        """Every message as it comes; ends when none has come for timeout_s (None: never).

        What a writer that has left published before is among them, other than in `take_iter` of
        the package.
        """
        everything = ReadCondition(
            self.entity, ViewState.Any | InstanceState.Any | SampleState.NotRead
        )
        arrival = WaitSet(self._participant)
        arrival.attach(everything)
        patience = duration(weeks=99999) if timeout_s is None else duration(seconds=timeout_s)
        while arrival.wait(patience):
            for message in self.entity.take(MESSAGES_AT_ONCE, condition=everything):
                if message.sample_info.valid_data:
                    yield message


class Writer:
    """Writes a topic in the name of a bench, whose name every message has, too."""

    def __init__(self, topic: str, bench: str, domain: int | None = None) -> None:
        if topic not in TOPICS:
            raise ValueError(f"there is no topic '{topic}'; there are {', '.join(TOPICS)}")
        own = participant(domain)
        partition = Qos(Policy.Partition([bench]))
        self._matched = _Matched()
        self.entity: DataWriter[Any] = DataWriter(
            Publisher(own, qos=partition),
            Topic(own, topic, TOPICS[topic][0]),
            qos=qos(topic, writes=True),
            listener=self._matched,
        )

    def write(self, message: Any) -> None:
        """A message of the topic's type; waits for readers that are behind, as its QoS says."""
        self.entity.write(message)

    def wait_for_readers(self, count: int = 1, timeout_s: float = 10.0) -> bool:
        """Whether as many readers have matched in that time."""
        return _wait_for(lambda: self._matched.count >= count, timeout_s)


def _wait_for(is_true: Callable[[], bool], timeout_s: float) -> bool:
    deadline = time.monotonic() + timeout_s
    while not is_true():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)  # the package has no wait in Python that ends with a deadline
    return True
