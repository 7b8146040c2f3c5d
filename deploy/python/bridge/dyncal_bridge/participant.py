"""Joins the laboratory's network as the programs of dyncal do, to read and never to write.

The settings are those of services/bus/cyclonedds/cyclone_dds_config.cpp: packets that Fast DDS
receives (longer ones where it is secured, services/decisions/25-secured-blocks.md), and a lease of
3 s, after which writers do not wait for a bridge that hangs or was killed.
Call `join` before anything else uses dyncal.dds in this process.
"""

from __future__ import annotations

import dataclasses
import os
import socket
from xml.sax.saxutils import quoteattr

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant
from dyncal import dds
from dyncal.dds import security

from dyncal_bridge.document import BridgeError


@dataclasses.dataclass
class NetworkOptions:
    """As those of every program of dyncal."""

    domain: int = 0
    interface: str = ""
    peers: list[str] = dataclasses.field(default_factory=list)
    multicast: bool = True
    security: str = ""


def configuration(options: NetworkOptions) -> str:
    """Settings for Cyclone DDS, then those of CYCLONEDDS_URI, which win one by one."""
    interfaces = ""
    if options.interface:
        kind = "address" if options.interface[0].isdigit() else "name"
        interface = f"<NetworkInterface {kind}={quoteattr(options.interface)}/>"
        interfaces = f"<Interfaces>{interface}</Interfaces>"
    peers = "".join(
        f"<Peer address={quoteattr(address)}/>"
        for address in ["127.0.0.1", *map(address_of, options.peers)]
    )
    packets = (65_000, 64_000) if options.security else (1400, 1300)
    own = (
        '<CycloneDDS><Domain Id="any"><General>'
        f"{interfaces}"
        f"<AllowMulticast>{'spdp' if options.multicast else 'false'}</AllowMulticast>"
        f"<MaxMessageSize>{packets[0]}B</MaxMessageSize>"
        f"<FragmentSize>{packets[1]}B</FragmentSize></General>"
        "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
        "<LeaseDuration>3 s</LeaseDuration><SPDPInterval>1 s</SPDPInterval>"
        f"<Peers>{peers}</Peers></Discovery>"
        "<Internal><GenerateKeyhash>true</GenerateKeyhash>"
        '<HeartbeatInterval min="1 ms" minsched="1 ms" max="1 s">20 ms</HeartbeatInterval>'
        "<NackDelay>10 ms</NackDelay><PreEmptiveAckDelay>10 ms</PreEmptiveAckDelay>"
        "<AckDelay>5 ms</AckDelay>"
        '<SocketReceiveBufferSize min="default" max="4 MiB"/></Internal>'
        "</Domain></CycloneDDS>"
    )
    users_own = os.environ.get("CYCLONEDDS_URI", "")
    return f"{own},{users_own}" if users_own else own


def address_of(peer: str) -> str:
    try:
        return str(socket.getaddrinfo(peer, None, socket.AF_INET)[0][4][0])
    except OSError as problem:
        raise BridgeError(
            f"--peer {peer}: {problem.strerror}; give the address or the name of another host"
        ) from None


def check_security(folder: str) -> None:
    """Whether the files and plug-ins are there, before anything is started."""
    try:
        if folder:
            security.identity(folder)
    except security.SecurityError as problem:
        raise BridgeError(f"--security {folder}: {problem}") from None


def join(options: NetworkOptions) -> DomainParticipant:
    """The participant of dyncal.dds for this domain. Raises BridgeError: why it cannot."""
    check_security(options.security)
    try:
        domain = Domain(options.domain, configuration(options))
        joined = dds.participant(options.domain, options.security)
    except (DDSException, UnicodeEncodeError) as problem:
        secured = f", 'dyncal security check {options.security}'" if options.security else ""
        raise BridgeError(
            f"cannot join DDS domain {options.domain}"
            + (f" at interface {options.interface}" if options.interface else "")
            + f": {problem}; look at --interface, at CYCLONEDDS_URI{secured}"
        ) from None
    _kept.append(domain)
    return joined


_kept: list[Domain] = []  # a domain ends with the last reference to it
