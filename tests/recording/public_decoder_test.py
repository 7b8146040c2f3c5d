"""A public decoder reads every topic of a recorded demo: values equal to the last bit.

public_decoder_test.py PROGRAMS PUBLISHER FOLDER; needs node and, from npm or in DYNCAL_NPM_FOLDER,
@mcap/core, @foxglove/omgidl-parser and @foxglove/omgidl-serialization; else it is skipped.
"""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

PATIENCE_S = 300
PACKAGES = ["@mcap/core", "@foxglove/omgidl-parser", "@foxglove/omgidl-serialization"]
DECODER = pathlib.Path(__file__).resolve().with_name("public_decoder.js")


def library(folder):
    """A folder with the packages; None where they cannot be had."""
    given = pathlib.Path(os.environ.get("DYNCAL_NPM_FOLDER", folder / "npm"))
    if shutil.which("node") is None:
        return None
    if not (given / "node_modules" / PACKAGES[0]).is_dir() and shutil.which("npm"):
        given.mkdir(parents=True, exist_ok=True)
        (given / "package.json").write_text("{}")
        try:
            subprocess.run(
                ["npm", "install", "--no-audit", "--no-fund", *PACKAGES],
                cwd=given,
                capture_output=True,
                check=False,
                timeout=120,
            )
        except subprocess.TimeoutExpired:
            return None
    return given if (given / "node_modules" / PACKAGES[0]).is_dir() else None


class PublicDecoder(unittest.TestCase):
    def decode(self, recording, npm):
        """Messages of each topic, and how many of them are the same when encoded again."""
        decoded = subprocess.run(
            ["node", str(DECODER), str(recording)],
            cwd=npm,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(decoded.returncode, 0, decoded.stderr)
        topics = json.loads(decoded.stdout)
        print(topics)
        for topic, found in topics.items():
            self.assertEqual(found["same"], found["messages"], topic)
        return topics

    def test_reads_topics_that_no_demo_has(self):
        _, publisher, folder = map(pathlib.Path, ARGUMENTS)
        folder.mkdir(parents=True, exist_ok=True)
        npm = library(folder.parent)
        if npm is None:
            self.skipTest("SKIPPED: no node, or @mcap/core and @foxglove/omgidl-* cannot be had")
        recording = folder / "every-topic.mcap"
        recording.unlink(missing_ok=True)
        subprocess.run([publisher.with_name("every_topic"), recording], check=True)
        topics = self.decode(recording, npm)
        self.assertEqual(len(topics), 15)
        for topic in ("CanSamples", "DsoRecord", "TssRecord", "CatchUpRequest", "Command"):
            self.assertEqual(topics[topic]["messages"], 50)

    def test_reads_every_topic_of_a_demo_to_the_last_bit(self):
        programs, _, folder = map(pathlib.Path, ARGUMENTS)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        npm = library(folder.parent)
        if npm is None:
            self.skipTest("SKIPPED: no node, or @mcap/core and @foxglove/omgidl-* cannot be had")
        domain = str(100 + os.getpid() % 100)
        with open(folder / "recorder.log", "w", encoding="utf-8") as log:
            recorder = subprocess.Popen(
                [
                    str(programs / "dyncal-recorder"),
                    *("--folder", str(folder / "recordings"), "--domain", domain, "--runs-only"),
                ],
                stderr=log,
            )
            demo = [str(programs / "dyncal"), "demo", "--preset", "mpu9250-ptb", "--domain", domain]
            demo += ["--repetitions", "1", "--duration", "0.5", "--output", str(folder / "demo")]
            done = subprocess.run(
                demo, capture_output=True, text=True, check=False, timeout=PATIENCE_S
            )
            self.assertIn(done.returncode, (0, 1), done.stderr)
            time.sleep(3)  # the last results are on their way
            recorder.send_signal(signal.SIGTERM)
            recorder.wait(PATIENCE_S)
        recordings = sorted((folder / "recordings").glob("*/*.mcap"))
        self.assertEqual(len(recordings), 1, (folder / "recorder.log").read_text("utf-8"))
        topics = self.decode(recordings[0], npm)
        for topic in ("DauSamples", "AcsSamples", "Measurement", "Excitation", "SourceDescription"):
            self.assertIn(topic, topics)
        self.assertIn("CalibrationResult", topics)


if __name__ == "__main__":
    ARGUMENTS = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1])
