#!/usr/bin/env python3
"""Wrong result files: every command that reads results refuses the same file with the same
sentence, which names the file and the key, and takes what a later version may have added.

    wrong_results_test.py DYNCAL EXAMPLE_WRITER
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]
SCHEMA = stored_run.TOP / "services/views/report/result.schema.json"
GOOD = stored_run.clean_run(EXAMPLE)


def expect(condition, sentence):
    if not condition:
        sys.exit(sentence)


def put(*place, value):
    """Changes one place of a result."""

    def change(result):
        for part in place[:-1]:
            result = result[part]
        result[place[-1]] = value

    return change


def drop(*place):
    def change(result):
        for part in place[:-1]:
            result = result[part]
        del result[place[-1]]

    return change


VALUE, POINT = ("transfer_function", 3), ("points", 5)
ROW = (*POINT, "budget", 0)
# What is wrong, and what the sentence must have. A change of a result, or the text of a file.
WRONG = {
    "text for a magnitude": (put(*VALUE, "magnitude", value="0.5"), "[3].magnitude is a text"),
    "text for U": (put(*VALUE, "U_magnitude", value="nan"), "[3].U_magnitude is a text"),
    "truth for u": (put(*VALUE, "u_phase_rad", value=True), "[3].u_phase_rad is true or false"),
    "list for a phase": (put(*VALUE, "phase_rad", value=[1.0]), "[3].phase_rad is a list"),
    "no transfer function": (put("transfer_function", value=[]), "transfer_function is empty"),
    "object for a list": (put("transfer_function", value={}), "transfer_function is an object"),
    "number for a value": (put(*VALUE, value=7), "transfer_function[3] is 7, not an object"),
    "transfer function missing": (drop("transfer_function"), "transfer_function is missing"),
    "points missing": (drop("points"), "points is missing"),
    "U missing": (drop(*VALUE, "U_phase_rad"), "[3].U_phase_rad is missing"),
    "U of a point missing": (drop(*POINT, "U_magnitude"), "points[5].U_magnitude is missing"),
    "reason missing": (put(*POINT, "valid", value=False), "points[5].problem is missing"),
    "text for truth": (put(*POINT, "valid", value="yes"), "points[5].valid is a text"),
    "another schema": (put("schema", "name", value="something-else"), '"something-else"'),
    "a later version": (put("schema", "version", value=99), "version 99"),
    "version as text": (put("schema", "version", value="1"), 'version "1"'),
    "no schema": (drop("schema"), "no 'schema'"),
    "schema as text": (put("schema", value="dyncal-result"), "no 'schema'"),
    "distribution": (put(*ROW, "distribution", value="bell"), 'distribution is "bell"'),
    "kind": (put(*ROW, "kind", value="luck"), 'kind is "luck"'),
    "kind as a text": (put(*ROW, "kind", value="noise of"), 'kind is "noise of"'),
    "repeats": (put(*ROW, "repeats", value="now and then"), 'repeats is "now and then"'),
    "method": (put("method", value="by-eye"), 'method is "by-eye"'),
    "kind of a source": (put("sources", 0, "kind", value="radio"), 'sources[0].kind is "radio"'),
    "time base": (put("sources", 0, "time_base", value="lunar"), 'time_base is "lunar"'),
    "channel": (put(*VALUE, "channel", value="nowhere"), '[3].channel is "nowhere"'),
    "certain coverage": (put(*VALUE, "coverage_probability", value=1), "must be below 1"),
    "no coverage": (put(*VALUE, "coverage_probability", value=0), "must be above 0"),
    "negative count": (put(*POINT, "lost", value=-1), "points[5].lost is -1"),
    "half a count": (put(*VALUE, "repetitions", value=1.5), "[3].repetitions is 1.5"),
    "huge count": (put("planned_steps", value=1e300), "planned_steps is 1e+300"),
    "count beyond 64 bits": (put("planned_steps", value=2**70), "planned_steps is 1.18"),
    "text for a count": (put("sample_clock", 0, "count", value="9"), "[0].count is a text"),
    "flag as number": (put(*VALUE, "flag_names", value=[1]), "[3].flag_names[0] is 1"),
    "flag of capitals": (put(*VALUE, "flag_names", value=["Over Range"]), '"Over Range"'),
    "no frequency": (put(*VALUE, "frequency_hz", value=None), "[3].frequency_hz is null"),
    "frequency 0": (put(*VALUE, "frequency_hz", value=0), "[3].frequency_hz is 0"),
    "a day": (put("began_utc", value="yesterday"), 'began_utc is "yesterday"'),
    "a long text": (put("began_utc", value="2" * 10**6), "began_utc is too long a text"),
    "covariance": (put(*POINT, "fit", "covariance", value=[0.0] * 5), "has 5 entries, not 6"),
    "NaN": (put(*VALUE, "magnitude", value=float("nan")), "not JSON"),
    "infinity": (put(*VALUE, "magnitude", value=float("inf")), "not JSON"),
    "beyond a double": (json.dumps(GOOD).replace('e": 0.', 'e": 1e999', 1), "not JSON"),
    "cut": (json.dumps(GOOD)[:-200], "not JSON"),
    "empty": ("", "not JSON"),
    "a list": ("[1, 2]", "no 'schema'"),
    "deep": ("[" * 10**5, "not JSON"),
    "not UTF-8": (b'{"bench": "Br\xfcel"}', "not JSON"),
}  # fmt: skip
# Of these the schema alone, by another implementation of it, finds nothing wrong.
BEYOND_THE_SCHEMA = {"no transfer function", "a long text"}


def write(path, change):
    if callable(change):
        result = copy.deepcopy(GOOD)
        change(result)
        change = json.dumps(result)
    path.write_bytes(change if isinstance(change, bytes) else change.encode())
    return path


def commands(folder, file):
    """All that read a result, by name."""
    good = folder / "good.json"
    store = folder / "store.sqlite"
    return {
        "compare": ["compare", file, good],
        "compare, second": ["compare", good, file],
        "triaxial": ["triaxial", "--z", file, "--channels", *[min(stored_run.CHANNELS)] * 3],
        "model": ["model", file],
        "report": ["report", file, "--no-pdf", "--output", folder / "report"],
        "certify": ["certify", file, "--lab", stored_run.LAB, "--sensor", stored_run.SENSOR,
                    "--output", folder / "certificate.xml"],
        "verify": ["verify", folder / "signed.xml", "--run", file],
        "store": ["store", "add", file, "--store", store],
    }  # fmt: skip


def run(arguments):
    return subprocess.run(
        [DYNCAL, *map(str, arguments)], capture_output=True, text=True, errors="replace", timeout=60
    )


def has_certificates(folder):
    done = run(["verify", folder / "good.json"])
    return "libxml2" not in done.stderr and "xmlsec" not in done.stderr


def of_version_1(result):
    """As version 1 of the schema had it."""
    old = copy.deepcopy(result)
    old["schema"]["version"] = 1
    old["flags"] = old.pop("flag_legend")
    for clock in old["sample_clock"]:
        clock["event_list"] = clock.pop("events")
        clock["events"] = clock.pop("event_count")
    for point in old["points"]:
        for row in point["budget"]:
            names = {"fit_noise": "noise of", "reference": "reference"}
            row["kind"] = names.get(row["kind"], row["name"])
    return old


def check_version_1(folder):
    """It gives the same fit and the same report."""
    old = write(folder / "old.json", json.dumps(of_version_1(GOOD)))
    for arguments in (["compare", old, folder / "good.json", "--json"],
                      ["report", old, "--no-pdf", "--output", folder / "old"]):  # fmt: skip
        done = run(arguments)
        expect(done.returncode == 0, f"version 1: {arguments[0]}: {done.stderr}")
        if arguments[0] == "compare":
            points = json.loads(done.stdout)["points"]
            expect(len(points) == len(GOOD["transfer_function"]), "version 1: values are missing")
            expect(all(p["magnitude_difference"] == 0 for p in points), "version 1: other values")
    report = (folder / "old.html").read_text()
    expect("sensor under calibration, noise" in report, "version 1: no budget")


def check_good(folder, names):
    """Beside it, what a later version may add is ignored by all."""
    later = copy.deepcopy(GOOD)
    for one in (later, later["schema"], later["points"][0], later["transfer_function"][0],
                later["sources"][0], later["points"][0]["budget"][0]):  # fmt: skip
        one["of_a_later_version"] = {"any": ["thing", 1e300]}
    later["transfer_function"][0]["flag_names"] = []
    for file in (write(folder / "good.json", json.dumps(GOOD)),
                 write(folder / "later.json", json.dumps(later))):  # fmt: skip
        for name in names - {"verify", "certify", "model"}:  # which need more than a good result
            done = run(commands(folder, file)[name])
            expect(done.returncode == 0, f"{name} refuses {file.name}: {done.stderr}")
            for written in ("store.sqlite", "report.html"):
                (folder / written).unlink(missing_ok=True)


def check_refusal(folder, names, what, change, words):
    file = write(folder / "wrong.json", change)
    sentences = {}
    for name in sorted(names):
        done = run(commands(folder, file)[name])
        expect(done.returncode == 1, f"{what}: {name} ends with {done.returncode}: {done.stderr}")
        sentences[name] = done.stderr.strip().rsplit("\n", 1)[-1]
    first = sentences["report"]
    expect(len(set(sentences.values())) == 1, f"{what}: {json.dumps(sentences, indent=1)}")
    expect(str(file) in first and words in first, f"{what}: {first}")
    for written in ("report.html", "certificate.xml"):
        expect(not (folder / written).exists(), f"{what}: {written} was written")
    runs = run(["runs", "--store", folder / "store.sqlite", "--json"])
    expect('"run"' not in runs.stdout, f"{what}: the store has it")


def check_against_another_validator(what, change):
    try:
        from jsonschema import Draft202012Validator
    except ImportError:
        return 0
    if not callable(change) or what in BEYOND_THE_SCHEMA or what in ("NaN", "infinity"):
        return 0
    result = copy.deepcopy(GOOD)
    change(result)
    validator = Draft202012Validator(json.loads(SCHEMA.read_text()))
    expect(not validator.is_valid(result), f"{what}: another validator takes it")
    return 1


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write(folder / "good.json", json.dumps(GOOD))
        names = set(commands(folder, folder / "x"))
        if not has_certificates(folder):
            names -= {"certify", "verify"}
        # Which certificate it is does not matter: the run is read first.
        (folder / "signed.xml").write_text("<dcc/>")
        check_good(folder, names)
        check_version_1(folder)
        others = 0
        for what, (change, words) in WRONG.items():
            check_refusal(folder, names, what, change, words)
            others += check_against_another_validator(what, change)
        expect(len(WRONG) >= 30, "fewer than 30 wrong files")
        print(f"{len(WRONG)} wrong files, each refused by {len(names)} commands with one sentence; "
              f"{others} of them also by another validator")  # fmt: skip


if __name__ == "__main__":
    main()
