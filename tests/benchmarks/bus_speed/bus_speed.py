#!/usr/bin/env python3
"""How fast the bus is beside the DDS implementations that carry it.

    bus_speed.py BIN [--rounds 5] [--seconds 1.5] [--loss 0] [--ends NAME...]

One writer and one reader, each a process, over loopback, at full rate: blocks of 16 KiB and of
40 kB, from a writer that waits for its reader. Beside ours run peers of the vendor alone, with its
defaults over UDP. All of a round run in turn, so that what the machine does otherwise meets all of
them; what counts are ratios of medians. Exit status 1: one of ours has lost blocks, or an end has
failed; what a vendor's defaults lose alone shows in the table.

A loss is of packets, in both directions, in a network of its own (needs to be root).
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2]))
import dds_domain  # noqa: E402

BYTES = [16384, 40000]
PATIENCE_S = 180
ENDS = {
    "cyclone alone": ["bus_speed_cyclone_end"],
    "cyclone mixed": ["bus_speed_end", "cyclonedds", "mixed"],
    "cyclone same": ["bus_speed_end", "cyclonedds", "same"],
    "fast alone": ["bus_speed_fast_end"],
    "fast mixed": ["bus_speed_end", "fastdds", "mixed"],
    "fast same": ["bus_speed_end", "fastdds", "same"],
}
ALONE = {name: f"{name.split()[0]} alone" for name in ENDS}


def start(binaries, end, what, block_bytes, blocks):
    program, *own = ENDS[end]
    command = [binaries / program, what, str(dds_domain.own_dds_domain()), str(block_bytes),
               str(blocks), *own]  # fmt: skip
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def measure(binaries, end, block_bytes, blocks):
    """What the reader says, with the processor time of both for each megabyte."""
    reader = start(binaries, end, "read", block_bytes, blocks)
    writer = start(binaries, end, "write", block_bytes, blocks)
    try:
        written, _ = writer.communicate(timeout=PATIENCE_S)
        read, _ = reader.communicate(timeout=PATIENCE_S)
    finally:
        for process in (reader, writer):
            process.kill()
            process.wait()
    seen = json.loads(read)
    seen["is_whole"] = seen["blocks"] == blocks and writer.returncode == 0
    seen["rate"] = (seen["blocks"] - 1) / seen["seconds"] if seen["blocks"] > 1 else 0.0
    megabytes = block_bytes * blocks / 1e6
    seen["cpu_ms_per_mb"] = 1e3 * (seen["cpu_s"] + json.loads(written)["cpu_s"]) / megabytes
    return seen


def blocks_for(binaries, end, block_bytes, seconds):
    """As many as take about so long."""
    rate = measure(binaries, end, block_bytes, 1000)["rate"]
    return max(500, int(rate * seconds))


def row(end, block_bytes, all_seen, rates):
    median = {key: statistics.median(seen[key] for seen in all_seen)
              for key in ("rate", "p50_ms", "p99_ms", "cpu_ms_per_mb")}  # fmt: skip
    rates[end] = median["rate"]
    ratio = median["rate"] / rates[ALONE[end]] if rates.get(ALONE[end]) else float("nan")
    return (f"{end:16} {block_bytes:6} {median['rate']:9.0f} {ratio:6.2f} {median['p50_ms']:8.2f} "
            f"{median['p99_ms']:8.2f} {median['cpu_ms_per_mb']:8.2f}")  # fmt: skip


def with_loss(percent, arguments):
    """The same in a network of its own, which loses packets."""
    drop = (f"table ip lossy {{ chain input {{ type filter hook input priority 0; meta l4proto udp "
            f"numgen random mod 1000 < {round(10 * percent)} counter drop; }}; }}")  # fmt: skip
    script = f"ip link set lo up multicast on && nft '{drop}' && exec \"$@\""
    os.execvp("unshare", ["unshare", "-n", "sh", "-c", script, "sh", sys.executable,
                          *arguments])  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1.5)
    parser.add_argument("--loss", type=float, default=0.0)
    parser.add_argument("--ends", nargs="+", default=[], choices=ENDS)
    parser.add_argument("--in-own-network", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.loss and not options.in_own_network:
        with_loss(options.loss, [*sys.argv, "--in-own-network"])
    ends = [end for end in options.ends or ENDS if (options.bin / ENDS[end][0]).exists()]
    is_whole = True
    print(f"{'end':16} {'bytes':>6} {'blocks/s':>9} {'ratio':>6} {'p50 ms':>8} {'p99 ms':>8} "
          f"{'cpu ms/MB':>8}")  # fmt: skip
    for block_bytes in BYTES:
        counts = {end: blocks_for(options.bin, end, block_bytes, options.seconds) for end in ends}
        seen = {end: [] for end in ends}
        for _ in range(options.rounds):
            for end in ends:
                seen[end].append(measure(options.bin, end, block_bytes, counts[end]))
        rates = {}
        for end in ends:
            print(row(end, block_bytes, seen[end], rates), flush=True)
            lost = sum(not one["is_whole"] for one in seen[end])
            if lost:
                print(f"{end}: {lost} of {options.rounds} rounds lost blocks")
            is_whole = is_whole and (lost == 0 or end == ALONE[end])
    print("every block of ours has arrived" if is_whole else "BLOCKS WERE LOST")
    return 0 if is_whole else 1


if __name__ == "__main__":
    sys.exit(main())
