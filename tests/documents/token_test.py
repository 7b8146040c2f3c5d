#!/usr/bin/env python3
"""Certificates that are signed by a key in a token: softhsm2, by OpenSSL's engine.

    token_test.py DYNCAL EXAMPLE_RESULT

Held: the signature of an RSA key in a token verifies by dyncal and by xmlsec1, and the key is in no
file; a wrong PIN, none, no such key or token, a PIN within the command line, a key of another
certificate and one of a curve are one sentence each, and no certificate.
"""

import os
import pathlib
import shutil
import sys
import tempfile
import unittest

import certificate_test
import stored_run
from certificate_test import dyncal, make_ca, make_signer, run

PIN = "864213"
MODULES = pathlib.Path("/usr/share/p11-kit/modules")


def what_is_missing():
    if shutil.which("softhsm2-util") is None or not (MODULES / "softhsm2.module").exists():
        return "softhsm2 is not there"
    if run("openssl", "engine", "pkcs11").returncode != 0:
        return "libengine-pkcs11-openssl is not there"
    return None


class Token(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-token-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        (cls.folder / "tokens").mkdir()
        (cls.folder / "pin").write_text(PIN)
        (cls.folder / "wrong").write_text("111111")
        configuration = cls.folder / "softhsm2.conf"
        configuration.write_text(f"directories.tokendir = {cls.folder}/tokens\n")
        os.environ["SOFTHSM2_CONF"] = str(configuration)
        cls.made("softhsm2-util", "--init-token", "--free", "--label", "lab", "--pin", PIN,
                 "--so-pin", PIN)  # fmt: skip
        make_ca(cls.folder, "ca")
        for number, kind in enumerate(("rsa", "ec"), start=1):
            make_signer(cls.folder, kind, "ca", kind)
            key = cls.folder / f"{kind}.key"
            cls.made("softhsm2-util", "--import", key, "--token", "lab", "--label", kind, "--id",
                     f"0{number}", "--pin", PIN)  # fmt: skip
            key.unlink()
        cls.run_folder = stored_run.write_run(
            cls.folder / "runs/bench/one", stored_run.clean_run(certificate_test.EXAMPLE)
        )

    @staticmethod
    def made(*command):
        done = run(*command)
        if done.returncode != 0:
            raise RuntimeError(done.stdout + done.stderr)

    def certify(self, file, key, certificate="rsa"):
        return dyncal("certify", self.run_folder, "--lab", stored_run.LAB, "--sensor",
                      stored_run.SENSOR, "--output", file, "--key", key, "--certificate",
                      self.folder / f"{certificate}.pem",
                      *stored_run.kept(certificate_test.DYNCAL, self.run_folder))  # fmt: skip

    def key(self, name, pin="pin"):
        return f"pkcs11:token=lab;object={name};type=private?pin-source=file:{self.folder / pin}"

    def test_signs(self):
        file = self.folder / "signed.xml"
        made = self.certify(file, self.key("rsa"))
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        trust = self.folder / "ca.pem"
        checked = dyncal("verify", file, "--trust", trust, "--run", self.run_folder,
                         *stored_run.kept(certificate_test.DYNCAL, self.run_folder))  # fmt: skip
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        if shutil.which("xmlsec1"):
            checked = run("xmlsec1", "--verify", "--trusted-pem", trust, "--enabled-key-data",
                          "x509", file)  # fmt: skip
            self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_says_in_one_sentence_why_not(self):
        for key, certificate, part in (
            (self.key("rsa", "wrong"), "rsa", "PIN incorrect"),
            (self.key("rsa", "missing"), "rsa", "no such file"),
            (self.key("nobody"), "rsa", "object not found"),
            ("pkcs11:token=other;object=rsa", "rsa", "object not found"),
            (f"pkcs11:token=lab;object=rsa?pin-value={PIN}", "rsa", "everybody on this computer"),
            (self.key("rsa"), "ec", "does not belong to the first certificate"),
            (self.key("ec"), "ec", "must be RSA"),
        ):
            file = self.folder / "not-made.xml"
            made = self.certify(file, key, certificate)
            self.assertEqual(made.returncode, 1, (key, made.stderr))
            self.assertIn(part, made.stderr)
            self.assertEqual(made.stderr.count("\n"), 1, made.stderr)
            self.assertNotIn(PIN, made.stderr)
            self.assertFalse(file.exists())


if __name__ == "__main__":
    if missing := what_is_missing():
        print(f"SKIPPED: signing by a key in a token is not tested: {missing}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
