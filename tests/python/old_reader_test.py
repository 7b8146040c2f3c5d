"""Version 0.10 of the cyclonedds package reads and writes as 11 does: old_reader_test.py PROGRAMS
FOLDER"""

import importlib.metadata
import os
import pathlib
import subprocess
import sys
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(TOP / "tests"))
from dds_domain import own_dds_domain  # noqa: E402

os.environ["DYNCAL_DOMAIN"] = str(own_dds_domain())
import page  # noqa: E402

from dyncal import dds  # noqa: E402

PATIENCE_S = 120


class OldReader(unittest.TestCase):
    def test_it_is_the_old_version(self):
        self.assertTrue(importlib.metadata.version("cyclonedds").startswith("0.10"))

    def test_the_program_of_the_page_reads_results(self):
        (FOLDER / "results.py").write_text(page.programs()["results.py"])
        words = ["demo", "--preset", "mpu9250-ptb", "--repetitions", "1", "--duration", "0.5"]
        words += ["--domain", os.environ["DYNCAL_DOMAIN"], "--output", str(FOLDER / "demo")]
        with subprocess.Popen(
            [sys.executable, FOLDER / "results.py", "*"], stdout=subprocess.PIPE, text=True
        ) as shown:
            done = subprocess.run([PROGRAMS / "dyncal", *words], capture_output=True, check=False)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            printed = shown.communicate(timeout=PATIENCE_S)[0].splitlines()
        self.assertGreater(len(printed), 17)

    def test_a_message_goes_through(self):
        reader = dds.Reader("Measurement", bench="old")
        writer = dds.Writer("Measurement", bench="old")
        self.assertTrue(writer.wait_for_readers(timeout_s=PATIENCE_S))
        sent = dds.TOPICS["Measurement"][0](bench="old", run="17")
        writer.write(sent)
        self.assertEqual(next(reader.messages(timeout_s=PATIENCE_S)), sent)


if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
