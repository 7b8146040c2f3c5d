#!/usr/bin/env python3
"""Holds includes, room sizes and READMEs of analysis/, drivers/ and services/ against the plan
below. A room is a folder.

    rooms.py arrows      what includes what
    rooms.py namespaces  a namespace a wing of services/
    rooms.py sizes       no room outgrows its tree
    rooms.py readmes     every room opens with a README
"""

import collections
import re
import sys

from tree import CODE, TOP, conclude, tracked

# Rooms of each tree from the lowest floor up; "." is the tree's own folder. A room includes itself
# and rooms of lower floors of its tree, never one of its own floor: so there is no circle. Those of
# services/ are wings, and the same holds for the rooms of a wing.
FLOORS = {
    "analysis": [
        ["base"],
        ["interferometer/kernel", "sine/kernel"],
        ["sine"],
        ["uncertainty"],
        ["interferometer", "response", "step"],
        ["clock"],
        ["instrument"],
        ["method"],
        ["."],
    ],
    "drivers": [
        ["."],
        ["files/tdms", "link"],
        ["can/bus", "files"],
        ["can/dbc", "can/time"],
        [
            "acs", "alsa", "can", "dso", "generator", "interferometer", "pps", "smartup",
            "tss", "virtual_bench/model",
        ],
        ["virtual_bench/can", "virtual_bench/wire"],
        ["virtual_bench"],
    ],
    "services": [
        ["base"],
        ["contract"],
        ["bench", "bus", "evaluation"],
        ["security"],
        ["daemon"],
        ["network", "stream"],
        ["instruments", "views"],
        ["records", "run"],
        ["checks"],
        ["programs"],
    ],
}
# Rooms of the wings that have several, from the lowest floor up; "." is the wing's own folder.
WINGS = {
    "bench": [["draft", "file"]],
    "bus": [["."], ["cyclonedds", "fastdds/screen", "host_clocks", "memory"], ["fastdds"]],
    "checks": [["bench_check", "doctor"]],
    "daemon": [["supervision"], ["program"]],
    "evaluation": [["recipe"], ["record", "result"], ["closures", "method"], ["."]],
    "programs": [
        [
            "acs", "analysis", "can", "dau", "demo", "dso", "guard", "recorder", "virtual_bench",
            "web",
        ],
        ["command"],
    ],
    "records": [
        ["mcap", "run_folder", "store"],
        ["capture"],
        ["replay"],
        ["exchange"],
        ["provenance"],
    ],
    "views": [
        ["language"],
        ["figures", "signals"],
        ["report"],
        ["lab_file", "live", "model"],
        ["objections", "spreadsheet"],
        ["conformity", "linearity"],
        ["certificate", "document"],
    ],
}
# What a tree may include of others: rooms, or a whole tree.
BETWEEN_TREES = {
    "analysis": [],
    "drivers": ["analysis/base"],
    "services": ["analysis", "drivers", "idl"],
}
# Rooms that may include more of other trees than theirs does.
MORE_OF_OTHERS = {
    "drivers/interferometer": ["analysis/interferometer"],
    "drivers/pps": ["analysis/clock"],
}
# Rooms that only some may include, on whichever floor.
ONLY_FROM = {
    "analysis/interferometer/kernel": ["analysis/interferometer"],
    "analysis/sine/kernel": ["analysis/sine"],
}
# Drivers know nothing of each other: "drivers/x/..." includes only itself and these. The virtual
# bench's CAN side is the other end of the wire that the CAN driver reads.
SHARED_DRIVERS = [".", "link", "files"]
OTHER_END = {"virtual_bench/can": "can"}
# DDS vendors and their encoders.
VENDOR = re.compile(r"(fastdds|fastrtps|fastcdr|dds|ddsc|idl/dyncalPubSub)(/|\b.*\.h)")
VENDOR_ROOM = "services/bus"
# Where a wing's file opens another namespace than its wing's.
OTHER_NAMESPACES = {
    "services/bus/host_clocks/": "host_clocks",
    "services/contract/topics.hpp": "bus",  # which is named by every writer and reader
}
NAMESPACE = re.compile(r"^namespace dyncal::(?:inline )?(\w+)[\w: ]* \{", re.M)
# Names what another wing declares, without its header.
FORWARD = re.compile(r"^namespace [\w: ]+ \{\n(?:(?:class|struct) \w+;\n)+\}\n", re.M)
# Rooms that may be more than this part of their tree.
LARGEST_PART = 0.20
LARGE_ROOMS = ["analysis/sine", "services/evaluation"]
# Lines of a README before its first "## " heading, under which protocols and reference stand.
README_LINES = 40


def files():
    return [path for path in tracked(*FLOORS) if path.suffix in CODE]


def room_in_tree(path):
    """Tree and room of a file's path."""
    tree, *folders = path.split("/")[:-1]
    room = "/".join(folders) or "."
    return tree, room


def number_of(floors, room):
    for number, rooms in enumerate(floors):
        if room in rooms:
            return number
    return None


def floor(tree, room):
    """Its floor, and that within its wing; None: it has none."""
    if tree != "services":
        wing, inner = room, None
    else:
        wing, _, inner = room.partition("/")
    outer = number_of(FLOORS[tree], wing)
    inner = number_of(WINGS.get(wing, [["."]]), inner or ".")
    return None if outer is None or inner is None else (outer, inner)


def runs_down(tree, source, target):
    (upper, upper_inner), (lower, lower_inner) = floor(tree, source), floor(tree, target)
    same_wing = tree == "services" and source.split("/")[0] == target.split("/")[0]
    return lower_inner < upper_inner if same_wing else lower < upper


def within(path, folder):
    return path == folder or path.startswith(folder + "/")


def refusal_in_tree(tree, source, target):
    if source == target:
        return None
    for room in (source, target):
        if floor(tree, room) is None:
            return f"{tree}/{room} has no floor in tests/style/rooms.py"
    if not runs_down(tree, source, target):
        return "the arrow does not run down"
    if tree == "drivers" and target not in SHARED_DRIVERS:
        family = source.split("/")[0]
        if target.split("/")[0] not in (family, OTHER_END.get(source)):
            return "drivers know nothing of each other"
    return None


def refusal(source, target):
    """Why one file may not include the other, or nothing."""
    source_tree, source_room = room_in_tree(source)
    target_tree, target_room = room_in_tree(target)
    for room, users in ONLY_FROM.items():
        if within(target, room) and not any(
            f"{source_tree}/{source_room}" in (user, room) for user in users
        ):
            return f"only {', '.join(users)} includes {room}"
    if target_tree == source_tree:
        return refusal_in_tree(source_tree, source_room, target_room)
    others = BETWEEN_TREES[source_tree] + MORE_OF_OTHERS.get(f"{source_tree}/{source_room}", [])
    if not any(within(target, allowed) for allowed in others):
        return f"{source_tree}/{source_room} includes nothing of {target_tree}/ but " + (
            ", ".join(others) or "itself"
        )
    return None


def check_arrows():
    findings = []
    arrows = 0
    for path in files():
        for number, line in enumerate((TOP / path).read_text().splitlines(), 1):
            include = re.match(r'\s*#\s*include\s+["<]([^">]+)[">]', line)
            if not include:
                continue
            target = include[1]
            if VENDOR.match(target) and not within(str(path), VENDOR_ROOM):
                findings.append(f"{path}:{number}: {target}: only {VENDOR_ROOM} names a DDS vendor")
            if target.split("/")[0] not in (*FLOORS, "idl"):
                continue
            arrows += 1
            reason = refusal(str(path), target)
            if reason:
                findings.append(f"{path}:{number}: {target}: {reason}")
    if arrows < 100:
        sys.exit(f"only {arrows} includes found: the check would pass on nothing")
    conclude(findings, f"of {arrows} includes refused")


def lines_of_rooms():
    lines = collections.Counter()
    for path in files():
        lines[str(path.parent)] += len((TOP / path).read_text().splitlines())
    return lines


def check_namespaces():
    findings = []
    wings = {wing for floor_of_wings in FLOORS["services"] for wing in floor_of_wings}
    checked = 0
    for path in files():
        wing = str(path).split("/")[1]
        if path.parts[0] != "services" or path.name == "main.cpp" or path.suffix in (".c", ".h"):
            continue
        expected = {wing}
        expected |= {n for start, n in OTHER_NAMESPACES.items() if str(path).startswith(start)}
        text = FORWARD.sub("", (TOP / path).read_text())
        if all(line.startswith(("#", "//")) for line in filter(None, text.splitlines())):
            continue  # has nothing of its own
        checked += 1
        opened = set(NAMESPACE.findall(text))
        # That of the wire, and the bus's, hold what is specialised for a wing's own types.
        if not opened & expected or opened & wings - expected - {"bus"}:
            findings.append(f"{path}: opens {sorted(opened)}, not dyncal::{wing}")
    conclude(findings, f"of {checked} files in another namespace than their wing's")


def check_sizes():
    lines = lines_of_rooms()
    trees = collections.Counter()
    for room, count in lines.items():
        trees[room.split("/")[0]] += count
    findings = []
    for room, count in sorted(lines.items()):
        part = count / trees[room.split("/")[0]]
        if part > LARGEST_PART and room not in LARGE_ROOMS:
            findings.append(f"{room}: {count} lines, {part:.0%} of its tree")
    conclude(findings, f"of {len(lines)} rooms too large")


def check_readmes():
    rooms = {str(path.parent) for path in files()} | set(FLOORS)
    rooms |= {
        f"{tree}/{room.split('/')[0]}"
        for tree, floors in FLOORS.items()
        for rooms_of_floor in floors
        for room in rooms_of_floor
        if room != "." and (TOP / tree / room).is_dir()
    }
    findings = []
    for room in sorted(rooms):
        readme = TOP / room / "README.md"
        if not readme.is_file():
            findings.append(f"{room}: no README.md")
            continue
        lines = readme.read_text().splitlines()
        opening = next((i for i, line in enumerate(lines) if line.startswith("## ")), len(lines))
        if len(lines) > README_LINES < opening:
            findings.append(
                f"{room}/README.md: {opening} lines before the first '## ' heading; "
                f"at most {README_LINES}"
            )
    conclude(findings, f"of {len(rooms)} rooms without an opening page")


if __name__ == "__main__":
    checks = {
        "arrows": check_arrows,
        "namespaces": check_namespaces,
        "sizes": check_sizes,
        "readmes": check_readmes,
    }
    checks[sys.argv[1]]()
