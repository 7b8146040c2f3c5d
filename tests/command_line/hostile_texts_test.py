#!/usr/bin/env python3
"""Texts of files that others wrote reach a terminal as short lines without control characters, or
are refused in one line: results, recorded series, certificates, recordings, laboratory and sensor
files. Reports and certificates hold them as text, without control characters. Arguments: programs'
folder, source, seed."""

import copy
import json
import math
import pathlib
import random
import re
import sys
import tempfile
import xml.etree.ElementTree

from programs import SOURCE, expect, run

SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 32
DRAWS = 12
SCRIPT = "<script>alert(1)</script>"
MAX_LINE = 2000
HOSTILE = (
    "\x1b[2J\x1b]0;forged\x07",
    "step 1\ndyncal: forged line",
    "over\rwritten",
    "\x9b31m\u0085next",
    "\u202egnippilf \u2066\u2028",
    "n" * 100_000,
    "\x00\x01\x7f",
    "%s%n{}{0}",
    "../../../etc/passwd",
    f"{SCRIPT}\"'>&amp;<!-- ]]>",
)
BENCH = """bench = "hostile"
[excitation]
frequencies_hz = ["40"]
level = 1.0
settling_s = 0.2
duration_s = 1.0
[sources.acs]
driver = "file"
path = "record.csv"
units = { reference = "m/s^2", dut = "V" }
[method]
kind = "analogue"
reference = "acs/reference"
dut = ["acs/dut"]
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1e-3
"""


def record(header="t_ns,reference,dut"):
    lines = [header]
    for sample in range(4000):
        sine = math.sin(2.0 * math.pi * 40.0 * sample / 1000.0) if 500 <= sample < 3500 else 0.0
        lines.append(f"{sample * 1_000_000},{sine:.6f},{0.1 * sine:.6f}")
    return "\n".join(lines) + "\n"


def is_control(letter):
    code = ord(letter)
    is_direction = 0x2028 <= code <= 0x202E or 0x2066 <= code <= 0x2069
    return (code < 0x20 and letter != "\n") or 0x7F <= code < 0xA0 or is_direction


def expect_harmless(command, done):
    what = f"dyncal {' '.join(map(str, command))[:300]} (seed {SEED})"
    found = command[0] in ("check", "recording", "verify")  # 3: that something is wrong
    expect(done.returncode in (0, 1, 2, 3)[: 4 if found else 3], f"{what}: {done.returncode}")
    for line in (done.stdout + done.stderr).split("\n"):
        expect(not any(map(is_control, line)), f"{what}: prints {line[:200]!r}")
        expect(len(line) <= MAX_LINE, f"{what}: a line of {len(line)} characters: {line[:200]!r}")
    if done.returncode not in (0, 3):
        lines = done.stderr.strip().split("\n")
        expect(lines[-1].startswith("dyncal: "), f"{what}: fails with {done.stderr[-300:]!r}")
    forged = [line for line in done.stderr.split("\n") if line.startswith("dyncal: forged")]
    expect(not forged, f"{what}: a forged line")


def places_of(value, place=()):
    """Of all texts in a JSON value."""
    if isinstance(value, str):
        yield place
    elif isinstance(value, (dict, list)):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places_of(part, (*place, key))


def with_hostile_text(result, place, draw):
    changed = copy.deepcopy(result)
    part = changed
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = draw.choice(HOSTILE)
    return changed


def try_commands(folder, commands):
    """How many went well; each is harmless."""
    well = 0
    for command in commands:
        done = run("dyncal", *command, cwd=folder)
        expect_harmless(command, done)
        well += done.returncode == 0
    return well


def hostile_results(folder, draw):
    made = run("dyncal", "analyse", "bench.toml", "--output", "result.json", cwd=folder)
    expect((folder / "result.json").exists(), f"no result: {made.stderr}")
    result = json.loads((folder / "result.json").read_text("utf-8"))
    places = sorted(places_of(result), key=str)
    expect(len(places) > 10, f"few texts in a result: {places}")
    well = 0
    for number in range(DRAWS):
        changed = result
        for place in draw.sample(places, draw.randint(1, 4)):
            changed = with_hostile_text(changed, place, draw)
        (folder / "hostile.json").write_text(json.dumps(changed), "utf-8")
        store = f"store{number}.sqlite"
        well += try_commands(folder, (
            ("compare", "result.json", "hostile.json"),
            ("model", "hostile.json", "--include-flagged"),
            ("triaxial", "--x", "hostile.json", "--y", "hostile.json", "--z", "result.json",
             "--channels", *3 * ["acs/dut"]),
            ("store", "add", "hostile.json", "--store", store),
            ("runs", "--store", store),
            ("history", "acs", "--store", store),
        ))
    expect(well > 0, "every hostile result was refused: nothing was printed")
    return well


def as_toml(text):
    return '"' + "".join(f"\\u{ord(one):04x}" for one in text) + '"'


def with_hostile_values(toml, draw, most):
    """Some of its quoted values are other ones, a picture's path too."""
    values = list(re.finditer(r'"[^"\n]*"', toml))
    for value in sorted(draw.sample(values, draw.randint(0, most)), key=re.Match.start,
                        reverse=True):
        toml = toml[: value.start()] + as_toml(draw.choice(HOSTILE)) + toml[value.end() :]
    return toml


def expect_harmless_document(file):
    text = file.read_text("utf-8")
    what = f"{file.name} (seed {SEED})"
    bad = {one for one in text if is_control(one) and one != "\t"}
    expect(not bad, f"{what}: has the control characters {bad}")
    expect("<script>alert" not in text, f"{what}: has the script")
    expect("root:x:" not in text, f"{what}: holds another file")
    if file.suffix == ".xml":
        xml.etree.ElementTree.fromstring(text)


def hostile_documents(folder, draw):
    result = json.loads((folder / "result.json").read_text("utf-8"))
    places = sorted(places_of(result), key=str)
    documents = SOURCE / "deploy/example-lab/documents"
    (folder / "laboratory-logo.svg").write_bytes((documents / "laboratory-logo.svg").read_bytes())
    files = ("--lab", "laboratory.toml", "--sensor", "sensor.toml")
    written = []
    for number in range(2 * DRAWS):
        changed = result
        for place in draw.sample(places, draw.randint(0, 3)):
            changed = with_hostile_text(changed, place, draw)
        (folder / "hostile.json").write_text(json.dumps(changed), "utf-8")
        for name, most in (("laboratory.toml", 3), ("sensor.toml", 2)):
            toml = (documents / name).read_text("utf-8")
            (folder / name).write_text(with_hostile_values(toml, draw, most), "utf-8")
        report, certificate = f"report{number}", f"certificate{number}.xml"
        pdf = () if number == 0 else ("--no-pdf",)
        try_commands(folder, (
            ("report", "hostile.json", *files, *pdf, "--output", report),
            ("certify", "hostile.json", *files, "--force", "--performed", "2026-11-26",
             "--output", certificate),
        ))
        written += [folder / f"{report}.html", folder / certificate]
    written = [file for file in written if file.exists()]
    for kind in (".html", ".xml"):
        expect(any(file.suffix == kind for file in written), f"no {kind} was written")
    for file in written:
        expect_harmless_document(file)
    return len(written)


def hostile_files(folder, draw):
    for text in HOSTILE:
        names = f"t_ns,{text.replace(',', ' ')},dut"
        (folder / "series.csv").write_text(record(names), "utf-8", "surrogatepass", "\n")
        (folder / "noise.mcap").write_text(text * 3, "utf-8")
        certificate = f'<?xml version="1.0"?>\n<a b="{text[:500]}">{text}'
        (folder / "dcc.xml").write_text(certificate, "utf-8")
        try_commands(folder, (
            ("intervals", "series.csv"),
            ("fit", "series.csv", "--frequency", "40"),
            ("verify", "dcc.xml"),
            ("recording", "info", "noise.mcap"),
            ("recording", "check", "noise.mcap"),
            ("replay", "noise.mcap"),
            ("export", "noise.mcap"),
            ("analyse", "noise.mcap"),
        ))
    # With them as names of files that are not there; no name holds a zero byte.
    for text in [text for text in HOSTILE if "\0" not in text and len(text) < 1000]:
        for command in ("compare", "model", "report", "verify", "fit", "intervals", "analyse"):
            arguments = (text, text) if command == "compare" else (text,)
            done = run("dyncal", command, *arguments, cwd=folder)
            expect(done.returncode != 0, f"dyncal {command} {text!r}: goes well")
            expect_harmless((command, repr(text)), done)


def main():
    draw = random.Random(SEED)
    with tempfile.TemporaryDirectory(prefix="dyncal-hostile-") as name:
        folder = pathlib.Path(name)
        (folder / "bench.toml").write_text(BENCH, "utf-8")
        (folder / "record.csv").write_text(record(), "utf-8")
        well = hostile_results(folder, draw)
        written = hostile_documents(folder, draw)
        hostile_files(folder, draw)
    print(f"harmless; {well} commands went well with hostile results, {written} documents written")


if __name__ == "__main__":
    main()
