#!/usr/bin/env python3
"""Renews a certificate and revokes another one while runs of a secured bench last.

    rotation_campaign.py PROGRAMS [--vendors cyclonedds,fastdds,mixed] [--steps 16]

PROGRAMS is the folder of the built programs. Two analyses are there, each with a certificate of its
own. In the first run the sources get a new folder in the place of the old one, and the certificate
of the analysis that leads the run is revoked; the new list is put into all folders. Held is: the
run is whole, by the other analysis, which is heard at most 10 s after the list was renewed; every
program says once that there is a new list, and the revoked one ends. Then the sources
are restarted with their new folder, the certificate of their old one is revoked as well, and a
second run is whole, without a word of the analysis that was revoked.
Exit status 1 if something did not hold.
"""

import argparse
import pathlib
import shutil
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from bench_laboratory import SERVICES, VENDORS, Failure, wait_until  # noqa: E402
from secured_bench import SecuredBench  # noqa: E402

HEARD_S = 10.0
STEPS_A_FLAG = 100  # of three channels, one of which noise may flag
NEW_LIST = "revoked.pem: a new list"
STANDS_BY = "this service stands by"
TAKES_OVER = ": taken over"


class RotatedLaboratory(SecuredBench):
    """Without an analysis at first."""

    def __init__(self, programs, folder, vendors, steps):
        super().__init__(
            programs,
            folder,
            vendors,
            frequencies=[f"{20 + 80 * number / steps:.6g}" for number in range(steps)],
            services=[one for one in SERVICES if one != "dyncal-analysis"],
        )
        self.issue(programs, "analysis", "other-analysis")
        self.patience_s = 300.0 + 5.0 * steps  # with a run
        self.flagged_by_chance = steps // STEPS_A_FLAG

    def start_analysis(self, folder):
        self.environments["dyncal-analysis"] = {"DYNCAL_SECURITY": str(self.security / folder)}
        self.restart("dyncal-analysis")
        return self.services["dyncal-analysis"]

    def renew_sources(self):
        self.issue(self.programs, "source", "source-new")
        (self.security / "source").rename(self.security / "source-old")
        (self.security / "source-new").rename(self.security / "source")

    def revoke(self, name):
        """Returns when the list stands in all folders."""
        self.call(self.programs, "revoke", self.security / "authority", name)
        for folder in self.security.iterdir():
            if folder.name != "authority":
                shutil.copyfile(self.security / "authority/revoked.pem", folder / "new.pem")
                (folder / "new.pem").rename(folder / "revoked.pem")
        return time.monotonic()


def hold(condition, sentence):
    if not condition:
        raise Failure(sentence)


def rotate(laboratory):
    folders = {"analysis": "analysis", "other-analysis": "analysis-2"}
    analyses = {laboratory.start_analysis(folder): name for folder, name in folders.items()}
    run = laboratory.run("--run", "first")
    wait_until(laboratory.output_is_on, "the output of the generator")
    wait_until(lambda: any(STANDS_BY in one.errors() for one in analyses), "an analysis to lead")
    other = next(one for one in analyses if STANDS_BY in one.errors())
    revoked = next(one for one in analyses if one is not other)
    laboratory.renew_sources()
    renewed_s = laboratory.revoke(analyses[revoked])
    other.wait_for_text(TAKES_OVER)
    heard_s = time.monotonic() - renewed_s
    status = run.wait(laboratory.patience_s)
    hold(status == 0, f"the run ended with {status}: {run.errors()}")
    laboratory.expect_whole_result(laboratory.flagged_by_chance)
    hold(heard_s <= HEARD_S, f"the other analysis took over after {heard_s:.1f} s")
    for one in [run, other, revoked, *laboratory.services.values()]:
        hold(one.errors().count(NEW_LIST) <= 1, f"said more than once: {one.log}")
    for one in (run, other, revoked):
        hold(NEW_LIST in one.errors(), f"not said: {one.log}")
    hold("own certificate is revoked" in revoked.errors(), f"not said: {revoked.log}")
    hold(not revoked.runs(), f"has not ended: {revoked.log}")
    for service in ("dyncal-dau", "dyncal-acs"):
        laboratory.services[service].end()
        laboratory.restart(service)
    laboratory.revoke("source-live")
    run = laboratory.run("--run", "second")
    status = run.wait(laboratory.patience_s)
    hold(status == 0, f"the second run ended with {status}: {run.errors()}")
    laboratory.expect_whole_result(laboratory.flagged_by_chance)
    hold(other.errors().count(": armed") == 1, f"the second run was not the other's: {other.log}")
    return heard_s


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    options.add_argument("programs")
    options.add_argument("--vendors", default=",".join(VENDORS))
    options.add_argument("--steps", type=int, default=16, help="of a run; 240 are ten minutes")
    arguments = options.parse_args()
    failed = 0
    for vendors in arguments.vendors.split(","):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-rotation-"))
        try:
            with RotatedLaboratory(
                arguments.programs, folder, vendors, arguments.steps
            ) as laboratory:
                heard_s = rotate(laboratory)
            print(f"{vendors}: held; the other analysis took over after {heard_s:.1f} s")
            shutil.rmtree(folder)
        except Failure as failure:
            failed += 1
            print(f"{vendors}: FAILED: {failure} (left in {folder})")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
