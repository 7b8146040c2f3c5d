#!/usr/bin/env python3
"""Changes the addresses of a host, between runs or in one, and judges who is heard again.

    address_campaign.py PROGRAMS [--draws 54] [--seed 1] [--vendors cyclonedds,...] [--at-once 3]
                        [--slack-s 3]

PROGRAMS is the folder of the built programs. Bench (instruments, sources, guard), analysis and
operator are on a host each, as in link_campaign.py; the generator is reached over a cable of its
own, which keeps its addresses. A service that ends with a failure is started again after 2 s, as
systemd does. A draw is an event on one host: its address `changes`, at once or after a while, comes
`late` (after its programs), is `gone` for up to 6 s and comes back, its interface is `plugged` in
again, or a bridge of `containers` comes besides.

Held between runs: a run that begins with the event is in its first step within 15 s, and ends
whole; in a run: it ends whole, whatever was changed. Where nobody is deaf (`gone`, `containers`),
no service ends; where somebody is, it says why.
Exit status 1 if a draw did not hold, 77 where there are no network namespaces.
"""

import argparse
import concurrent.futures
import itertools
import pathlib
import random
import shutil
import sys
import tempfile
import threading
import time

import hosts
from bench_laboratory import READY, SERVICES, VENDORS, BenchLaboratory, Failure, wait_until
from kill_campaign import expect_off, judge, undisturbed_result
from link_campaign import HOST_OF, HOSTS, EXCITED_S, SpreadLaboratory

RESTART_S = 2.0  # RestartSec= of the units
FIRST_STEP_S = 15.0
SAID = ("nobody hears", "is not one that is up with an IPv4 address")
SAID_WITHIN_S = 10.0
DEAFENING = ("changes", "late", "plugged")
HARMLESS = ("gone", "containers")


class ServedLaboratory(SpreadLaboratory):
    """Its services are started again as systemd does; `named`: analysis with --interface."""

    def __init__(self, programs, folder, vendors, named):
        self.named = named
        self.restarts = dict.fromkeys(SERVICES, 0)
        self.ending = threading.Event()
        self.keepers = []
        self.moved = itertools.count(101)
        super().__init__(programs, folder, vendors, services=())

    def start_virtual_bench(self):
        """With a cable between bench and operator, for the generator."""
        bench, operator = self.hosts.namespace("bench"), self.hosts.namespace("operator")
        hosts.ip(
            *["-n", bench, "link", "add", "devices", "type", "veth"],
            *["peer", "name", "devices", "netns", operator],
        )
        for number, name in enumerate(("bench", "operator"), start=1):
            place = ["-n", self.hosts.namespace(name)]
            hosts.ip(*place, "address", "add", f"10.99.0.{number}/24", "dev", "devices")
            self.hosts.set_link(name, "devices", "up")
        super().start_virtual_bench()

    def generator_host(self):
        return "10.99.0.1"

    def start_program(self, program, arguments, on_host=()):
        if program == "dyncal-virtual-bench":
            arguments = [*arguments, "--generator-listen", "10.99.0.1:0"]
        host = on_host or self.hosts.command(HOST_OF.get(program, "bench"))
        return super(SpreadLaboratory, self).start_program(program, arguments, host)

    def on_bus(self, program, arguments):
        if program == "dyncal-analysis" and not self.named:
            return super(SpreadLaboratory, self).on_bus(program, arguments)
        return super().on_bus(program, arguments)

    def serve(self):
        for service in SERVICES:
            self.keepers.append(threading.Thread(target=self.keep, args=(service,)))
            self.keepers[-1].start()

    def keep(self, service):
        while not self.ending.is_set():
            try:
                self.restart(service)
                wait_until(
                    lambda: self.ending.is_set() or not self.services[service].runs(),
                    f"the end of {service}",
                    interval_s=0.05,
                )
            except Failure:
                pass  # it ended before it was ready
            self.restarts[service] += not self.ending.is_set()
            self.ending.wait(RESTART_S)

    def wait_until_ready(self):
        for service in SERVICES:
            wait_until(lambda one=service: one in self.services, f"the start of {service}", 20.0)
            self.services[service].wait_for_text(READY[service])

    def set_address(self, host, what, address):
        place = ["-n", self.hosts.namespace(host)]
        hosts.ip(*place, "address", what, f"{address}/24", "dev", "lab")

    def change(self, event, host, away_s):
        own = self.hosts.address[host]
        if event == "late":
            self.set_address(host, "add", own)
        elif event == "changes":
            self.set_address(host, "delete", own)
            time.sleep(away_s)  # drawn
            self.set_address(host, "add", f"10.98.0.{next(self.moved)}")
        elif event == "gone":
            self.set_address(host, "delete", own)
            time.sleep(away_s)
            self.set_address(host, "add", own)
        elif event == "plugged":
            hosts.ip("-n", self.hosts.namespace(host), "link", "delete", "lab")
            time.sleep(away_s)
            self.hosts.connect(host, own)
        else:
            place = ["-n", self.hosts.namespace(host)]
            hosts.ip(*place, "link", "add", "docker0", "type", "bridge")
            hosts.ip(*place, "address", "add", "172.17.0.1/16", "dev", "docker0")
            self.hosts.set_link(host, "docker0", "up")

    def said_by(self, host):
        services = [one for one in SERVICES if HOST_OF.get(one, "bench") == host]
        return "".join(
            program.errors()
            for program in self.started
            if any(program.log.parent.name.endswith(one) for one in services)
        )

    def close(self):
        self.ending.set()
        for keeper in self.keepers:
            keeper.join()
        super().close()


def judge_services(laboratory, event, host):
    restarted = {service for service, count in laboratory.restarts.items() if count}
    on_host = {service for service in SERVICES if HOST_OF.get(service, "bench") == host}
    if event in HARMLESS and restarted:
        raise Failure(f"{sorted(restarted)} ended without need")
    if not restarted <= on_host:
        raise Failure(f"{sorted(restarted)} ended, which are not on {host}")
    if event in DEAFENING and on_host:
        wait_until(
            lambda: any(one in laboratory.said_by(host) for one in SAID),
            "a service that says why nobody hears it",
            SAID_WITHIN_S,
        )


def between_runs(laboratory, arguments, event, host, chance):
    laboratory.change(event, host, chance.choice((0.0, chance.uniform(0.0, 6.0))))
    began_s = time.monotonic()
    run = laboratory.run()
    run.wait_for_text("step 1 of", FIRST_STEP_S + arguments.slack_s)
    return run, time.monotonic() - began_s


def within_run(laboratory, event, host, chance):
    run = laboratory.run()
    run.wait_for_text("step 1 of")
    time.sleep(chance.uniform(0.0, EXCITED_S))  # the drawn instant
    laboratory.change(event, host, chance.choice((0.0, chance.uniform(0.0, 6.0))))
    return run, 0.0


def draw(arguments, number, case, undisturbed):
    vendors, event, host, when = case
    chance = random.Random(f"{arguments.seed} {number} {case}")
    named = event != "late" and chance.random() < 0.5
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-address-"))
    what = f"{number:3} {vendors:11} {host:9} {event:10} {when:7}"
    try:
        with ServedLaboratory(arguments.programs, folder, vendors, named) as laboratory:
            if event == "late":
                laboratory.set_address(host, "delete", laboratory.hosts.address[host])
            laboratory.serve()
            if event == "late":
                time.sleep(chance.uniform(1.0, 5.0))  # its programs run, or try to
            else:
                laboratory.wait_until_ready()
            if when == "between":
                run, first_s = between_runs(laboratory, arguments, event, host, chance)
            else:
                run, first_s = within_run(laboratory, event, host, chance)
            status = run.wait()
            expect_off(laboratory)
            if status != 0:
                raise Failure(f"exit status {status}: {run.errors().strip().splitlines()[-1:]}")
            repeated = judge(laboratory, undisturbed)
            judge_services(laboratory, event, host)
    except Failure as failure:
        print(f"{what} {failure} (logs in {folder})", flush=True)
        return False
    shutil.rmtree(folder)
    print(f"{what} holds, first step after {first_s:.1f} s, {repeated} repeated", flush=True)
    return True


def cases(vendors):
    """In an order that is drawn, each vendor, host and event as often as the others."""
    events = [(event, host) for event in DEAFENING + HARMLESS for host in HOSTS]
    for event, host in events:
        if event == "late":
            yield from ((one, event, host, "between") for one in vendors if host != "operator")
        else:
            yield from ((one, event, host, when) for one in vendors for when in ("in", "between"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--draws", type=int, default=54)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    parser.add_argument("--at-once", type=int, default=3)
    parser.add_argument("--slack-s", type=float, default=3.0, help="of a busy machine")
    parser.add_argument("--only", default="", help="words of a case, such as 'late bench'")
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    drawn = [one for one in cases(arguments.vendors) if set(arguments.only.split()) <= set(one)]
    random.Random(arguments.seed).shuffle(drawn)
    drawn = list(itertools.islice(itertools.cycle(drawn), arguments.draws))
    undisturbed = undisturbed_result(arguments, BenchLaboratory)
    with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
        held = list(
            pool.map(lambda one: draw(arguments, *one, undisturbed), enumerate(drawn))
        )
    print(f"{sum(held)} of {len(held)} hold")
    return 0 if held and all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
