#!/usr/bin/env python3
"""What `dyncal run` and `dyncal doctor` say where an analysis runs and is not heard.

    unheard_analysis_test.py PROGRAMS

PROGRAMS is the folder of the built programs. Operator and analysis are on a host each. The network
carries no multicast, the operator has no IPv4 address, its packets to other hosts are dropped, or
its datagrams alone, or nearly all packets; its link goes down and comes back all the time, or is of
1 Mbit/s and others send more both ways. The sentence names that cause and no other, and the
operator's own address where it has one. The opposite: where the network is sound, it names none.
Exit status 1 if a sentence does not fit, 77 where there are no network namespaces.
"""

import concurrent.futures
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

import hosts
from bench_laboratory import READY, Failure, Program, reserve_dds_domain

BENCH = """bench = "unheard"
[excitation]
frequencies_hz = ["10"]
level = 1.0
[sources.acs]
driver = "file"
path = "record.csv"
units = { reference = "m/s^2", dut = "m/s^2" }
[method]
kind = "analogue"
reference = "acs/reference"
dut = ["acs/dut"]
"""
RECORD = "t_ns,reference,dut\n0,0,0\n1000000,1,1\n2000000,0,0\n"
WAIT_S = 120.0
FLAP_DOWN_S, FLAP_UP_S = 1.7, 0.3
NARROW = (  # the queue counts packets: small ones are lost as large ones are
    "qdisc add dev lab root handle 1: htb default 10",
    "class add dev lab parent 1: classid 1:10 htb rate 1mbit",
    "qdisc add dev lab parent 1:10 pfifo limit 8",
)
FLOOD = """import socket, time
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as flood:
    while True:
        for _ in range(10):
            flood.sendto(bytes(1400), ("%s", 9))
        time.sleep(0.01)  # 11 Mbit/s
"""


def rule(hook, match):
    chain = f"type filter hook {hook} priority 0; {match} drop;"
    return f"table ip unheard_{hook} {{\nchain lost {{\n{chain}\n}}\n}}\n"


MULTICAST = "ip daddr 224.0.0.0/4"
UNICAST = "ip daddr 10.98.0.0/24"
DATAGRAMS = f"{UNICAST} meta l4proto udp"
SEGMENTS = f"{UNICAST} meta l4proto tcp"
OWN = "this host is 10.98.0.1 (lab)"
FIREWALL = "does not let UDP through"
CUT = "a way that is cut in one direction"
# What is done, the vendor, what is said, and what is not.
CASES = {
    "no multicast": ("cyclonedds", ("nothing is heard in DDS domain", "--peer", OWN), ()),
    "no IPv4": ("cyclonedds", ("no IPv4 address", "lab has IPv6 alone"), ()),
    "one way": ("fastdds", ("announcements come from 10.98.0.2", "no answer", CUT, OWN), ()),
    "no datagrams": ("fastdds", ("come from 10.98.0.2", "no answer", FIREWALL, OWN), (CUT,)),
    "flapping": ("fastdds", ("the link of lab went down or came back", OWN), ()),
    "overloaded": ("fastdds", ("the link of lab is overloaded", OWN), (CUT, FIREWALL)),
    "lost": ("fastdds", ("no answer: the link is overloaded or bad", OWN), (CUT, FIREWALL)),
    "no analysis": ("cyclonedds", ("nothing is heard in DDS domain", OWN), ()),
    "sound": ("fastdds", (), ()),
}


class TwoHosts:
    def __init__(self, programs, folder, case):
        self.programs, self.folder, self.case = programs, folder, case
        self.hosts = hosts.Hosts(("operator", "analysis"))
        self.domain, self.keeper = reserve_dds_domain()
        (folder / "bench.toml").write_text(BENCH, encoding="utf-8")
        (folder / "record.csv").write_text(RECORD, encoding="utf-8")
        self.started = []
        self.over = threading.Event()
        self.flapping = threading.Thread(target=self.flap)

    def start(self, host, program, *arguments):
        place = ["--domain", self.domain, "--dds", CASES[self.case][0]]
        command = [*self.hosts.command(host), str(self.programs / program), *arguments, *place]
        log = self.folder / f"{len(self.started)}.txt"
        self.started.append(Program([str(one) for one in command], log))
        return self.started[-1]

    def drop(self, hook, match):
        command = [*self.hosts.command("operator"), "nft", "-f", "-"]
        subprocess.run(command, check=True, input=rule(hook, match), text=True)

    def disturb(self):
        if self.case == "no multicast":
            self.drop("input", MULTICAST)
            self.drop("output", MULTICAST)
        elif self.case == "no IPv4":
            place = ["-n", self.hosts.namespace("operator")]
            hosts.ip(*place, "address", "delete", "10.98.0.1/24", "dev", "lab")
        elif self.case == "one way":
            self.drop("output", UNICAST)
        elif self.case == "no datagrams":
            self.drop("output", DATAGRAMS)
        elif self.case == "flapping":
            self.flapping.start()
        elif self.case == "overloaded":
            self.overload("operator", "analysis")
            self.overload("analysis", "operator")
        elif self.case == "lost":
            self.drop("output", DATAGRAMS)
            self.drop("input", f"{SEGMENTS} numgen random mod 10 < 8")

    def overload(self, sender, receiver):
        command = self.hosts.command(sender)
        for line in NARROW:
            subprocess.run([*command, "tc", *line.split()], check=True)
        flood = FLOOD % self.hosts.address[receiver]
        log = self.folder / f"flood of {sender}.txt"
        self.started.append(Program([*command, sys.executable, "-c", flood], log))

    def flap(self):
        while not self.over.is_set():
            self.hosts.set_cable("operator", "down")
            self.over.wait(FLAP_DOWN_S)
            self.hosts.set_cable("operator", "up")
            self.over.wait(FLAP_UP_S)

    def close(self):
        self.over.set()
        if self.flapping.is_alive():
            self.flapping.join()
        for program in self.started:
            program.end()
        self.keeper.close()
        self.hosts.close()


def said(programs, folder, case):
    """By a run that finds no analysis; nothing where it finds one."""
    laboratory = TwoHosts(programs, folder, case)
    try:
        if case != "no analysis":
            laboratory.start("analysis", "dyncal-analysis").wait_for_text(READY["dyncal-analysis"])
        laboratory.disturb()
        run = laboratory.start("operator", "dyncal", "run", folder / "bench.toml")
        began_s = time.monotonic()
        run.wait(WAIT_S)
        print(f"{case}, after {time.monotonic() - began_s:.0f} s: {run.errors().strip()[-600:]}")
        return run.errors()
    finally:
        laboratory.close()


def fits(programs, case):
    with tempfile.TemporaryDirectory(prefix="dyncal-unheard-") as folder:
        try:
            text = said(programs, pathlib.Path(folder), case)
        except Failure as failure:
            print(f"{case}: {failure}")
            return False
    wanted = CASES[case][1]
    if not wanted:  # its source is missing, which is another sentence
        wanted = ("source 'acs' of bench 'unheard' is not on the network",)
        if "no analysis service answers" in text:
            print(f"{case}: a sound network is blamed")
            return False
    missing = [one for one in wanted if one not in text]
    if missing:
        print(f"{case}: it does not say {missing}")
    others = [one for one in CASES[case][2] if one in text]
    if case not in ("overloaded", "lost") and "overloaded" in text:
        others.append("overloaded")
    if others:
        print(f"{case}: it says {others}")
    return not missing and not others


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    with concurrent.futures.ThreadPoolExecutor(len(CASES)) as pool:
        held = list(pool.map(lambda case: fits(programs, case), CASES))
    print(f"{sum(held)} of {len(held)} sentences fit")
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
