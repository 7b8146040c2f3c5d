"""What is known of the benches by their messages, as documents for the plugs.

Of each bench the newest run counts: that which was planned last, or whose first result is newest
where its plan is not known. Another run begins with NewRun, and what comes of earlier ones is left
out and counted. A source of which no status came for 3 s is "gone" (they come every 500 ms); a run
of which nothing came for 10 s is "silent": its messages would say "running" for ever.

Bounded: 64 benches, 32 sources and 64 channels of each, 16 384 points together; what is beyond is
left out and counted. One thread.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

from dyncal_bridge import result_members
from dyncal_bridge.document import Document, Item, Members, NewRun
from dyncal_bridge.result_members import number, word

MAX_BENCHES, MAX_SOURCES, MAX_CHANNELS, MAX_POINTS = 64, 32, 64, 16_384
MAX_RUNS = 16  # whose plan of a bench is remembered
STATUS_PATIENCE_S, RUN_PATIENCE_S = 3.0, 10.0
SOURCE_COUNTS = (
    *("received", "lost_in_device", "lost_in_transit", "duplicates", "rejected"),
    *("stamps_not_trusted", "dropped_in_service"),
)


@dataclasses.dataclass
class Source:
    description: Any = None
    status: Any = None
    heard_s: float = 0.0
    is_gone: bool = False


@dataclasses.dataclass
class Bench:
    name: str
    run: str = ""
    begin_ns: int = 0
    heard_s: float = 0.0
    is_silent: bool = False
    measurement: Any = None
    excitation: Any = None
    analysis: Any = None
    planned: dict[str, int] = dataclasses.field(default_factory=dict)
    sources: dict[str, Source] = dataclasses.field(default_factory=dict)
    points: dict[tuple[str, int, int], Any] = dataclasses.field(default_factory=dict)
    functions: dict[str, tuple[Any, int]] = dataclasses.field(default_factory=dict)


@dataclasses.dataclass
class LeftOut:
    """Messages since the start."""

    of_earlier_runs: int = 0
    beyond_limits: int = 0


class BenchView:
    def __init__(self) -> None:
        self.benches: dict[str, Bench] = {}
        self.left_out = LeftOut()
        self._point_count = 0

    def take(self, topic: str, message: Any, time_ns: int, now_s: float) -> Iterator[Item]:
        """What a message says that is new. time_ns: when it was written; now_s: monotonic."""
        bench = self.benches.get(message.bench)
        if bench is None:
            if len(self.benches) >= MAX_BENCHES:
                self.left_out.beyond_limits += 1
                return
            bench = self.benches[message.bench] = Bench(message.bench)
        if topic in ("SourceDescription", "SourceStatus"):
            yield from self._take_source(bench, topic, message, time_ns, now_s)
        elif topic in ("Measurement", "CalibrationResult", "TransferFunction"):
            yield from self._begin_run(bench, topic, message, time_ns)
            if message.run != bench.run:
                self.left_out.of_earlier_runs += 1
                return
            yield from self._hear(bench, now_s, time_ns)
            yield from self._take_of_run(bench, topic, message, time_ns)
        elif bench.run and message.run == bench.run:
            yield from self._hear(bench, now_s, time_ns)
            yield from self._take_progress(bench, topic, message, time_ns)

    def tick(self, now_s: float, time_ns: int) -> Iterator[Item]:
        """Once a second: what has fallen silent."""
        for bench in self.benches.values():
            for name, source in bench.sources.items():
                if source.status and not source.is_gone:
                    if now_s - source.heard_s > STATUS_PATIENCE_S:
                        source.is_gone = True
                        yield self._source_document(bench, name, source, time_ns)
            is_on = word(getattr(bench.measurement, "state", ""), "MEASUREMENT_") in (
                *("planned", "running"),
            )
            if is_on and not bench.is_silent and now_s - bench.heard_s > RUN_PATIENCE_S:
                bench.is_silent = True
                yield self._state_document(bench, time_ns)

    def _hear(self, bench: Bench, now_s: float, time_ns: int) -> Iterator[Item]:
        bench.heard_s = now_s
        if bench.is_silent:
            bench.is_silent = False
            yield self._state_document(bench, time_ns)

    def _begin_run(self, bench: Bench, topic: str, message: Any, time_ns: int) -> Iterator[Item]:
        if topic == "Measurement":
            bench.planned[message.run] = message.planned_utc_ns or time_ns
            while len(bench.planned) > MAX_RUNS:
                del bench.planned[min(bench.planned, key=bench.planned.__getitem__)]
        begin_ns = bench.planned.get(message.run, time_ns)
        if message.run == bench.run:
            bench.begin_ns = min(bench.begin_ns, begin_ns)
        elif not bench.run or begin_ns > bench.begin_ns:
            self._point_count -= len(bench.points)
            bench.run, bench.begin_ns, bench.is_silent = message.run, begin_ns, False
            bench.measurement = bench.excitation = bench.analysis = None
            bench.points, bench.functions = {}, {}
            yield NewRun(bench.name, bench.run)

    def _take_of_run(self, bench: Bench, topic: str, message: Any, time_ns: int) -> Iterator[Item]:
        if topic == "Measurement":
            bench.measurement = message
            yield self._state_document(bench, time_ns)
        elif topic == "CalibrationResult":
            yield from self._take_point(bench, message, time_ns)
        elif message.channel in bench.functions or len(bench.functions) < MAX_CHANNELS:
            bench.functions[message.channel] = message, time_ns
            yield self._function_document(bench, message.channel)
        else:
            self.left_out.beyond_limits += 1

    def _take_point(self, bench: Bench, message: Any, time_ns: int) -> Iterator[Item]:
        key = message.channel, message.step, message.repetition
        before = bench.points.get(key)
        if before is None:
            if self._point_count >= MAX_POINTS:
                self.left_out.beyond_limits += 1
                return
            self._point_count += 1
        elif before["attempt"] > max(message.attempt, 1):
            return  # a later excitation of the step counts
        bench.points[key] = {
            **{name: getattr(message, name) for name in ("frequency_hz", "level_m_s2", "valid")},
            **result_members.flags(message),
            "attempt": max(message.attempt, 1),
        }
        name = message.channel, str(message.step), str(message.repetition)
        members = result_members.point(message)
        yield Document("point", bench.name, name, bench.run, members, time_ns)
        if before is None:
            yield self._state_document(bench, time_ns)
        if message.channel in bench.functions:
            yield self._function_document(bench, message.channel)

    def _take_progress(
        self, bench: Bench, topic: str, message: Any, time_ns: int
    ) -> Iterator[Item]:
        if topic == "Excitation":
            bench.excitation = message
        elif topic == "ServiceStatus" and not (message.recording or message.guarded_generator):
            bench.analysis = message
        yield self._state_document(bench, time_ns)

    def _take_source(
        self, bench: Bench, topic: str, message: Any, time_ns: int, now_s: float
    ) -> Iterator[Item]:
        source = bench.sources.get(message.source)
        if source is None:
            if len(bench.sources) >= MAX_SOURCES:
                self.left_out.beyond_limits += 1
                return
            source = bench.sources[message.source] = Source()
        if topic == "SourceDescription":
            source.description = message
        else:
            source.status, source.heard_s, source.is_gone = message, now_s, False
        yield self._source_document(bench, message.source, source, time_ns)

    def _source_document(
        self, bench: Bench, name: str, source: Source, time_ns: int
    ) -> Document:
        members: Members = {"bench": bench.name, "source": name, "state": "unknown", "message": ""}
        if source.description:
            one = source.description
            members |= {
                "kind": word(one.kind, "SOURCE_"),
                "device": one.device,
                "serial": one.serial,
                "nominal_rate_hz": number(one.nominal_rate_hz),
                "channels": [
                    {"name": each.name, "quantity": each.quantity, "unit": each.unit}
                    for each in one.channels
                ],
            }
        if source.status:
            members |= {
                "state": word(source.status.state, "SOURCE_"),
                "message": source.status.message,
                "rate_hz": number(source.status.rate_hz),
                **{count: getattr(source.status, count) for count in SOURCE_COUNTS},
                "buffer_fill": number(source.status.buffer_fill),
                "clock_uncertainty_s": number(source.status.clock_uncertainty_s),
                "published_utc_ns": source.status.published_utc_ns,
            }
        if source.is_gone:
            why = f"no status of it for {STATUS_PATIENCE_S:.0f} s: it has ended, or the network is"
            members |= {"state": "gone", "message": why + " interrupted"}
        return Document("source", bench.name, (name,), "", members, time_ns)

    def _state_document(self, bench: Bench, time_ns: int) -> Document:
        members: Members = {
            "bench": bench.name,
            "run": bench.run,
            "state": "unknown",
            "message": "",
            "points": len(bench.points),
        }
        if bench.measurement:
            one = bench.measurement
            members |= {
                "state": word(one.state, "MEASUREMENT_"),
                "message": one.message,
                "method": word(one.method, "METHOD_").replace("_", "-"),
                "planned_utc_ns": one.planned_utc_ns,
                "planned_steps": len(one.steps),
            }
        if bench.excitation:
            one = bench.excitation
            members |= {
                "excitation": word(one.state, "EXCITATION_"),
                "step": one.step,
                "repetition": one.repetition,
                "frequency_text_hz": one.frequency_text_hz,
                "level_m_s2": number(one.level_m_s2),
            }
        if bench.analysis:
            members |= {
                "analysis_arm": word(bench.analysis.arm, "ARM_"),
                "analysis_health": word(bench.analysis.health, "HEALTH_"),
                "analysis_message": bench.analysis.message,
            }
        if bench.is_silent:
            why = f"no message of the run for {RUN_PATIENCE_S:.0f} s; it was {members['state']}"
            members |= {"state": "silent", "message": why}
        return Document("state", bench.name, (), bench.run, members, time_ns)

    def _function_document(self, bench: Bench, channel: str) -> Document:
        """With the flags of each mean: those of its points, then those of the channel."""
        function, time_ns = bench.functions[channel]
        members = result_members.transfer_function(function)
        points = [bench.points[key] for key in sorted(bench.points, key=lambda key: key[1:])
                  if key[0] == channel]
        whole = list(zip(function.flag_names, function.flags))
        for row in members["transfer_function"]:
            flags = [
                flag
                for one in points
                if one["valid"]
                and one["frequency_hz"] == row["frequency_hz"]
                and one["level_m_s2"] == row["level_m_s2"]
                for flag in zip(one["flag_names"], one["flags"])
            ]
            once = list(dict.fromkeys(flags + whole))
            row["flags"] = [sentence for _, sentence in once]
            row["flag_names"] = [name for name, _ in once]
        return Document("transfer_function", bench.name, (channel,), bench.run, members, time_ns)
