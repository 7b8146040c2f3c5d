#!/usr/bin/env python3
"""Four benches publish 100 MB/s in blocks of 64 kB over DDS, the recorder keeps them, and an
analysis evaluates a demo beside it: is every block in the recordings?

recorder_load.py PROGRAMS PUBLISHER FOLDER [--mb-per-s 100] [--seconds 20] [--dds NAME]
                 [--demo-speed 1]

By hand: it needs two quiet cores, and a disk that takes so much. Prints rates, the processor time
of each, and what was not stored or is missing; status 1 if that is not nothing.
"""

import argparse
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import threading
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

BENCHES = 4
PATIENCE_S = 60


def processor_s(pid):
    """Of a process that lives, in user and system."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text("ascii").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def wait_for(holds, what):
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        if time.monotonic() > deadline:
            sys.exit(f"{what} did not come within {PATIENCE_S} s")
        threading.Event().wait(0.05)




def info(programs, file):
    text = subprocess.run([programs / "dyncal", "recording", "info", file], capture_output=True,
                          text=True, check=True).stdout
    blocks = int(re.search(r"AcsSamples +(\d+) messages", text)[1])
    megabytes = float(re.search(r"AcsSamples +\d+ messages +([\d.]+) MB", text)[1])
    missing = int(re.search(r"acs.missing = (\d+)", text)[1])
    not_stored = int(re.search(r"recorder.not_stored = (\d+)", text)[1])
    damaged = int(re.search(r"(\d+) places are damaged", text)[1])
    return blocks, megabytes, missing, not_stored, damaged


def measure(arguments):
    programs, folder = arguments.programs, arguments.folder
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    domain = str(own_dds_domain())
    log = folder / "recorder.log"
    recorder = subprocess.Popen(
        [programs / "dyncal-recorder", "--folder", folder, "--domain", domain, "--dds",
         arguments.dds, *(word for i in range(BENCHES) for word in ("--bench", f"bench-{i + 1}"))],
        stderr=open(log, "w", encoding="utf-8"))
    wait_for(lambda: "recorder ready" in log.read_text("utf-8"), "the recorder")
    demo = subprocess.Popen(
        [programs / "dyncal", "demo", "--preset", "mpu9250-ptb", "--speed", arguments.demo_speed,
         "--output", folder / "demo"],
        stdout=subprocess.DEVNULL, stderr=open(folder / "demo.log", "w", encoding="utf-8"))
    lines = []
    publisher = subprocess.Popen(
        [arguments.publisher, domain, arguments.dds, str(arguments.mb_per_s)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    reading = threading.Thread(target=lambda: lines.extend(publisher.stdout))
    reading.start()
    wait_for(lambda: len(list(folder.glob("bench-*/*.mcap"))) == BENCHES, "a recording of each")
    began, recorder_began = time.monotonic(), processor_s(recorder.pid)
    threading.Event().wait(arguments.seconds)
    seconds = time.monotonic() - began
    recorder_s = processor_s(recorder.pid) - recorder_began
    publisher_s = processor_s(publisher.pid)
    is_analysing = demo.poll() is None
    publisher.stdin.close()
    publisher.wait()
    reading.join()
    recorder.send_signal(signal.SIGINT)
    status = recorder.wait(PATIENCE_S)
    demo.send_signal(signal.SIGINT)
    demo.wait(PATIENCE_S)
    print(f"recorder: status {status}, {recorder_s / seconds:.2f} cores, "
          f"publisher {publisher_s / seconds:.2f} cores, in {seconds:.1f} s; the analysis "
          f"{'ran all the time' if is_analysing else 'HAD ENDED: a longer demo is needed'}")
    return status == 0 and is_analysing, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("publisher", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--mb-per-s", type=float, default=100)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--dds", default="cyclonedds")
    parser.add_argument("--demo-speed", default="1")
    arguments = parser.parse_args()
    is_good, seconds = measure(arguments)
    total_mb = 0.0
    for file in sorted(arguments.folder.glob("bench-*/*.mcap")):
        blocks, megabytes, missing, not_stored, damaged = info(arguments.programs, file)
        total_mb += megabytes
        is_good = is_good and blocks > 0 and missing == not_stored == damaged == 0
        print(f"{file.parent.name}: {blocks} blocks, {megabytes:.0f} MB, {missing} missing, "
              f"{not_stored} not stored, {damaged} damaged")
    print(f"{total_mb / seconds:.1f} MB/s recorded; {arguments.dds}")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
