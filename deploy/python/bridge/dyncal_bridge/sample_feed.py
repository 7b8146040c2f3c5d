"""Reads the samples that some plug asks for, and only those.

A reader costs the bench one more packet a packet: so it exists as long as somebody looks, and is
best effort with a bounded history, which no writer waits for. One thread, that of the laboratory.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

from cyclonedds.core import (
    InstanceState,
    Policy,
    Qos,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from dyncal import dds

from dyncal_bridge.plug import Plug
from dyncal_bridge.sample_rows import Decimation, samples_of

MAX_BLOCKS = 100  # of a source that wait to be read
BLOCKS_AT_ONCE = 64
TOPICS = {
    dds.types.SourceKind.SOURCE_DAU: "DauSamples",
    dds.types.SourceKind.SOURCE_ACS: "AcsSamples",
    dds.types.SourceKind.SOURCE_CAN: "CanSamples",
}


def sample_qos() -> Qos:
    return Qos(
        Policy.Reliability.BestEffort,
        Policy.Durability.Volatile,
        Policy.History.KeepLast(MAX_BLOCKS),
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )


@dataclasses.dataclass
class Taking:
    """What a plug takes of a source."""

    channels: dict[int, tuple[str, str]]  # {column: (name, unit)}
    decimation: Decimation


class SampleFeed:
    def __init__(
        self, participant: DomainParticipant, waits: WaitSet, plugs: Sequence[Plug]
    ) -> None:
        self._participant, self._waits, self._plugs = participant, waits, plugs
        self._descriptions: dict[tuple[str, str], Any] = {}
        self._takings: dict[tuple[str, str], dict[Plug, Taking]] = {}
        self._readers: dict[tuple[str, str], tuple[DataReader[Any], ReadCondition]] = {}
        self.lost_blocks = 0
        self._next_blocks: dict[tuple[str, str], tuple[int, int]] = {}

    def describe(self, description: Any) -> None:
        """What the columns of a source are."""
        key = description.bench, description.source
        if description.kind in TOPICS and self._descriptions.get(key) != description:
            self._descriptions[key] = description
            self._takings.pop(key, None)  # with decimations of another rate
            self.update()

    def update(self) -> None:
        """After the wants of a plug have changed."""
        needed = set()
        for key, one in self._descriptions.items():
            names = [channel.name for channel in one.channels]
            before, now = self._takings.get(key, {}), {}
            for plug in self._plugs:
                wanted = plug.wanted(one.bench, one.source, names)
                channels = {
                    column: (channel.name, channel.unit)
                    for column, channel in enumerate(one.channels)
                    if channel.name in wanted
                }
                if channels:
                    rate = Decimation(one.nominal_rate_hz, plug.max_rate_hz)
                    kept = before[plug].decimation if plug in before else rate
                    now[plug] = Taking(channels, kept)
                    needed.add((TOPICS[one.kind], one.bench))
            self._takings[key] = now
        for place in set(self._readers) - needed:
            self._waits.detach(self._readers.pop(place)[1])
        for place in needed - set(self._readers):
            self._open(*place)

    def _open(self, topic: str, bench: str) -> None:
        subscriber = Subscriber(self._participant, qos=Qos(Policy.Partition([bench])))
        of_topic = Topic(self._participant, topic, dds.TOPICS[topic][0])
        reader: DataReader[Any] = DataReader(subscriber, of_topic, qos=sample_qos())
        condition = ReadCondition(
            reader, ViewState.Any | InstanceState.Any | SampleState.NotRead
        )
        self._readers[topic, bench] = reader, condition
        self._waits.attach(condition)

    def blocks(self) -> Iterator[Any]:
        for reader, condition in list(self._readers.values()):
            for block in reader.take(BLOCKS_AT_ONCE, condition=condition):
                if block.sample_info.valid_data:
                    yield block

    def hand_on(self) -> None:
        """What has come, to the plugs that take it."""
        for block in self.blocks():
            key = block.bench, block.source
            session, expected = self._next_blocks.get(key, (0, 0))
            if session == block.session and block.block > expected:
                self.lost_blocks += block.block - expected
            self._next_blocks[key] = block.session, block.block + 1
            takings, description = self._takings.get(key), self._descriptions.get(key)
            if not takings or not description or description.session != block.session:
                continue
            is_utc = description.time_base == dds.types.TimeBase.TIME_BASE_UTC
            samples = samples_of(block, is_utc)
            if samples is None or len(samples.values) != len(description.channels):
                continue
            for plug, taking in takings.items():
                for rows in taking.decimation.rows(*key, taking.channels, samples):
                    plug.offer(rows)
