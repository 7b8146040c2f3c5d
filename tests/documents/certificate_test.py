#!/usr/bin/env python3
"""Digital calibration certificates of stored runs: valid by an independent validator without a
network, refused where the run forbids them, and verified only as they were signed.

    certificate_test.py DYNCAL EXAMPLE_WRITER
"""

import base64
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import stored_run

DYNCAL, EXAMPLE = sys.argv[1:3]
SCHEMA = stored_run.TOP / "deploy/third-party/dcc/v3.3.0/dcc.xsd"
DCC = "{https://ptb.de/dcc}"
SI = "{https://ptb.de/si}"
READABLE, SCHEMA_STATUS, NOT_SIGNED, SIGNATURE, SIGNER, NUMBERS = 3, 4, 5, 6, 7, 8


def run(*command):
    return subprocess.run([*map(str, command)], capture_output=True, text=True)


def dyncal(*arguments):
    return run(DYNCAL, *arguments)


def openssl(*arguments):
    made = run("openssl", *arguments)
    if made.returncode != 0:
        raise RuntimeError(made.stderr)


def key_options(kind):
    if kind == "rsa":
        return ["-newkey", "rsa:2048"]
    return ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1"]


def make_ca(folder, name):
    openssl("req", "-x509", *key_options("rsa"), "-nodes", "-days", "30", "-subj", f"/CN={name}",
            "-addext", "keyUsage=critical,keyCertSign,cRLSign",
            "-keyout", folder / f"{name}.key", "-out", folder / f"{name}.pem")  # fmt: skip


def make_signer(folder, name, ca, kind, usage="digitalSignature,nonRepudiation"):
    openssl("req", *key_options(kind), "-nodes", "-subj", f"/O=Example Laboratory/CN={name}",
            "-keyout", folder / f"{name}.key", "-out", folder / f"{name}.csr")  # fmt: skip
    extensions = folder / f"{name}.ext"
    extensions.write_text(
        f"keyUsage=critical,{usage}\nbasicConstraints=critical,CA:false\n"
        "subjectKeyIdentifier=hash\nauthorityKeyIdentifier=keyid\n"
    )
    openssl("x509", "-req", "-in", folder / f"{name}.csr", "-CA", folder / f"{ca}.pem",
            "-CAkey", folder / f"{ca}.key", "-CAcreateserial", "-days", "20",
            "-extfile", extensions, "-out", folder / f"{name}.pem")  # fmt: skip


class Certificate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for program in ("xmllint", "openssl"):
            if shutil.which(program) is None:
                print(f"SKIPPED: {program} is not there (Debian: libxml2-utils, openssl)")
                sys.exit(77)
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-certificate-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        make_ca(cls.folder, "ca")
        make_ca(cls.folder, "other-ca")
        make_signer(cls.folder, "lab", "ca", "rsa")
        make_signer(cls.folder, "lab-ec", "ca", "ec")
        make_signer(cls.folder, "stranger", "other-ca", "rsa")
        make_signer(cls.folder, "server", "ca", "rsa", usage="keyEncipherment")
        cls.result = stored_run.clean_run(EXAMPLE)
        cls.run_folder = stored_run.write_run(cls.folder / "runs/bench/one", cls.result)
        cls.signed = cls.folder / "signed.xml"
        made = cls.certify(cls.run_folder, cls.signed, "lab")
        if made.returncode != 0:
            raise RuntimeError(made.stderr)

    @classmethod
    def certify(cls, run_folder, output, signer=None, *options):
        key = []
        if signer:
            key = ["--key", cls.folder / f"{signer}.key"]
            key += ["--certificate", cls.folder / f"{signer}.pem"]
        return dyncal("certify", run_folder, "--lab", stored_run.LAB, "--sensor",
                      stored_run.SENSOR, "--output", output, *key,
                      *stored_run.kept(DYNCAL, run_folder), *options)  # fmt: skip

    def verify(self, file, *options):
        run = options[options.index("--run") + 1] if "--run" in options else None
        store = stored_run.kept(DYNCAL, run) if run else []
        return dyncal("verify", file, "--trust", self.folder / "ca.pem", *store, *options)

    def assert_valid_by_xmllint(self, file):
        checked = run("xmllint", "--nonet", "--noout", "--schema", SCHEMA, file)
        self.assertEqual(checked.returncode, 0, checked.stderr)

    def new_run(self, name, change):
        result = json.loads(json.dumps(self.result))
        change(result)
        return stored_run.write_run(self.folder / "runs/bench" / name, result)

    # What is in it.

    def test_is_valid_and_verified(self):
        self.assert_valid_by_xmllint(self.signed)
        checked = self.verify(self.signed, "--run", self.run_folder)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        values = len(stored_run.FREQUENCIES) * len(stored_run.CHANNELS)
        self.assertIn(f"{6 * values} numbers of 2 channels", checked.stdout)
        self.assertIn("CN=lab", checked.stdout)

    def test_elliptic_curve_and_no_signature(self):
        file = self.folder / "curve.xml"
        self.assertEqual(self.certify(self.run_folder, file, "lab-ec").returncode, 0)
        self.assert_valid_by_xmllint(file)
        self.assertEqual(self.verify(file).returncode, 0)
        file = self.folder / "unsigned.xml"
        made = self.certify(self.run_folder, file)
        self.assertIn("NOT SIGNED", made.stdout)
        self.assert_valid_by_xmllint(file)
        self.assertEqual(self.verify(file).returncode, NOT_SIGNED)

    @unittest.skipUnless(shutil.which("xmlsec1"), "SKIPPED: xmlsec1 is not there")
    def test_signature_is_one_for_another_program(self):
        checked = run("xmlsec1", "--verify", "--trusted-pem", self.folder / "ca.pem",
                      "--enabled-key-data", "x509", self.signed)  # fmt: skip
        self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_numbers_are_those_of_the_result(self):
        root = ElementTree.parse(self.signed).getroot()
        results = root.findall(f".//{DCC}result")
        self.assertEqual(len(results), len(stored_run.CHANNELS))
        checked = 0
        for result in results:
            channel = result.find(f"{DCC}name/{DCC}content").text.split()[-1]
            values = [v for v in self.result["transfer_function"] if v["channel"] == channel]
            lists = result.findall(f".//{SI}realListXMLList")
            self.assertEqual(len(lists), 6)
            frequency, level, magnitude, radians, degrees, repetitions = lists
            for i, value in enumerate(values):
                stated = {
                    "magnitude": (magnitude, "magnitude", "U_magnitude", "k_magnitude", r"\one"),
                    "rad": (radians, "phase_rad", "U_phase_rad", "k_phase", r"\radian"),
                    "deg": (degrees, "phase_deg", "U_phase_deg", "k_phase", r"\degree"),
                }
                for of, of_value, of_u, of_k, unit in stated.values():
                    item = lambda name: of.find(f".//{SI}{name}").text.split()  # noqa: E731
                    self.assertEqual(item("unitXMLList"), [unit])
                    number, uncertainty = stored_run.rounded(value[of_value], value[of_u])
                    self.assertEqual(item("valueXMLList")[i], number)
                    self.assertEqual(item("valueExpandedMUXMLList")[i], uncertainty)
                    self.assertEqual(item("coverageFactorXMLList")[i], f"{value[of_k]:.2f}")
                    self.assertEqual(item("coverageProbabilityXMLList")[i], "0.9545")
                    checked += 1
            text = lambda one: one.find(f"{SI}valueXMLList").text.split()  # noqa: E731
            self.assertEqual(text(frequency), stored_run.FREQUENCIES)
            self.assertEqual(set(text(level)), {"10"})
            self.assertEqual(set(text(repetitions)), {"3"})
        self.assertEqual(checked, 3 * len(self.result["transfer_function"]))

    def test_states_what_a_certificate_must(self):
        text = self.signed.read_text()
        sha256 = run("sha256sum", self.run_folder / "result.json").stdout.split()[0]
        for part in (
            "ISO 16063-11:1999", "JCGM 100:2008", "ISO 2041", "negative if it is delayed",
            "Metrological traceability", "NMI-17-0001", sha256, self.result["recipe_sha256"],
            "Sample clock", "amplitude", "2026-0042", "0xbccb0100", "Dr. Erika Mustermann",
            "Sensor Works Example", "Ambient temperature", "two significant digits",
        ):  # fmt: skip
            self.assertIn(part, text)
        self.assertIn(base64.b64encode(self.result["recipe"].encode()).decode()[:40], text)
        self.assertNotIn("FORCED", text)

    def test_conformity_is_stated(self):
        tolerances = self.folder / "tolerances.toml"
        tolerances.write_text(
            """[conformity]
specification = "data sheet <4711>"
rule = "guard-band"
[[tolerance]]
channel = "dau/acceleration_z"
from_hz = 10
to_hz = 100
limits_percent = 5
nominal = 0.98
[[tolerance]]
channel = "dau/acceleration_x"
from_hz = 10
to_hz = 20
limits_db = 0.001
relative_to_hz = 16
[[tolerance]]
from_hz = 300
to_hz = 400
limits_deg = 5
"""
        )

        def flag(result):
            value = next(v for v in result["transfer_function"] if v["magnitude"] > 0.5)
            value["flag_names"], value["flags"] = ["over_range"], ["dau: over range"]

        folder = self.new_run("conformity", flag)
        file = self.folder / "conformity.xml"
        made = self.certify(folder, file, "lab", "--tolerances", tolerances, "--force")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assert_valid_by_xmllint(file)
        self.assertEqual(self.verify(file, "--run", folder).returncode, 0)
        tree = ElementTree.parse(file)
        lists = [e.text.split() for e in tree.iter(f"{DCC}conformityXMLList")]
        self.assertEqual(lists, [["noPass"] + ["pass"] * 10, ["fail"] * 3][::-1])
        self.assertEqual([e.text for e in tree.iter(f"{DCC}conformity")], ["fail"])
        text = file.read_text()
        for part in ("ILAC-G8:09/2019", "data sheet &lt;4711&gt;", "flag over_range",
                     "limit 3 (phase, 300 Hz to 400 Hz): no value was measured within it",
                     "no limit of the magnitude applies at 199.87 Hz"):  # fmt: skip
            self.assertIn(part, text)
        report = dyncal("report", folder, "--no-pdf", "--tolerances", tolerances)
        self.assertEqual(report.returncode, 0, report.stderr)
        html = (folder / "report.html").read_text()
        for part in ("<h2>Conformity</h2>", "data sheet &lt;4711&gt;: fail", "undecided",
                     "flag over_range"):  # fmt: skip
            self.assertIn(part, html)
        self.assertNotIn("Conformity", self.signed.read_text())

    def test_a_recording_is_hashed(self):
        folder = self.new_run("recorded", lambda result: None)
        (folder / "recording.mcap").write_bytes(b"\x89MCAP0\r\n" * 1000)
        file = self.folder / "recorded.xml"
        made = self.certify(folder, file)
        self.assertIn("cannot be evaluated once more", made.stderr)
        self.assertEqual(self.certify(folder, file, None, "--force").returncode, 0)
        sha256 = run("sha256sum", folder / "recording.mcap").stdout.split()[0]
        self.assertIn(sha256, file.read_text())

    def test_units_of_different_kinds(self):
        def turn(result):
            for value in result["transfer_function"]:
                value["unit"] = "(rad/s)/(m/s^2)"

        file = self.folder / "gyroscope.xml"
        made = self.certify(self.new_run("gyroscope", turn), file)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assert_valid_by_xmllint(file)
        unit = r"\radian\second\tothe{-1}\metre\tothe{-1}\second\tothe{2}"
        self.assertIn(f">{unit}<", file.read_text())

    def test_text_of_files_does_not_become_markup(self):
        def attack(result):
            result["bench"] = "</dcc:value><evil/>&amp;\x01"
            result["sources"][0]["device"] = "<!-- " + "x" * 1000 + " ]]>"

        file = self.folder / "attack.xml"
        made = self.certify(self.new_run("attack", attack), file, "lab")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assert_valid_by_xmllint(file)
        self.assertEqual(self.verify(file).returncode, 0)
        self.assertEqual(ElementTree.parse(file).getroot().findall(".//evil"), [])

    # What is refused.

    def refused(self, name, change, *parts, status=1):
        folder = self.new_run(name, change)
        file = self.folder / f"{name}.xml"
        made = self.certify(folder, file, "lab")
        self.assertEqual(made.returncode, status, name)
        self.assertEqual(len(made.stderr.splitlines()), 1, made.stderr)
        for part in parts:
            self.assertIn(part, made.stderr)
        self.assertFalse(file.exists())
        return folder, file

    def test_refused_runs_and_what_a_forced_certificate_says(self):
        def lose(result):
            result["points"][4]["lost"] = 7

        def flag(name):
            def change(result):
                result["transfer_function"][2].update(flags=[name], flag_names=[name])

            return change

        def invalidate(result):
            result["points"][5].update(valid=False, problem="no steady sine")
            for key in ("magnitude", "u_magnitude", "phase_rad", "u_phase_rad"):
                result["points"][5][key] = None

        refused = {
            "lost": (lose, ("7 samples were lost", "no flag says why")),
            "flagged": (flag("over_range"), ("over_range", "16 Hz", "wrong by more than U")),
            "unknown-flag": (flag("of_the_future"), ("of_the_future", "cannot judge it")),
            "invalid": (invalidate, ("no steady sine",)),
            "interrupted": (lambda r: r.update(interrupted=True), ("interrupted",)),
            "early": (lambda r: r.update(problem="cable pulled"), ("cable pulled",)),
            "missing-step": (lambda r: r.update(planned_steps=99), ("36 of 99 planned steps",)),
        }
        for name, (change, parts) in refused.items():
            with self.subTest(name):
                folder, file = self.refused(name, change, *parts)
                made = self.certify(folder, file, "lab", "--force")
                self.assertEqual(made.returncode, 0, made.stderr)
                self.assert_valid_by_xmllint(file)
                text = file.read_text()
                self.assertIn("THIS CERTIFICATE WAS FORCED", text)
                for part in parts:
                    self.assertIn(part, text)
                checked = self.verify(file, "--run", folder)
                self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
                self.assertIn("it was forced", checked.stdout)

    def test_flags_that_do_not_forbid_are_stated(self):
        def flag(result):
            result["transfer_function"][2].update(
                flags=["polarity inverted"], flag_names=["polarity_inverted"]
            )

        file = self.folder / "stated.xml"
        made = self.certify(self.new_run("stated", flag), file)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("polarity_inverted", file.read_text())

    def test_what_even_force_does_not_certify(self):
        def without_unit(result):
            for value in result["transfer_function"]:
                value["unit"] = ""

        folder, file = self.refused("no-unit", without_unit, "no form in the SI")
        self.assertEqual(self.certify(folder, file, None, "--force").returncode, 1)
        folder, file = self.refused(
            "no-day", lambda r: r.update(began_utc=None), "--performed", status=2
        )
        made = self.certify(folder, file, None, "--performed", "2026-03-01")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("<dcc:beginPerformanceDate>2026-03-01<", file.read_text())
        made = self.certify(folder, self.folder / "x.xml", None, "--performed", "2026-02-31")
        self.assertNotEqual(made.returncode, 0)

    def test_keys_that_cannot_sign(self):
        for key, certificate, part in (
            ("lab.key", "stranger.pem", "does not belong"),
            ("lab.pem", "lab.pem", "no private key"),
            ("lab.key", "lab.key", "no X.509 certificate"),
            ("missing.key", "lab.pem", "cannot be read"),
        ):
            file = self.folder / "not-made.xml"
            made = self.certify(self.run_folder, file, None, "--key", self.folder / key,
                                "--certificate", self.folder / certificate)  # fmt: skip
            self.assertEqual(made.returncode, 1, part)
            self.assertIn(part, made.stderr)
            self.assertFalse(file.exists())

    def test_an_older_certificate_is_not_overwritten(self):
        before = self.signed.read_bytes()
        made = self.certify(self.run_folder, self.signed, "lab")
        self.assertEqual(made.returncode, 1)
        self.assertIn("not overwritten", made.stderr)
        self.assertEqual(self.signed.read_bytes(), before)

    def test_a_laboratory_file_lacks_a_table(self):
        text = stored_run.LAB.read_text()
        for table, part in (
            ("customer", "[customer]"),
            ("reference", "[reference]"),
            ("person", "[[person]]"),
        ):
            file = self.folder / f"no-{table}.toml"
            kept = re.sub(rf"\n\[+{table}\]+.*?(?=\n\[|\Z)", "\n", text, flags=re.S)
            self.assertNotEqual(kept, text)
            logo = "laboratory-logo.svg"
            file.write_text(kept.replace(logo, str(stored_run.LAB_FOLDER / logo)))
            made = dyncal("certify", self.run_folder, "--lab", file, "--sensor",
                          stored_run.SENSOR, "--output", self.folder / "x.xml")  # fmt: skip
            self.assertEqual(made.returncode, 1)
            self.assertIn(f"{file}:1: table {part} is missing", made.stderr)

    # What is detected.

    def mutations(self):
        text = self.signed.read_text()
        number = r"(\d)([^\d<]*</si:{}>)"

        def changed_digit(element, which=0):
            found = list(re.finditer(number.format(element), text))[which]
            digit = str((int(found[1]) + 1) % 10)
            return text[: found.start(1)] + digit + text[found.end(1) :]

        def replaced(old, new, count=1):
            self.assertIn(old, text)
            return text.replace(old, new, count)

        signature = re.search(r"<ds:Signature .*?</ds:Signature>", text, re.S)[0]
        stranger = self.folder / "by-stranger.xml"
        if not stranger.exists():
            self.assertEqual(self.certify(self.run_folder, stranger, "stranger").returncode, 0)
        other = re.search(r"<ds:Signature .*?</ds:Signature>", stranger.read_text(), re.S)[0]
        key = re.search(r"<ds:X509Certificate>.*?</ds:X509Certificate>", text, re.S)[0]
        other_key = re.search(r"<ds:X509Certificate>.*?</ds:X509Certificate>", other, re.S)[0]
        value = re.search(r"<ds:SignatureValue>(.*?)</ds:SignatureValue>", text, re.S)[1]
        first = value.strip()[0]
        digest = re.search(r"<ds:DigestValue>(.*?)</ds:DigestValue>", text)[1]
        end = "</dcc:digitalCalibrationCertificate>"
        body = text[text.index("<dcc:digitalCalibrationCertificate") : text.index(signature)]
        evil = changed_digit("valueXMLList", 2)
        return {
            "frequency": changed_digit("valueXMLList", 0),
            "level": changed_digit("valueXMLList", 1),
            "magnitude": changed_digit("valueXMLList", 2),
            "phase in rad": changed_digit("valueXMLList", 3),
            "phase in degrees": changed_digit("valueXMLList", 4),
            "repetitions": changed_digit("valueXMLList", 5),
            "U of magnitude": changed_digit("valueExpandedMUXMLList", 0),
            "U in rad": changed_digit("valueExpandedMUXMLList", 1),
            "U in degrees": changed_digit("valueExpandedMUXMLList", 2),
            "k": changed_digit("coverageFactorXMLList", 0),
            "coverage": changed_digit("coverageProbabilityXMLList", 0),
            "condition": changed_digit("value", 0),
            "unit": replaced(r">\radian<", r">\degree<"),
            "unit with a prefix": replaced(r">\hertz<", r">\kilo\hertz<"),
            "one value more": replaced("</si:valueXMLList>", " 1</si:valueXMLList>"),
            "serial number": replaced("0xbccb0100", "0xbccb0101"),
            "customer": replaced("Sensor Works Example", "Sensor Works Exempel"),
            "laboratory": replaced("Example Laboratory", "Exemplar Laboratory"),
            "date": re.sub(r"(<dcc:issueDate>20)\d\d", r"\g<1>31", text),
            "identifier": replaced("<dcc:uniqueIdentifier>", "<dcc:uniqueIdentifier>0"),
            "norm": replaced("ISO 16063-11", "ISO 16063-21"),
            "sign convention": replaced("negative if it is delayed", "positive if it is delayed"),
            "hash of the result": re.sub(
                r"([0-9a-f]{63})[0-9a-f](</dcc:content>)", r"\g<1>x\2", text, count=1
            ),
            "recipe": replaced("<dcc:dataBase64>", "<dcc:dataBase64>AAAA"),
            "statement removed": re.sub(
                r"<dcc:statement .*?</dcc:statement>", "", text, count=1, flags=re.S
            ),
            "attribute": replaced('refType="vibration_magnitude"', 'refType="vibration_phase"'),
            "processing instruction": replaced(
                "<dcc:digitalCalibrationCertificate",
                '<?xml-stylesheet href="evil.xsl"?><dcc:digitalCalibrationCertificate',
            ),
            "signature value": replaced(value.strip(), ("A" if first != "A" else "B")
                                        + value.strip()[1:]),
            "digest": replaced(digest, ("A" if digest[0] != "A" else "B") + digest[1:]),
            "digest of a changed document": evil,
            "key swapped": replaced(key, other_key),
            "signature of a stranger": replaced(signature, other),
            "signed again by a stranger": stranger.read_text(),
            "signature stripped": replaced(signature, ""),
            "signature doubled": replaced(signature, signature + signature),
            "signature moved to the front": replaced(signature, "").replace(
                "<dcc:administrativeData>", signature + "<dcc:administrativeData>"
            ),
            "signature wrapped: the signed document as an object of it": evil[
                : evil.index(signature)
            ]
            + signature.replace(
                "</ds:Signature>", f"<ds:Object>{body}{end}</ds:Object></ds:Signature>"
            )
            + end,
            "signature wrapped: reference to a part": evil.replace(
                '<ds:Reference URI="">', '<ds:Reference URI="#signed">'
            ),
            "signature wrapped: within the comment of another document": evil[
                : evil.index(signature)
            ]
            + f"<dcc:comment>{body}{signature}{end}</dcc:comment>"
            + end,
            "reference without URI": text.replace('<ds:Reference URI="">', "<ds:Reference>"),
            "transform that selects": text.replace(
                "<ds:Transforms>",
                '<ds:Transforms><ds:Transform Algorithm="http://www.w3.org/TR/1999/'
                'REC-xpath-19991116"><ds:XPath>false()</ds:XPath></ds:Transform>',
            ),
            "weak digest": text.replace(
                "http://www.w3.org/2001/04/xmlenc#sha256", "http://www.w3.org/2000/09/xmldsig#sha1"
            ),
            "a key by itself": text.replace(
                "<ds:X509Data>", "<ds:KeyName>lab</ds:KeyName><ds:X509Data>"
            ),
            "message authentication instead of a signature": text.replace(
                "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256",
                "http://www.w3.org/2001/04/xmldsig-more#hmac-sha256",
            ),
        }

    def test_every_mutation_is_detected(self):
        original = self.signed.read_text()
        mutations = self.mutations()
        self.assertGreaterEqual(len(mutations), 30)
        statuses = {}
        for name, text in mutations.items():
            with self.subTest(name):
                self.assertNotEqual(text, original)
                file = self.folder / "mutated.xml"
                file.write_text(text)
                checked = self.verify(file)
                self.assertIn(
                    checked.returncode,
                    (READABLE, SCHEMA_STATUS, NOT_SIGNED, SIGNATURE, SIGNER),
                    checked.stdout + checked.stderr,
                )
                self.assertIn("NOT verified", checked.stderr)
                # By the signature, too, whatever the schema says of it.
                self.assertRegex(checked.stdout, "(signature|signer) +FAILED")
                statuses[name] = checked.returncode
        self.assertEqual(statuses["signature stripped"], NOT_SIGNED)
        self.assertEqual(statuses["magnitude"], SIGNATURE)
        self.assertEqual(statuses["signed again by a stranger"], SIGNER)
        print(f"{len(mutations)} mutations detected")

    def test_signers_that_are_not_known(self):
        checked = dyncal("verify", self.signed)
        self.assertEqual(checked.returncode, SIGNER)
        self.assertIn("--trust", checked.stdout)
        checked = dyncal("verify", self.signed, "--trust", self.folder / "other-ca.pem")
        self.assertEqual(checked.returncode, SIGNER)
        pinned = dyncal("verify", self.signed, "--trust", self.folder / "lab.pem")
        self.assertEqual(pinned.returncode, 0, pinned.stdout)
        file = self.folder / "by-server.xml"
        self.assertEqual(self.certify(self.run_folder, file, "server").returncode, 0)
        checked = self.verify(file)
        self.assertEqual(checked.returncode, SIGNER)
        self.assertIn("not meant for signatures", checked.stdout)

    def test_numbers_of_another_run_are_detected(self):
        def change(result):
            result["transfer_function"][5]["magnitude"] *= 1.05

        checked = self.verify(self.signed, "--run", self.new_run("changed", change))
        self.assertEqual(checked.returncode, NUMBERS)
        self.assertIn("Transfer function of dau/acceleration_x", checked.stdout)
        self.assertIn("item 6", checked.stdout)
        checked = self.verify(
            self.signed, "--run", self.new_run("noted", lambda r: r.update(problem="late note"))
        )
        self.assertEqual(checked.returncode, NUMBERS)
        self.assertIn("SHA-256 is another", checked.stdout)
        missing = self.verify(self.signed, "--run", self.folder / "nowhere")
        self.assertEqual(missing.returncode, 1)

    def test_foreign_xml_reads_no_file_and_fills_no_memory(self):
        secret = self.folder / "secret.txt"
        secret.write_text("the secret of this host")
        head = "<?xml version='1.0'{}?>"
        name = "dcc:digitalCalibrationCertificate"
        root = f"<{name} xmlns:dcc='https://ptb.de/dcc'>{{}}</{name}>"
        entity = f"<!DOCTYPE x [<!ENTITY e SYSTEM 'file://{secret}'>]>"
        bomb = "<!DOCTYPE x [<!ENTITY a0 'aaaaaaaaaa'>" + "".join(
            f"<!ENTITY a{i} '{f'&a{i - 1};' * 10}'>" for i in range(1, 12)
        )
        foreign = {
            "entity": head.format("") + entity + root.format("&e;"),
            "bomb": head.format("") + bomb + "]>" + root.format("&a11;"),
            "parameter entity": head.format("")
            + "<!DOCTYPE x [<!ENTITY % p SYSTEM 'http://127.0.0.1:9/x'> %p;]>" + root.format(""),
            "external subset": head.format("")
            + "<!DOCTYPE x SYSTEM 'http://127.0.0.1:9/x.dtd'>" + root.format(""),
            "not XML": "certificate",
            "cut": self.signed.read_text()[:5000],
            "empty": "",
            "deep": head.format("") + "<a>" * 100000,
            "null": "\0" * 100,
        }  # fmt: skip
        for name, text in foreign.items():
            file = self.folder / "foreign.xml"
            file.write_text(text)
            checked = self.verify(file)
            self.assertEqual(checked.returncode, READABLE, f"{name}: {checked.stdout}")
            self.assertIn(str(file), checked.stdout)
            self.assertNotIn("the secret", checked.stdout + checked.stderr)
        for encoding in ("utf-16", "utf-7"):
            file.write_bytes(
                (head.format(f" encoding='{encoding}'") + entity + root.format("&e;")).encode(
                    encoding
                )
            )
            checked = self.verify(file)
            self.assertEqual(checked.returncode, READABLE, f"{encoding}: {checked.stdout}")
        file.write_text(head.format("") + "<a/>")
        self.assertEqual(self.verify(file).returncode, SCHEMA_STATUS)

    def test_a_schema_that_is_not_there(self):
        checked = self.verify(self.signed, "--schema", self.folder / "none.xsd")
        self.assertEqual(checked.returncode, SCHEMA_STATUS)
        self.assertIn("--schema", checked.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
