#!/usr/bin/env python3
"""The units under a real systemd: started, killed, hanging, wrongly configured, stopped.

    units_test.py --build BUILD --cmake CMAKE

A host of its own (systemd_host.py) has dyncal installed as deploy/README.md says, a bench file in
/etc/dyncal and its services as units; the instruments are a virtual bench. Held: `systemctl start`
returns when the service serves; a run is whole with the recorder and the page beside it; a service
that is killed in a run, or hangs, is started again by systemd and the run is whole; an invalid
option is not tried again; a run of a person in the group `dyncal` is read by it, one of another by
nobody else; stopping ends each with success. Exit status 77 and one line where such a
host cannot be made.
"""

import argparse
import pathlib
import shutil
import signal
import sys
import tempfile

from systemd_host import SystemdHost, why_not  # finds bench_laboratory, too

from bench_laboratory import BenchLaboratory, Failure, wait_until  # isort: skip

SYSTEM_USER = pathlib.Path(__file__).parents[2] / "deploy/debian/dyncal-daemons.sysusers"
BENCH = "live"
ANALYSIS = "dyncal-analysis"
SOURCES = [f"dyncal-dau@{BENCH}", f"dyncal-acs@{BENCH}"]
SERVICES = [ANALYSIS, *SOURCES, f"dyncal-guard@{BENCH}", "dyncal-recorder", "dyncal-web"]
# The unit allows 30 s to a main loop that does not turn, and 15 s to one that is to end.
IMPATIENT = "[Service]\nWatchdogSec=4\nTimeoutStopSec=2\n"


class InstalledLaboratory(BenchLaboratory):
    """Its services are units, which are not its own to start."""

    def __init__(self, host, domain):
        self.host = host
        super().__init__(
            pathlib.Path("/usr/local/bin"),
            host.shared / "bench",
            "cyclonedds",
            name=BENCH,
            domain=domain,
            services=(),
        )

    def start_program(self, program, arguments):
        return super().start_program(program, arguments, self.host.command())

    def whole_run(self, disturb=None):
        run = self.run()
        if disturb:
            run.wait_for_text("step 2 of", 60.0)
            disturb()
        status = run.wait(120.0)
        if status != 0:
            raise Failure(f"dyncal run ends with {status}: {run.errors()[-500:]}")
        self.expect_whole_result()


def start(host):
    for unit in SERVICES:
        if host.call("systemctl", "start", unit).returncode != 0:
            raise Failure(f"{unit} does not start: {host.journal(unit)[-1500:]}")
        state = host.show(unit, "ActiveState")
        if state != "active" or not host.show(unit, "StatusText"):
            raise Failure(f"{unit} is {state} and says nothing: {host.journal(unit)}")
        print(f"  {unit}: {host.show(unit, 'StatusText')}")


def run_beside_recorder_and_page(host, laboratory):
    laboratory.whole_run()
    kept = host.call("find", "/var/lib/dyncal-recorder/", "-name", "*.mcap", "-size", "+100k")
    if not kept.stdout.strip():
        raise Failure(f"the recorder has kept nothing: {host.journal('dyncal-recorder')}")
    page = host.call("python3", "-c", PAGE)
    if BENCH not in page.stdout:
        raise Failure(f"the page does not name the bench: {page.stdout} {page.stderr}")


PAGE = """
import urllib.request
print(urllib.request.urlopen("http://127.0.0.1:8080/api/laboratory", timeout=20).read().decode())
"""


def restarts_of(host, unit):
    return int(host.show(unit, "NRestarts"))


def is_restarted_in_a_run(host, laboratory, unit, number, patience_s):
    before = restarts_of(host, unit)

    def disturb():
        host.signal_unit(unit, number)
        wait_until(
            lambda: restarts_of(host, unit) > before
            and host.show(unit, "ActiveState") == "active",
            f"systemd to start {unit} again after {number.name}",
            patience_s,
        )

    laboratory.whole_run(disturb)
    if restarts_of(host, unit) != before + 1:
        raise Failure(f"{unit} was started again {restarts_of(host, unit) - before} times")


def invalid_option_is_not_tried_again(host):
    unit = "dyncal-dso@wrong"
    host.write(f"etc/dyncal/{unit}.options", "DYNCAL_OWN_OPTIONS=--no-such-option\n")
    if host.call("systemctl", "start", unit).returncode == 0:
        raise Failure(f"{unit} starts with an invalid option")
    if host.show(unit, "ActiveState") != "failed" or restarts_of(host, unit) != 0:
        raise Failure(f"{unit} is tried again: {host.show(unit, 'ActiveState')}")
    if "--no-such-option" not in host.journal(unit):
        raise Failure(f"the journal does not name the option: {host.journal(unit)}")


def late_bench_file_is_found(host, laboratory):
    """As a machine whose bench file is copied to it after it was switched on."""
    unit = "dyncal-acs@late"
    host.systemctl("stop", f"dyncal-acs@{BENCH}")  # their instrument serves one at a time
    host.call("systemctl", "start", "--no-block", unit)
    wait_until(lambda: restarts_of(host, unit) > 0, f"{unit} to be tried again", 30.0)
    late = laboratory.bench_text().replace(f'"{BENCH}"', '"late"')
    host.write("etc/dyncal/late.toml", late)
    wait_until(lambda: host.show(unit, "ActiveState") == "active", f"{unit} to serve", 30.0)
    host.systemctl("stop", unit)
    host.systemctl("start", f"dyncal-acs@{BENCH}")


def run_of_a_person_is_for_the_group(host, domain):
    """Who belongs to the group `dyncal` shares runs with the services, and with nobody else."""
    for unit in SERVICES:
        found = (host.show(unit, "Group"), host.show(unit, "UMask"))
        if found != ("dyncal", "0027"):
            raise Failure(f"{unit} has group and umask {found}")
    for person, groups, readable in (("ada", "dyncal", True), ("eve", "", False)):
        runs = f"/srv/{person}"
        host.call("useradd", *(["--groups", groups] if groups else []), person)
        host.call("install", "-d", "-o", person, "-m", "755", runs)
        as_person = ["setpriv", "--reuid", person, "--regid", person, "--init-groups"]
        words = ["dyncal", "run", f"/etc/dyncal/{BENCH}.toml", "--folder", f"{runs}/kept"]
        words += ["--domain", domain, "--interface", "lo"]
        run = host.call(*as_person, "env", "--chdir", runs, *words)
        if run.returncode != 0:
            raise Failure(f"dyncal run of {person} ends with {run.returncode}: {run.stderr[-500:]}")
        found = host.call("find", runs, "-name", "result.json").stdout.strip()
        reads = {
            group: host.call(
                "setpriv", "--reuid", 4711, "--regid", group, "--clear-groups", "test", "-r", found
            ).returncode
            == 0
            for group in ("dyncal", "4711")
        }
        if not found or reads != {"dyncal": readable, "4711": False}:
            raise Failure(f"the result of {person}, '{found}', is read by {reads}")


def stop(host):
    for unit in SERVICES:
        host.systemctl("stop", unit)
        found = (host.show(unit, "ActiveState"), host.show(unit, "Result"))
        if found != ("inactive", "success"):
            raise Failure(f"{unit} is stopped, and is {found}: {host.journal(unit)[-500:]}")


def test_units(host, domain):
    host.write("etc/sysusers.d/dyncal.conf", SYSTEM_USER.read_text(encoding="utf-8"))
    host.call("systemd-sysusers")
    with_loopback = f"DYNCAL_OPTIONS=--domain {domain} --interface lo\n"
    host.write("etc/dyncal/options", with_loopback)
    host.write(f"etc/systemd/system/{ANALYSIS}.service.d/impatient.conf", IMPATIENT)
    host.systemctl("daemon-reload")
    laboratory = InstalledLaboratory(host, domain)
    try:
        host.write(f"etc/dyncal/{BENCH}.toml", laboratory.bench_text())
        parts = (
            ("started", lambda: start(host)),
            ("a run", lambda: run_beside_recorder_and_page(host, laboratory)),
            *(
                (
                    f"{unit} is killed in a run",
                    lambda unit=unit: is_restarted_in_a_run(
                        host, laboratory, unit, signal.SIGKILL, 20.0
                    ),
                )
                for unit in (ANALYSIS, *SOURCES)
            ),
            (
                f"{ANALYSIS} hangs in a run",
                lambda: is_restarted_in_a_run(host, laboratory, ANALYSIS, signal.SIGSTOP, 30.0),
            ),
            ("an invalid option", lambda: invalid_option_is_not_tried_again(host)),
            ("a person's run", lambda: run_of_a_person_is_for_the_group(host, domain)),
            ("a bench file that comes late", lambda: late_bench_file_is_found(host, laboratory)),
            ("stopped", lambda: stop(host)),
        )
        for name, part in parts:
            part()
            print(f"{name}: holds", flush=True)
    finally:
        laboratory.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", required=True)
    parser.add_argument("--cmake", default="cmake")
    arguments = parser.parse_args()
    if reason := why_not():
        print(f"skipped: no systemd host, {reason}")
        return 77
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-units-"))
    try:
        host = SystemdHost(folder, arguments.build, arguments.cmake)
    except Failure as failure:
        shutil.rmtree(folder, ignore_errors=True)
        print(f"skipped: systemd does not start here: {failure}")
        return 77
    try:
        test_units(host, 7)  # its network is its own
    except Failure as failure:
        print(f"FAILED: {failure}")
        return 1
    finally:
        host.close()
        shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
