#!/usr/bin/env python3
"""Certificates of thirteen kinds held against the rules that PTB publishes beside the schema: the
Schematron of dcclib, and the schema by the same library. dcclib comes from PyPI into an environment
of the test's own, which is kept in the build folder; without a network it is skipped.

    dcc_rules_test.py DYNCAL EXAMPLE_WRITER ENVIRONMENT
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import stored_run

DYNCAL, EXAMPLE, ENVIRONMENT = sys.argv[1:4]
SCHEMA = stored_run.TOP / "deploy/third-party/dcc/v3.3.0/dcc.xsd"
VERSION = "0.4.0"
JUDGE = """
import json, sys
from dcclib.validation.schematron import SchematronValidator
from dcclib.validation.xsd import XsdValidator
rules, schema = SchematronValidator.for_dcc(), XsdValidator.from_file(sys.argv[1])
for line in sys.stdin:
    found = rules.validate_file(line.strip())
    valid = schema.validate_file(line.strip())
    print(json.dumps({"rules": [f"{one.location}: {one.text}" for one in found.failed_assertions],
                      "reports": len(found.successful_reports),
                      "schema": [str(one) for one in valid.errors]}))
"""


def run(*command, **options):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, **options)


def judge_program():
    """The interpreter that has dcclib; None where it cannot be had."""
    python = pathlib.Path(ENVIRONMENT) / "bin/python3"
    has_it = f"import importlib.metadata as m; assert m.version('dcclib') == '{VERSION}'"
    if python.exists() and run(python, "-c", has_it).returncode == 0:
        return python
    shutil.rmtree(ENVIRONMENT, ignore_errors=True)
    if run("/usr/bin/python3", "-m", "venv", ENVIRONMENT).returncode != 0:
        return None
    made = run(python, "-m", "pip", "install", "--quiet", "--retries", "1", f"dcclib=={VERSION}")
    return python if made.returncode == 0 else None


def reference_standard(devices):
    return {
        "devices": devices,
        "standard": "ISO 16063-21",
        "traceability": "Traceable to the SI.",
        "file": "reference.toml",
        "file_sha256": "0" * 64,
    }


def device(name, **others):
    return {
        "name": name,
        "serial": "8001",
        "certificate": "NMI-26-0117",
        "issued_by": "NMI",
        "issued": "2026-02-03",
        "valid_until": "2028-02-03",
        **others,
    }


class Rules(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.python = judge_program()
        if cls.python is None:
            print(f"SKIPPED: dcclib {VERSION} cannot be had from PyPI (a network is needed once)")
            sys.exit(77)
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-dcc-rules-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.result = stored_run.clean_run(EXAMPLE)
        cls.lab = stored_run.LAB.read_text().replace(
            'logo = "', f'logo = "{stored_run.LAB_FOLDER}/'
        )
        key = run("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=lab",
                  "-addext", "keyUsage=critical,digitalSignature", "-keyout",
                  cls.folder / "lab.key", "-out", cls.folder / "lab.pem")  # fmt: skip
        if key.returncode != 0:
            raise RuntimeError(key.stderr)

    def certificate(self, name, change=None, lab="", sensor="", options=(), signed=True):
        """Path of a certificate: of the run changed by `change`, with texts put into the files."""
        result = json.loads(json.dumps(self.result))
        if change:
            change(result)
        run_folder = stored_run.write_run(self.folder / name / "bench" / "one", result)
        lab_file = self.folder / name / "lab.toml"
        lab_file.write_text(self.lab + lab)
        sensor_file = self.folder / name / "sensor.toml"
        sensor_file.write_text(sensor or stored_run.SENSOR.read_text())
        output = self.folder / f"{name}.xml"
        key = ["--key", self.folder / "lab.key", "--certificate", self.folder / "lab.pem"]
        made = run(DYNCAL, "certify", run_folder, "--lab", lab_file, "--sensor", sensor_file,
                   "--output", output, *(key if signed else []),
                   *stored_run.kept(DYNCAL, run_folder), *options)  # fmt: skip
        self.assertEqual(made.returncode, 0, f"{name}: {made.stderr}")
        return output

    def certificates(self):
        text = stored_run.SENSOR.read_text()
        one = "dau/acceleration_z"

        def with_reference(*devices):
            return lambda result: result["corrections"].update(
                reference_standard=reference_standard([*devices])
            )

        same = device("Laser vibrometer", serial="0815", certificate="NMI-17-0001")
        flag = {"flags": ["something was wrong"], "flag_names": ["level_off_plan"]}
        yield self.certificate("plain")
        yield self.certificate("unsigned", signed=False)
        yield self.certificate("one-channel", options=["--channel", one])
        yield self.certificate("reference", with_reference(same))
        yield self.certificate("amplifier", with_reference(same, device("Amplifier", model="CA-1")))
        yield self.certificate(
            "equipment",
            lab='[[equipment]]\nname = "DAU"\ncertificate = "D-1"\nissued_by = "NMI"\n'
            "issued = 2026-01-05\n",
        )
        yield self.certificate("firmware", sensor=text.replace("1.4.2", "rev. B of 2025"))
        yield self.certificate(
            "sensor-conditions",
            sensor=text + "[conditions]\ntemperature_degc = 21.5\nU_temperature_k = 0.4\n"
            "pressure_hpa = 1003\nU_pressure_hpa = 2\n",
        )
        yield self.certificate(
            "forced", lambda result: result["points"][0].update(flag), options=["--force"]
        )
        yield self.certificate("conformity", sensor=text + stored_run.TOLERANCES)
        yield self.certificate("number", options=["--number", "2026-0099/A"])
        yield self.certificate("german", options=["--language", "de"])
        yield self.certificate(
            "both-languages", sensor=text + stored_run.TOLERANCES, options=["--language", "de,en"]
        )

    def test_rules_and_schema_have_nothing_against_thirteen_kinds(self):
        files = [*self.certificates()]
        self.assertEqual(len(files), 13)
        judged = run(self.python, "-c", JUDGE, SCHEMA, input="\n".join(map(str, files)))
        self.assertEqual(judged.returncode, 0, judged.stderr)
        answers = [json.loads(line) for line in judged.stdout.splitlines()]
        self.assertEqual(len(answers), len(files))
        for file, answer in zip(files, answers):
            with self.subTest(file.name):
                self.assertEqual(answer["rules"], [])
                self.assertEqual(answer["schema"], [])
                self.assertGreater(answer["reports"], 0)  # the rules have looked

    def test_rules_find_what_is_wrong(self):
        text = self.certificate("broken-release").read_text()
        file = self.folder / "broken.xml"
        file.write_text(text.replace("<dcc:release>v", "<dcc:release>version "))
        judged = run(self.python, "-c", JUDGE, SCHEMA, input=str(file))
        self.assertGreater(len(json.loads(judged.stdout)["rules"]), 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
