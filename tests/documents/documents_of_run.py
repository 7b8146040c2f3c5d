"""A run of the demo with its recording and its entry in a store, and what makes and verifies
documents of copies of it: for tests of forgers."""

import datetime
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

import stored_run

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import reserve_dds_domain  # noqa: E402

DYNCAL = sys.argv[1]
SEED = 37


def dyncal(*arguments):
    return subprocess.run([DYNCAL, *map(str, arguments)], capture_output=True, text=True)


def day(offset):
    today = datetime.datetime.now(datetime.timezone.utc).date()
    return (today + datetime.timedelta(days=offset)).isoformat()


class DocumentsOfRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-documents-of-run-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.domain, cls.held = reserve_dds_domain()
        cls.runs, cls.others = cls.folder / "runs", cls.folder / "others"
        cls.run_folder = cls.measure(cls.runs, 1)
        cls.other_run = cls.measure(cls.others, 2)
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "30", "-subj",
             "/CN=Calibration", "-addext", "keyUsage=critical,digitalSignature", "-keyout",
             cls.folder / "lab.key", "-out", cls.folder / "lab.pem"],
            check=True, capture_output=True)  # fmt: skip
        cls.lab = cls.laboratory("lab", issued=day(-100), valid_until=day(500))

    @classmethod
    def measure(cls, runs, seed):
        environment = dict(os.environ, DYNCAL_DOMAIN=str(cls.domain))
        made = subprocess.run(
            [DYNCAL, "demo", "--seed", str(seed), "--repetitions", "1", "--duration", "0.5",
             "--speed", "max", "--folder", runs, "--output", cls.folder / f"demo-{seed}"],
            capture_output=True, text=True, env=environment)  # fmt: skip
        if made.returncode != 0:
            raise RuntimeError(made.stdout + made.stderr)
        return next(path.parent for path in runs.glob("*/*/result.json"))

    @classmethod
    def laboratory(cls, name, **keys):
        text = stored_run.LAB.read_text()
        begin, rest = text.split("issued = ", 1)
        after = rest.split("\n", 2)[2]
        lines = "".join(f'{key} = {value}\n' for key, value in keys.items())
        file = cls.folder / f"{name}.toml"
        logo = "laboratory-logo.svg"
        file.write_text((begin + lines + after).replace(logo, str(stored_run.LAB_FOLDER / logo)))
        return file

    @classmethod
    def sensor(cls, name, *changes):
        text = stored_run.SENSOR.read_text().replace("2026-02-20", day(0))
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        file = cls.folder / f"{name}.toml"
        file.write_text(text)
        return file

    def copy(self, name, store=True):
        """A run folder of its own, with its entry in a store of its own."""
        root = self.folder / name
        run = root / self.run_folder.relative_to(self.runs)
        shutil.copytree(self.run_folder, run)
        if store:
            shutil.copy(self.runs / "dyncal.sqlite", root)
        return run

    def edited(self, name, edit, store):
        run = self.copy(name, store)
        result = json.loads((run / "result.json").read_text())
        before = json.dumps(result)
        edit(result, random.Random(f"{SEED} {name}"))
        self.assertNotEqual(json.dumps(result), before, name)
        (run / "result.json").write_text(json.dumps(result))
        return run

    def certify(self, run, *options, lab=None, sensor=None):
        output = self.folder / f"{random.getrandbits(64):x}.xml"
        made = dyncal("certify", run, "--lab", lab or self.lab, "--sensor",
                      sensor or self.sensor("sensor"), "--output", output, "--key",
                      self.folder / "lab.key", "--certificate", self.folder / "lab.pem",
                      *options)  # fmt: skip
        return made, output

    def issue(self, run, *options, lab=None, sensor=None):
        output = self.folder / f"{random.getrandbits(64):x}"
        made = dyncal("report", run, "--lab", lab or self.lab, "--sensor",
                      sensor or self.sensor("sensor"), "--output", output, "--issue",
                      *options)  # fmt: skip
        return made, output.with_suffix(".pdf")

    def verify(self, file, *options):
        return dyncal("verify", file, "--trust", self.folder / "lab.pem", *options)

    def assert_refused(self, reason, made_and_file):
        made, file = made_and_file
        self.assertNotEqual(made.returncode, 0, reason)
        self.assertIn(reason, made.stderr)
        self.assertFalse(file.exists())
