#!/usr/bin/env python3
"""Many benches on one network and one analysis: do they disturb each other, what do they cost?

    many_benches_campaign.py PROGRAMS [--benches 8] [--acs-rate-hz 50000] [--warm-s 60]
                             [--rounds 2] [--vendors cyclonedds,...] [--secured] [--apart-s 0]

PROGRAMS is the folder of the built programs. The instruments of all benches and one service of each
kind for all of them are on one host, the analysis on another, and 16 runs each on those of
operators (a host holds 31 programs of a domain). The services run for --warm-s; then every bench
begins a run in the same instant, or --apart-s after the one before, as people do, with steps enough
that all measure at once; --rounds times. Held: every run ends with 0 and every value valid,
without loss and without flag; the analysis takes less than 30 % of a core and 200 MB (of 8 benches;
in proportion with more). Printed: how long arming took, what the services used. With --secured
each program has the folder of its role, and those of sources and operators are for all benches; how
much the analysis takes is then printed alone.
Exit status 1 if something did not hold, 77 where there are no network namespaces.
"""

import argparse
import pathlib
import shutil
import sys
import tempfile
import time

import hosts
from bench_laboratory import READY, SERVICES, VENDORS, BenchLaboratory, Failure
from process_figures import figures

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "security"))
from secured_bench import secured_environments  # noqa: E402

MAX_CORE = 0.3
MAX_RESIDENT_MB = 200.0
BENCHES_OF_THOSE = 8
RUNS_OF_AN_OPERATOR = 16
FREQUENCIES_HZ = ("40", "80", "125")
STEP_S = 2.5  # about what one takes


class HostedLaboratory(BenchLaboratory):
    """A bench whose programs are on hosts that others share; its services are started for all."""

    def __init__(self, network, number, *arguments, **options):
        self.network = network
        self.host_of = {
            "dyncal-analysis": "analysis",
            "dyncal": f"operator{number // RUNS_OF_AN_OPERATOR}",
        }
        super().__init__(*arguments, services=(), **options)

    def start_program(self, program, arguments):
        host = self.host_of.get(program, "bench")
        if program == "dyncal-virtual-bench":
            listen = f"{self.network.address['bench']}:0"
            arguments = [*arguments, "--generator-listen", listen]
        return super().start_program(program, arguments, self.network.command(host))

    def on_bus(self, program, arguments):
        return super().on_bus(program, [*arguments, "--interface", "lab"])

    def generator_host(self):
        return self.network.address["bench"]


def begin_runs(benches, apart_s):
    """One of each bench; returns them, and how long each took until its first step is announced."""
    begins_s = [time.monotonic() + number * apart_s for number in range(len(benches))]
    runs, waits_s = [], {}
    while len(waits_s) < len(benches):
        if len(runs) < len(benches) and time.monotonic() >= begins_s[len(runs)]:
            runs.append(benches[len(runs)].run())
        for number, run in enumerate(runs):
            if number not in waits_s and ("step 1 of" in run.errors() or not run.runs()):
                waits_s[number] = time.monotonic() - begins_s[number]
        time.sleep(0.01)  # between two looks
    return runs, list(waits_s.values())


def judge(bench, run):
    status = run.wait()
    if status != 0:
        raise Failure(f"{bench.name}: exit status {status}: {run.errors().strip()[-300:]}")
    return sum("attempt" in point for point in bench.expect_whole_result())


def used_of(services):
    return {name: figures(service.process.pid) for name, service in services.items()}


def round_of(benches, services, apart_s, limited):
    before, began_s = used_of(services), time.monotonic()
    runs, arming_s = begin_runs(benches, apart_s)
    repeated = sum(judge(bench, run) for bench, run in zip(benches, runs))
    after, took_s = used_of(services), time.monotonic() - began_s
    print(
        f"    {len(benches)} runs in {took_s:.1f} s, first step after {min(arming_s):.2f} to "
        f"{max(arming_s):.2f} s; {repeated} values of repeated steps"
    )
    for name, now in after.items():
        used_s = now.cpu_s - before[name].cpu_s
        core = used_s / took_s
        print(
            f"        {name:16} {100 * core:5.1f} % of a core, {used_s / len(benches):.3f} s a "
            f"run; {now.resident_mb:.0f} MB, at most {now.peak_mb:.0f} MB",
            flush=True,
        )
        share = max(1.0, len(benches) / BENCHES_OF_THOSE)
        if limited and name == "dyncal-analysis" and (
            core > share * MAX_CORE or now.resident_mb > share * MAX_RESIDENT_MB
        ):
            raise Failure("the analysis used more than it may")


def start_services(benches):
    files = [bench.bench_file for bench in benches]
    services = {}
    for name in SERVICES:
        services[name] = benches[0].on_bus(name, [] if name == "dyncal-analysis" else files)
        services[name].wait_for_text(READY[name])
    return services


def campaign(arguments, vendors):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-benches-"))
    operators = (arguments.benches - 1) // RUNS_OF_AN_OPERATOR + 1
    network = hosts.Hosts(("bench", "analysis", *(f"operator{i}" for i in range(operators))))
    benches = []
    repeats = 1 + round(arguments.benches * arguments.apart_s / (STEP_S * len(FREQUENCIES_HZ)))
    environments = {}
    if arguments.secured:
        names = [f"b{number}" for number in range(arguments.benches)]
        environments = secured_environments(arguments.programs, folder / "security", names)
    try:
        for number in range(arguments.benches):
            benches.append(
                HostedLaboratory(
                    network,
                    number,
                    arguments.programs,
                    folder / f"b{number}",
                    vendors,
                    frequencies=FREQUENCIES_HZ * repeats,
                    name=f"b{number}",
                    domain=benches[0].domain if benches else None,
                    acs_rate_hz=arguments.acs_rate_hz,
                    environments=environments,
                )
            )
        services = start_services(benches)
        time.sleep(arguments.warm_s)
        for _ in range(arguments.rounds):
            round_of(benches, services, arguments.apart_s, limited=not arguments.secured)
    except Failure as failure:
        print(f"{vendors}: {failure} (logs in {folder})", flush=True)
        return False
    finally:
        for bench in reversed(benches):
            bench.close()
        network.close()
    shutil.rmtree(folder)
    print(f"{vendors}: {arguments.benches} benches hold", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--benches", type=int, default=8)
    parser.add_argument("--acs-rate-hz", type=int, default=50000)
    parser.add_argument("--warm-s", type=float, default=60.0)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--vendors", type=lambda text: text.split(","), default=list(VENDORS))
    parser.add_argument("--secured", action="store_true")
    parser.add_argument("--apart-s", type=float, default=0.0)
    arguments = parser.parse_args()
    arguments.programs = arguments.programs.resolve()
    if not hosts.can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    held = [campaign(arguments, vendors) for vendors in arguments.vendors]
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
