"""Python and the `dust_dds` package, whose types are dataclasses: a list of anything but bytes is
not implemented in it, and each topic of the contract has one.

    dust_python.py read|write DOMAIN PARTITION BENCH COUNT...
"""

import dataclasses
import sys

import dust_dds


@dataclasses.dataclass
class ChannelDescription:
    name: str
    quantity: str
    unit: str
    minimum: dust_dds.TypeKind.float64
    maximum: dust_dds.TypeKind.float64
    resolution: dust_dds.TypeKind.float64


@dataclasses.dataclass
class Described:
    bench: str
    channels: list[ChannelDescription]


def main():
    factory = dust_dds.DomainParticipantFactory.get_instance()
    participant = factory.create_participant(domain_id=int(sys.argv[2]))
    topic = participant.create_topic(topic_name="SourceDescription", type_=Described)
    participant.create_publisher().create_datawriter(topic)
    sys.exit("lists can be written now: make the whole contract of it")


if __name__ == "__main__":
    main()
