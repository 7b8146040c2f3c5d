"""Python and the public `cyclonedds` package, with types made from dyncal.idl alone.

    cyclone_python.py TYPES read DOMAIN PARTITION BENCH RESULTS FUNCTIONS
    cyclone_python.py TYPES write DOMAIN PARTITION BENCH SECONDS

TYPES: the file that deploy/python/write_contract.py makes. What is printed
and written is in README.md.
"""

import importlib.util
import sys
import time

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter, Publisher
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from cyclonedds.util import duration

spec = importlib.util.spec_from_file_location("contract", sys.argv[1])
wire = importlib.util.module_from_spec(spec)
sys.modules["contract"] = wire
spec.loader.exec_module(wire)

SAMPLES_A_BLOCK = 20
BLOCK_S = 0.02


def qos(history):
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=50)),
        Policy.Durability.TransientLocal,
        history,
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )


def text_of_result(one):
    return [
        "CalibrationResult", one.bench, one.run, one.channel, one.step, one.repetition,
        one.frequency_text_hz, one.magnitude, one.u_magnitude, one.phase_rad, one.u_phase_rad,
        one.unit, len(one.budget), one.software,
    ]  # fmt: skip


def text_of_function(one):
    points = [number for p in one.points for number in (p.magnitude, p.phase_rad, p.u_phase_rad)]
    return [
        "TransferFunction", one.bench, one.run, one.channel, one.unit, one.group_delay_s,
        len(one.points), *points,
    ]  # fmt: skip


def print_row(row):
    print("\t".join(repr(cell) if isinstance(cell, float) else str(cell) for cell in row))
    sys.stdout.flush()


def read(participant, partition, bench, results, functions):
    subscriber = Subscriber(participant, qos=Qos(Policy.Partition([partition])))
    readers = []
    for name, type_, text in (
        ("CalibrationResult", wire.CalibrationResult, text_of_result),
        ("TransferFunction", wire.TransferFunction, text_of_function),
    ):
        topic = Topic(participant, name, type_)
        reader = DataReader(subscriber, topic, qos=qos(Policy.History.KeepLast(1)))
        readers.append((reader, text))
    missing = [int(results), int(functions)]
    while any(left > 0 for left in missing):
        for i, (reader, text) in enumerate(readers):
            for message in reader.take(100):
                if message.sample_info.valid_data and message.bench == bench:
                    print_row(text(message))
                    missing[i] -= 1
        time.sleep(0.02)


def write(participant, partition, bench, seconds):
    publisher = Publisher(participant, qos=Qos(Policy.Partition([partition])))
    describes = DataWriter(
        publisher,
        Topic(participant, "SourceDescription", wire.SourceDescription),
        qos=qos(Policy.History.KeepLast(1)),
    )
    writer = DataWriter(
        publisher,
        Topic(participant, "AcsSamples", wire.SampleBlock),
        qos=qos(Policy.History.KeepLast(250)),
    )
    session = time.time_ns()
    channels = [
        wire.ChannelDescription("reference", "Acceleration", r"\metre\second\tothe{-2}"),
        wire.ChannelDescription("sync", "Voltage", r"\volt"),
    ]
    describes.write(
        wire.SourceDescription(
            bench=bench, source="acs", session=session, kind=wire.SourceKind.SOURCE_ACS,
            device="foreign source", channels=channels, nominal_rate_hz=1000.0,
            contract_version=wire.CONTRACT_VERSION,
        )
    )  # fmt: skip
    blocks = int(float(seconds) / BLOCK_S)
    begin = time.monotonic()
    for number in range(blocks + 1):
        first = number * SAMPLES_A_BLOCK
        count = SAMPLES_A_BLOCK if number < blocks else 0
        samples = range(first, first + count)
        writer.write(
            wire.SampleBlock(
                bench=bench, source="acs", session=session, block=number, first_sample=first,
                sample_count=count, channel_count=2 if count else 0, end_of_stream=count == 0,
                origin_ns=250_000_000_000_000_000, interval_numerator_ns=1_000_000,
                interval_denominator=1, received_utc_ns=time.time_ns(),
                values=[n * 0.25 for n in samples] + [n * -0.5 for n in samples],
            )
        )  # fmt: skip
        time.sleep(max(0.0, begin + number * BLOCK_S - time.monotonic()))
    print_row(["written", blocks * SAMPLES_A_BLOCK])
    time.sleep(3)  # repairs of the last blocks


def main():
    action, domain, partition, bench, *counts = sys.argv[2:]
    participant = DomainParticipant(int(domain))
    {"read": read, "write": write}[action](participant, partition, bench, *counts)


if __name__ == "__main__":
    main()
