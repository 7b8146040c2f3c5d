#!/usr/bin/env python3
"""dyncal check and new-bench: a bench file of every kind that new-bench writes passes check, a file
that is there stays as it is, and the examples pass."""

import itertools
import json
import pathlib
import re
import tempfile

from programs import SOURCE, expect, run

SENSORS = ["smartup", "file", "can", "series", "analogue"]
ACS = ["socket", "file"]
GENERATORS = ["scpi", "by-hand", "none"]


def succeed(*arguments, **more):
    done = run("dyncal", *arguments, **more)
    expect(done.returncode == 0, f"{arguments}: {done.stdout}{done.stderr}")
    return done.stdout


def refuse(status, part, *arguments, **more):
    done = run("dyncal", *arguments, **more)
    expect(done.returncode == status, f"{arguments}: {done.returncode} {done.stdout}{done.stderr}")
    expect(part in done.stdout + done.stderr, f"{arguments}: {done.stdout}{done.stderr}")


def write_records(folder):
    rows = range(200)
    (folder / "acs.csv").write_text(
        "t_ns,reference,sync,sensor\n" + "".join(f"{i * 100000},1,2,3\n" for i in rows)
    )
    (folder / "dau.csv").write_text(
        "t_ns,acceleration_z,sync\n" + "".join(f"{i * 1000000},1,2\n" for i in rows)
    )


def check_combinations(folder):
    write_records(folder)
    for sensor, acs, generator in itertools.product(SENSORS, ACS, GENERATORS):
        name = f"{sensor}-{acs}-{generator}"
        options = ["--name", name, "--sensor", sensor, "--acs", acs, "--generator", generator]
        options += ["--sensor-file", "dau.csv"] if sensor == "file" else []
        options += ["--acs-file", "acs.csv"] if acs == "file" else []
        succeed("new-bench", *options, cwd=folder)
        found = json.loads(succeed("check", f"{name}.toml", "--json", cwd=folder))
        # What only the user can know is left to him; nothing else is doubted.
        doubts = [one["key"] for one in found["findings"] if one["severity"] != "note"]
        unknown = ("uncertainty.", "corrections.dso_delay")
        expect(doubts and all(key.startswith(unknown) for key in doubts), f"{name}: {found}")
        expect("reference_magnitude_rel" in " ".join(doubts), f"{name}: {found}")
        before = (folder / f"{name}.toml").read_bytes()
        refuse(1, "is there already", "new-bench", *options, cwd=folder)
        expect((folder / f"{name}.toml").read_bytes() == before, f"{name}.toml has changed")


def check_multisine(folder):
    write_records(folder)
    files = ["--sensor", "file", "--sensor-file", "dau.csv", "--acs", "file", "--acs-file"]
    files += ["acs.csv", "--generator", "none"]
    wishes = ["--frequencies", "third-octave 10..250"]
    succeed("new-bench", "--name", "lines", "--multisine", "10", *wishes, *files, cwd=folder)
    text = (folder / "lines.toml").read_text()
    lines = re.search(r"frequencies_hz = \[(.*)\]", text)[1].replace('"', "").split(", ")
    expect(len(lines) == 15, text)
    tenths = [round(10 * float(line)) for line in lines]
    expect(all(line % 2 == 1 for line in tenths), text)
    found = succeed("check", "lines.toml", cwd=folder)
    expect("multi-sines of 15 lines" in found, found)
    (folder / "collide.toml").write_text(text.replace(f'"{lines[1]}"', f'"{3 * tenths[0] / 10}"'))
    refuse(3, f"3 times {lines[0]} Hz", "check", "collide.toml", cwd=folder)
    refuse(1, f"3 times {lines[0]} Hz", "analyse", "collide.toml", cwd=folder)
    refuse(2, "--sensor file", "new-bench", "--name", "x", "--multisine", "10", cwd=folder)
    dense = ["--frequencies", "10,10.1,10.2,10.3"]
    near = ["--name", "x", "--multisine", "10", *dense, *files]
    refuse(2, "no line", "new-bench", *near, cwd=folder)


# Values that the check refuses, by option; further options that make them count.
REFUSED = [
    (["--name", "a b"], []),
    (["--frequencies", "10,ten"], []),
    (["--level", "100"], []),
    (["--listen", "nowhere"], []),
    (["--sensor-id", "0x"], []),
    (["--sensor-file", "gone.csv"], ["--sensor", "file"]),
    (["--channel", "none"], ["--sensor", "file", "--sensor-file", "dau.csv"]),
    (["--sensor-sync", "none"], ["--sensor", "file", "--sensor-file", "dau.csv"]),
    (["--sensor-address", "no port"], ["--sensor", "series"]),
    (["--dso-address", "no port"], ["--sensor", "series"]),
    (["--interface", ""], ["--sensor", "can"]),
    (["--dbc", "gone.dbc"], ["--sensor", "can"]),
    (["--acs-address", "no port"], []),
    (["--acs-file", "gone.csv"], ["--acs", "file"]),
    (["--reference", "sync"], ["--acs", "file", "--acs-file", "acs.csv"]),
    (["--channel", "sync"], ["--sensor", "file", "--sensor-file", "dau.csv"]),
    (["--channel", "reference"], ["--sensor", "analogue"]),
    (["--level", "-1"], []),
    (["--reference", "none"], ["--acs", "file", "--acs-file", "acs.csv"]),
    (["--sync", "none"], ["--acs", "file", "--acs-file", "acs.csv"]),
    (["--generator-address", "no port"], []),
    (["--maximum-voltage", "0.5"], []),
]


def check_refusals(folder):
    """What is said of an option's value names the option."""
    before = sorted(folder.iterdir())
    for given, others in REFUSED:
        name = [] if given[0] == "--name" else ["--name", "x"]
        done = run("dyncal", "new-bench", *name, *given, *others, cwd=folder)
        expect(done.returncode in (1, 2), f"{given}: {done.returncode} {done.stdout}")
        expect(re.search(rf"{given[0]}[ :)]", done.stderr), f"{given}: {done.stderr}")
        expect("key '" not in done.stderr and len(done.stderr) < 400, done.stderr)
    done = run("dyncal", "new-bench", "--name", "short", "--duration", "0.1", cwd=folder)
    expect("--duration (duration_s) = 0.1 evaluates" in done.stderr, done.stderr)
    (folder / "short.toml").unlink()
    expect(sorted(folder.iterdir()) == before, "something was written")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_combinations(folder)
        check_multisine(folder)
        check_refusals(folder)
        refuse(2, "--name is missing", "new-bench", cwd=folder, input="")
        refuse(2, "nothing was written", "new-bench", "--name", "a b", cwd=folder)
        refuse(2, "--acs-file", "new-bench", "--name", "x", "--acs", "file", cwd=folder)
        left = {path.name for path in folder.iterdir() if path.suffix not in (".toml", ".dbc")}
        expect(left == {"acs.csv", "dau.csv"}, f"{left} was left")

        (folder / "bad.toml").write_text(
            (folder / "smartup-socket-scpi.toml").read_text().replace("level =", "levl =")
        )
        refuse(3, "did you mean 'level'?", "check", "bad.toml", cwd=folder)
        refuse(3, "cannot read this bench file", "check", "gone.toml", cwd=folder)
    examples = sorted((SOURCE / "deploy/example-lab").glob("*.toml"))
    expect(len(examples) >= 4, f"only {examples}")
    for example in examples:
        succeed("check", example)
    print(succeed("check", *examples).splitlines()[-1])


main()
