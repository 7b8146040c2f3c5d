#!/usr/bin/env python3
"""Whether `dyncal doctor` names what is wrong in a laboratory, and nothing where nothing is.

    doctor_causes.py PROGRAMS [--vendors cyclonedds,...] [--healthy 20] [--at-once 4] [--seed 1]
        [--alternate] [--only TEXT] [--host-limits]

PROGRAMS is the folder of the built programs. Each misconfiguration is made between two hosts
(network namespaces with names of their own), for each of VENDORS, "SERVICES+DOCTOR" or one for
both; the doctor has to name its cause in a warning or problem. --healthy laboratories are drawn:
benches, hosts, implementations of each program, a second network, multicast or peers, plain or
secured; there the doctor has to find nothing, and every program. Prints a table of what was named.
--host-limits makes the small receive buffer, too, which is one of the whole machine; then nothing
else may run. Exit status 1 if a cause was not named or something healthy was found wrong, 77
(skipped) without root, ip and nft, or libfaketime for what needs it.
"""

import argparse
import concurrent.futures
import dataclasses
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import textwrap
from typing import Callable

from doctor_laboratory import ADDRESS, HERE, THERE, Laboratory  # finds those of faults, too

from host_clocks_campaign import faketime_library  # isort: skip
from hosts import can_be_made, ip  # isort: skip

RECEIVE_BUFFER = pathlib.Path("/proc/sys/net/core/rmem_max")
WHITE_LIST = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <transport_descriptors><transport_descriptor>
    <transport_id>loopback</transport_id><type>UDPv4</type>
    <interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
  </transport_descriptor></transport_descriptors>
  <participant profile_name="own" is_default_profile="true"><rtps>
    <useBuiltinTransports>false</useBuiltinTransports>
    <userTransports><transport_id>loopback</transport_id></userTransports>
  </rtps></participant>
</profiles>
"""


@dataclasses.dataclass
class Fault:
    """`make` before the programs start; `add` after; the cause as the doctor has to name it."""

    what: str
    cause: str
    make: Callable = lambda lab: None
    add: Callable = lambda lab, vendor: None
    arguments: tuple = ()
    environment: dict = dataclasses.field(default_factory=dict)
    clock_s: str = ""  # of the services
    seconds: int = 5
    only: str = ""  # the vendor of the doctor that heeds it


def set_mtu(host):
    return lambda lab: ip("-n", lab.hosts.namespace(host), "link", "set", "lab", "mtu", 1300)


def drop(*rules):
    def make(lab):
        for host, rule in rules:
            lab.nft(host, rule)

    return make


def add_network(lab):
    """A second one of this host."""
    here = lab.hosts.namespace(HERE)
    ip("-n", here, "link", "add", "other", "type", "veth", "peer", "name", "end")
    ip("-n", here, "address", "add", "10.99.0.1/24", "dev", "other")
    for one in ("other", "end"):
        ip("-n", here, "link", "set", one, "up")


def move_to_other_subnet(lab):
    here = lab.hosts.namespace(HERE)
    ip("-n", here, "address", "flush", "dev", "lab")
    ip("-n", here, "address", "add", "10.99.0.1/24", "dev", "lab")


def move_with_gateway(lab):
    move_to_other_subnet(lab)
    ip("-n", lab.hosts.namespace(HERE), "route", "add", "default", "via", "10.99.0.254")


def name_alike(lab):
    lab.names[THERE] = HERE


def add_older(lab, vendor):
    words = [lab.programs / "older_source", vendor, lab.domain, "netns", "old", 60]
    lab.run_on(lab.on(THERE, *words), lab.folder / "older.log")


def add_twin(lab, vendor):
    lab.start(THERE, "dyncal-acs", lab.bench(), "--dds", vendor)


def add_forger(lab, vendor):
    words = [lab.programs / "forging_source", vendor, lab.domain, "netns"]
    lab.run_on(lab.on(THERE, *words), lab.folder / "forger.log")


def write_white_list(lab):
    (lab.folder / "profiles.xml").write_text(WHITE_LIST, encoding="utf-8")


SERVER = {"ROS_DISCOVERY_SERVER": "10.98.0.9:11811"}
PROFILES = {
    "FASTRTPS_DEFAULT_PROFILES_FILE": "profiles.xml",
    "FASTDDS_DEFAULT_PROFILES_FILE": "profiles.xml",
}
LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/>"
    "</Interfaces></General></Domain></CycloneDDS>"
)
PEER = ("--peer", ADDRESS[THERE])
GROUP = "ip daddr 239.255.0.1"
FAULTS_MADE = (
    Fault(
        "another domain",
        r"dyncal-a.*in DDS domain 45, from 10\.98\.0\.2: give --domain 45",
        arguments=("--domain", 46),
    ),
    Fault(
        "all unicast dropped",
        "firewall",
        make=drop((HERE, "ip daddr 10.98.0.1 udp dport 1-65535")),
    ),
    Fault(
        "packets with messages dropped",
        r"must let UDP 18650 to 18723 through",
        make=drop((HERE, "udp dport { 18661, 18663, 18665, 18667, 18669, 18671 }")),
    ),
    Fault("MTU 1300 here", r"lab \(10\.98\.0\.1\) has an MTU of 1300", make=set_mtu(HERE)),
    Fault("MTU 1300 there", "MTU.*(there|at the other host)", make=set_mtu(THERE), seconds=8),
    Fault(
        "a way that drops packets above 1300 bytes",
        "MTU.*on the way|on the way.*MTU",
        make=drop((HERE, "ip length > 1300"), (THERE, "ip length > 1300")),
        seconds=8,
    ),
    Fault(
        "no multicast, with --peer",
        "no multicast comes from dyncal-a",
        make=drop((HERE, GROUP), (THERE, GROUP)),
        arguments=PEER,
    ),
    Fault(
        "10 % of what comes lost",
        r"\d % of \d+ probes brought no echo",
        make=drop((HERE, "meta l4proto udp numgen random mod 100 < 10")),
        seconds=8,
    ),
    Fault(
        "--interface of another network",
        "interface lab, from 10.98.0.2.*--interface lab",
        make=add_network,
        arguments=("--interface", "other"),
    ),
    Fault(
        "--interface of another network, with --peer",
        "interface lab, from 10.98.0.2|reached by 10.98.0.1",
        make=add_network,
        arguments=("--interface", "other", *PEER),
    ),
    Fault("clock 10 s ahead", r"the clock of lab-2 is [+]\d", clock_s="+10"),
    Fault(
        "clock 10 s ahead, hosts named alike",
        "'lab-1' is the name of two computers",
        make=name_alike,
        clock_s="+10",
    ),
    Fault("a program of contract 1", "different versions of the contract", add=add_older),
    Fault("one source twice", "two services publish source netns/acs: .* and ", add=add_twin),
    Fault(
        "another subnet, no route",
        r"no route to 10\.98\.0\.2",
        make=move_to_other_subnet,
        arguments=PEER,
    ),
    Fault(
        "another subnet, a gateway",
        "10.98.0.2 is at this network, but of another subnet",
        make=move_with_gateway,
    ),
    Fault(
        "samples forged in the name of a source",
        r"forger:.*10\.98\.0\.2\) writes samples of bench netns",
        add=add_forger,
    ),
    Fault(
        "ROS_DISCOVERY_SERVER",
        "ROS_DISCOVERY_SERVER is set",
        environment=SERVER,
        only="fastdds",
    ),
    Fault(
        "a profile of Fast DDS for loopback",
        "DEFAULT_PROFILES_FILE is set",
        make=write_white_list,
        environment=PROFILES,
        only="fastdds",
    ),
    Fault(
        "CYCLONEDDS_URI for loopback",
        "CYCLONEDDS_URI",
        environment={"CYCLONEDDS_URI": LOOPBACK},
        only="cyclonedds",
    ),
)


def wrong(report, but=()):
    """Sentences of warnings and problems."""
    grave = ("warning", "problem")
    return [
        f"{one['check']}: {one['sentence']}"
        for one in report["findings"]
        if one["severity"] in grave and one["check"] not in but
    ]


def try_fault(programs, fault, services, doctor):
    """The sentence that names it, or None, and all of them."""
    lab = Laboratory(programs)
    try:
        environment = {}
        if fault.clock_s:
            environment = {
                "LD_PRELOAD": faketime_library(),
                "FAKETIME": fault.clock_s,
                "DONT_FAKE_MONOTONIC": "1",
            }
        fault.make(lab)
        lab.start(THERE, "dyncal-analysis", "--dds", services, environment=environment)
        lab.start(THERE, "dyncal-acs", lab.bench(), "--dds", services, environment=environment)
        fault.add(lab, services)
        sentences = wrong(
            lab.doctor(
                *fault.arguments,
                "--dds",
                doctor,
                seconds=fault.seconds,
                environment=fault.environment,
            )
        )
        return [one for one in sentences if re.search(fault.cause, one)], sentences
    finally:
        lab.close()


def draw_healthy(draws):
    """What a sound laboratory may be."""
    hosts = draws.choice([(HERE, THERE), (HERE, THERE, "lab-3")])
    benches = draws.randint(1, 3)
    return {
        "domain": draws.randint(0, 90),
        "hosts": hosts,
        "places": [draws.choice(hosts) for _ in range(benches + 1)],
        "vendors": [draws.choice(("cyclonedds", "fastdds")) for _ in range(benches + 2)],
        "second network": draws.random() < 0.3,
        "multicast": draws.random() < 0.7,
        "secured": draws.random() < 0.4,
    }


def folder_of(lab, authority, role, *options):
    folder = lab.folder / f"{role}-{len(list(lab.folder.glob(role + '-*')))}"
    words = [lab.programs / "dyncal", "security", "issue", authority, role, "--output", folder]
    subprocess.run([*map(str, words), *options], check=True, capture_output=True)
    return ["--security", folder]


def try_healthy(programs, drawn):
    lab = Laboratory(programs, drawn["hosts"], drawn["domain"])
    try:
        authority = lab.folder / "authority"
        if drawn["secured"]:
            words = [programs / "dyncal", "security", "init", authority]
            subprocess.run(words, check=True, capture_output=True)

        def secured(role, *options):
            return folder_of(lab, authority, role, *options) if drawn["secured"] else []

        network = []
        if not drawn["multicast"]:
            network = ["--no-multicast"]
            network += [word for host in drawn["hosts"] for word in ("--peer", ADDRESS[host])]
        if drawn["second network"]:
            add_network(lab)
            network += ["--interface", "lab"]
        vendors = drawn["vendors"]
        options = [*network, "--dds", vendors[0], *secured("analysis")]
        lab.start(drawn["places"][0], "dyncal-analysis", *options)
        for number, (place, vendor) in enumerate(zip(drawn["places"][1:], vendors[1:])):
            name = f"bench-{number}"
            options = [*network, "--dds", vendor, *secured("source", "--bench", name)]
            lab.start(place, "dyncal-acs", lab.bench(name), *options)
        report = lab.doctor(*network, "--dds", vendors[-1], *secured("watcher"), seconds=6)
        # Of this machine, not of the laboratory that is drawn.
        sentences = wrong(report, but=("buffers", "disk"))
        if len(report.get("programs", [])) != len(drawn["places"]):
            sentences.append(f"{len(report.get('programs', []))} programs answered")
        return sentences
    finally:
        lab.close()


def try_small_buffer(programs):
    before = RECEIVE_BUFFER.read_text("utf-8")
    RECEIVE_BUFFER.write_text("212992", "utf-8")
    try:
        fault = Fault("net.core.rmem_max 212992", "net.core.rmem_max")
        return fault, *try_fault(programs, fault, "cyclonedds", "cyclonedds")
    finally:
        RECEIVE_BUFFER.write_text(before, "utf-8")


def pairs(text):
    return [tuple((one.split("+") * 2)[:2]) for one in text.split(",")]


def cases_of(options):
    """Each fault with services and doctor; every second one with the other where one is asked."""
    for number, fault in enumerate(FAULTS_MADE):
        wanted = [one for one in pairs(options.vendors) if fault.only in ("", one[1])]
        if options.alternate:
            wanted = wanted[number % len(wanted) :][:1]
        for services, doctor in wanted:
            yield fault, services, doctor


def report_faults(results):
    print("| misconfiguration | services, doctor | named | as |\n|---|---|---|---|")
    failed = 0
    for fault, services, doctor, found, sentences in results:
        as_what = found[0] if found else "; ".join(sentences) or "nothing is wrong"
        failed += not found
        short = textwrap.shorten(as_what, 160)
        print(f"| {fault.what} | {services}, {doctor} | {'yes' if found else 'NO'} | {short} |")
    print(f"{len(results) - failed} of {len(results)} were named by cause")
    return failed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument(
        "--vendors", default="cyclonedds,fastdds,cyclonedds+fastdds,fastdds+cyclonedds"
    )
    parser.add_argument("--alternate", action="store_true", help="each fault with one of them")
    parser.add_argument("--only", default="", help="misconfigurations whose name has this")
    parser.add_argument("--healthy", type=int, default=20)
    parser.add_argument("--at-once", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--host-limits", action="store_true")
    options = parser.parse_args()
    tools = ("ip", "nft", "unshare")
    if os.geteuid() != 0 or not all(map(shutil.which, tools)) or not can_be_made():
        print("SKIPPED: dyncal doctor's causes are not tested: needs root, ip, nft, namespaces")
        return 77
    draws = random.Random(options.seed)
    healthy = [draw_healthy(draws) for _ in range(options.healthy)]
    cases = [
        one
        for one in cases_of(options)
        if options.only in one[0].what and (faketime_library() or not one[0].clock_s)
    ]
    with concurrent.futures.ThreadPoolExecutor(options.at_once) as pool:
        tried = list(pool.map(lambda one: (*one, *try_fault(options.programs, *one)), cases))
        found_wrong = list(pool.map(lambda one: try_healthy(options.programs, one), healthy))
    if options.host_limits:
        fault, found, sentences = try_small_buffer(options.programs)
        tried.append((fault, "cyclonedds", "cyclonedds", found, sentences))
    failed = report_faults(tried)
    for drawn, sentences in zip(healthy, found_wrong):
        if sentences:
            failed += 1
            print(f"healthy, but found wrong: {drawn}\n  " + "\n  ".join(sentences))
    print(f"{len(healthy)} healthy laboratories, {sum(map(bool, found_wrong))} with findings")
    return 1 if failed or not tried else 0


if __name__ == "__main__":
    sys.exit(main())
