#!/usr/bin/env python3
"""Programs that join a secured laboratory: is each known to all others?

    join_campaign.py PROGRAMS [--vendors cyclonedds,fastdds] [--sources 4] [--joins 20]
                     [--seconds 4]

PROGRAMS is the folder of the built programs. An analysis and some sources are there; `dyncal
doctor` joins them --joins times and has --seconds, and up to 10 s more while somebody is not
authenticated.
Held: each time all answer it, and none is named as one that it may not talk to.
Exit status 1 if something did not hold, 77 where there are no network namespaces.
"""

import argparse
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "interop"))
from doctor_laboratory import HERE, Laboratory  # noqa: E402
from secured_bench import call, issue  # noqa: E402

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from hosts import can_be_made  # noqa: E402


def joins(options, vendor):
    """The sentences of the joins that did not hold."""
    laboratory = Laboratory(options.programs, (HERE,))
    benches = [f"bench-{number}" for number in range(options.sources)]
    folder = laboratory.folder
    wrong = []
    try:
        call(options.programs, "init", folder / "authority")
        for role, output in [("analysis", "analysis"), ("watcher", "watcher")]:
            issue(options.programs, folder, role, [], output)
        secured = ["--dds", vendor, "--security"]
        laboratory.start(HERE, "dyncal-analysis", *secured, folder / "analysis")
        for bench in benches:
            issue(options.programs, folder, "source", [bench], bench)
            file = laboratory.bench(bench)
            laboratory.start(HERE, "dyncal-acs", file, *secured, folder / bench)
        for _ in range(options.joins):
            report = laboratory.doctor(*secured, folder / "watcher", seconds=options.seconds)
            if len(report.get("programs", [])) != 1 + len(benches):
                said = [one["sentence"] for one in report["findings"] if one["check"] == "security"]
                wrong.append(f"{len(report.get('programs', []))} answered: {'; '.join(said)}")
    finally:
        laboratory.close()
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument(
        "--vendors", type=lambda text: text.split(","), default=["cyclonedds", "fastdds"]
    )
    parser.add_argument("--sources", type=int, default=4)
    parser.add_argument("--joins", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=4.0)
    options = parser.parse_args()
    if not can_be_made():
        print("skipped: this machine makes no network namespaces, or not for this user")
        return 77
    failed = 0
    for vendor in options.vendors:
        wrong = joins(options, vendor)
        failed += len(wrong)
        print(f"{vendor}: {options.joins - len(wrong)} of {options.joins} joins were whole")
        print("".join(f"  {sentence}\n" for sentence in wrong), end="", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
