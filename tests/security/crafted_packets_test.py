#!/usr/bin/env python3
"""Sends crafted packets (crafted_packets.py) at a laboratory whose benches run.

    crafted_packets_test.py PROGRAMS [--vendors cyclonedds,fastdds,mixed] [--secured] [--seeds 1]
      [--copied]

PROGRAMS is the folder of the built programs. Two benches of one analysis; with --copied, packets
with the GUID of the source of one of them are sent, too, as only security can keep off. Held: no
program ends, none grows by more than 10 MB beyond what two undisturbed runs cost or takes more than
20 s of processor time, the run of the other bench has the bits of `dyncal analyse`, and a run after
that as well. Exit status 1 if that did not hold, 77 where packets cannot be looked at.
"""

import argparse
import pathlib
import shutil
import socket
import struct
import sys
import tempfile
import threading
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from bench_laboratory import READY, VENDORS, Failure  # noqa: E402
from crafted_packets import DATA, DATA_FRAG, HEARTBEAT, Known, crafted  # noqa: E402
from played_laboratory import PlayedLaboratory  # noqa: E402
from process_figures import figures  # noqa: E402

MAX_GROWTH_MB = 10.0
MAX_PROCESSOR_S = 20.0  # without a bound, an analysis stood for over a minute
PACKETS_PER_S = 300.0
PACKETS_BETWEEN_LOOKS = 20
SETTLING_S = 5.0  # announced participants are silent, and forgotten after their lease
LOOPBACK_IN_IPV4 = 14 + 20 + 8


class Secured:
    """Folders that `dyncal security` makes, one a role; none: plain."""

    def __init__(self, laboratory, is_secured):
        self.folder = laboratory.folder / "authority" if is_secured else None
        self.laboratory = laboratory
        if is_secured:
            self.call("init", self.folder)

    def call(self, *words):
        command = self.laboratory.start_program("dyncal", ["security", *words])
        if command.wait() != 0:
            raise Failure(command.errors())

    def options(self, role, *benches):
        if self.folder is None:
            return []
        place = self.laboratory.folder / "-".join((role, *benches))
        of_benches = [word for bench in benches for word in ("--bench", bench)]
        if not place.exists():
            self.call("issue", self.folder, role, "--output", place, *of_benches)
        return ["--security", place]


class Bench:
    def __init__(self, laboratory, name, secured, domain=None):
        self.laboratory = laboratory
        self.name = name
        self.secured = secured
        if domain is not None:
            laboratory.domain = domain

    def start_source(self):
        options = self.secured.options("source", self.name)
        source = self.laboratory.on_bus("dyncal-acs", [self.laboratory.bench_file, *options])
        source.wait_for_text(READY["dyncal-acs"])
        return source

    def run(self):
        place = ["--output", self.laboratory.folder / "run.json"]
        options = self.secured.options("operator", self.name)
        words = ["run", self.laboratory.bench_file, *place, *options]
        return self.laboratory.on_bus("dyncal", words)


def submessages_of(packet):
    at = 20
    while at + 4 <= len(packet):
        kind, flags = packet[at], packet[at + 1]
        length = struct.unpack_from("<H" if flags & 1 else ">H", packet, at + 2)[0]
        yield kind, packet[at + 4 : at + 4 + length] if length else packet[at + 4 :]
        at = at + 4 + length if length else len(packet)


class Ear(threading.Thread):
    """Hears the RTPS packets of this host to some ports, or all, as long as this process lives."""

    def __init__(self, ports=range(65_536)):
        super().__init__(daemon=True)
        self.ports = ports
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.ntohs(3))
        self.endpoints = {}  # by prefix: writers, and who they write to
        self.start()

    def run(self):
        while True:
            frame = self.socket.recv(65_536)
            packet = frame[LOOPBACK_IN_IPV4:]
            port = int.from_bytes(frame[LOOPBACK_IN_IPV4 - 6 : LOOPBACK_IN_IPV4 - 4], "big")
            if not packet.startswith(b"RTPS") or port not in self.ports:
                continue
            heard = self.endpoints.setdefault(packet[8:20], set())
            for kind, body in submessages_of(packet):
                at = {DATA: 4, DATA_FRAG: 4, HEARTBEAT: 0}.get(kind)
                if at is not None and len(body) >= at + 8:
                    reader, writer = struct.unpack_from(">II", body, at)
                    heard.add((writer, reader))

    def prefixes(self):
        return set(self.endpoints)

    def known(self, prefixes):
        return [Known(one, *ends) for one in prefixes for ends in sorted(self.endpoints[one])]


def open_ports():
    ports = set()
    for line in pathlib.Path("/proc/net/udp").read_text(encoding="ascii").splitlines()[1:]:
        ports.add(int(line.split()[1].split(":")[1], 16))
    return sorted(ports)


def send_all(packets, domain, services):
    """To every port of this host, and to the multicast group of the domain."""
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
    places = [("127.0.0.1", port) for port in open_ports()]
    places.append(("239.255.0.1", 7400 + 250 * domain))
    began = time.monotonic()
    last = []
    for number, (name, packet) in enumerate(packets):
        for place in places:
            try:
                out.sendto(packet, place)
            except OSError:
                pass  # nobody listens at this port any more
        last.append(name)
        if number % PACKETS_BETWEEN_LOOKS == 0:
            expect_all_run(services, last[-2 * PACKETS_BETWEEN_LOOKS :])
            time.sleep(max(0.0, began + number / PACKETS_PER_S - time.monotonic()))  # the rate
    if len(last) < 1000:
        raise Failure("hardly any packet was made")
    return len(last)


def expect_all_run(services, after=()):
    for service in services:
        status = service.process.poll()
        if status is not None and not (status == 0 and service.log.parent.name.endswith("dyncal")):
            raise Failure(f"{service.log.parent.name} ended with {status} after {list(after)}")


def memory_mb(services):
    return {
        f"{service.log.parent.parent.name}/{service.log.parent.name}": figures(
            service.process.pid
        ).resident_mb
        for service in services
    }


def timed_run(laboratory, bench):
    began_s = time.monotonic()
    laboratory.expect_same_bits(bench.run())
    return time.monotonic() - began_s


def attacked(programs, folder, vendors, arguments, seed):
    with (
        PlayedLaboratory(programs, folder / "target", vendors, name="target") as first,
        PlayedLaboratory(programs, folder / "other", vendors, name="other") as second,
    ):
        secured = Secured(first, arguments.secured)
        target = Bench(first, "target", secured)
        other = Bench(second, "other", secured, first.domain)
        ear = Ear()
        services = [target.start_source()]
        time.sleep(2.0)  # it announces itself once a second
        of_target = ear.prefixes()
        options = secured.options("analysis")
        services.append(first.on_bus("dyncal-analysis", options))
        services[-1].wait_for_text(READY["dyncal-analysis"])
        services.append(other.start_source())
        first.expect_same_bits(target.run())
        known = ear.known(of_target)
        second.expect_same_bits(other.run())
        at_first = memory_mb(services)
        undisturbed_s = max(timed_run(second, other) for _ in range(2))
        if not known and not arguments.secured:
            raise Failure("no packet of the target was seen")
        before = memory_mb(services)
        run = other.run()
        run.wait_for_text("run folder")
        began_s = time.monotonic()
        used_s = [figures(service.process.pid).cpu_s for service in services]
        packets = crafted(known[:12] if arguments.copied else [], seed, ("target", "other"))
        sent = send_all(packets, first.domain, [*services, run])
        sent_s = time.monotonic() - began_s
        second.expect_same_bits(run)
        delay_s = time.monotonic() - began_s - max(undisturbed_s, sent_s)
        expect_all_run(services)
        now_s = [figures(service.process.pid).cpu_s for service in services]
        processor_s = max(now - before for now, before in zip(now_s, used_s))
        if processor_s > MAX_PROCESSOR_S:
            raise Failure(f"a program took {processor_s:.1f} s of processor time")
        time.sleep(SETTLING_S)
        second.expect_same_bits(other.run())
        expect_all_run(services)
        after = memory_mb(services)
        growth = {  # beyond that of two undisturbed runs, whose samples sources keep for a while
            name: after[name] - before[name] - max(0.0, before[name] - at_first[name])
            for name in before
        }
        if max(growth.values()) > MAX_GROWTH_MB:
            raise Failure(f"growth in MB: {growth}")
        return sent, max(growth.values()), delay_s, processor_s


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--vendors", type=lambda words: words.split(","), default=list(VENDORS))
    parser.add_argument("--secured", action="store_true")
    parser.add_argument("--copied", action="store_true", help="packets with a copied GUID, too")
    parser.add_argument("--seeds", type=int, default=1)
    arguments = parser.parse_args()
    held = []
    for vendors in arguments.vendors:
        for seed in range(1, arguments.seeds + 1):
            what = f"{vendors:10} {'secured' if arguments.secured else 'plain'}, seed {seed}"
            folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-crafted-"))
            programs = arguments.programs.resolve()
            try:
                sent, growth_mb, delay_s, used_s = attacked(
                    programs, folder, vendors, arguments, seed
                )
                cost = f"growth {growth_mb:.1f} MB, at most {used_s:.1f} s of processor time"
                longer = f"the run took {max(delay_s, 0.0):.1f} s longer"
                print(f"{what}: holds, {sent} packets, {cost}, {longer}", flush=True)
                shutil.rmtree(folder)
                held.append(True)
            except PermissionError:
                print("skipped: packets cannot be looked at without root")
                return 77
            except Failure as failure:
                print(f"{what}: {failure} (logs in {folder})", flush=True)
                held.append(False)
    print(f"{sum(held)} of {len(held)} hold")
    return 0 if held and all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
