"""Public decoders read every topic of a recorded demo: values equal to the last bit.

public_decoder_test.py PROGRAMS PUBLISHER FOLDER. One needs node and, from npm or in
DYNCAL_NPM_FOLDER, @mcap/core, @foxglove/omgidl-parser and @foxglove/omgidl-serialization; the other
mcap and rosbags from PyPI, or in the interpreter of DYNCAL_MCAP_PYTHON. One that cannot be had is
named; the test is skipped where there is none.
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

import public_reader

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

PATIENCE_S = 300
PACKAGES = ["@mcap/core", "@foxglove/omgidl-parser", "@foxglove/omgidl-serialization"]
HERE = pathlib.Path(__file__).resolve().parent


def npm_library(folder):
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


def decoders(folder):
    """Command and working folder of each decoder that can be had."""
    found = []
    npm = npm_library(folder)
    if npm is not None:
        found.append((["node", str(HERE / "public_decoder.js")], npm))
    else:
        print("SKIPPED: no node, or @mcap/core and @foxglove/omgidl-* cannot be had")
    python = public_reader.interpreter(folder, ("mcap", "rosbags"))
    if python is not None:
        found.append(([python, str(HERE / "public_decoder.py")], folder))
    else:
        print("SKIPPED: mcap and rosbags of PyPI cannot be had")
    return found


class PublicDecoder(unittest.TestCase):
    def setUp(self):
        self.programs, self.publisher, self.folder = map(pathlib.Path, ARGUMENTS)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.decoders = decoders(self.folder.parent)
        if not self.decoders:
            self.skipTest("SKIPPED: no public decoder can be had")

    def decode(self, recording):
        """How many messages each topic has. All are the same when a decoder encodes them again."""
        counts = []
        for command, place in self.decoders:
            decoded = subprocess.run(
                [*command, str(recording)], cwd=place, capture_output=True, text=True, check=False
            )
            self.assertEqual(decoded.returncode, 0, decoded.stderr)
            topics = json.loads(decoded.stdout)
            for topic, found in topics.items():
                self.assertEqual(found["same"], found["messages"], (command, topic))
            counts.append({topic: found["messages"] for topic, found in topics.items()})
            print(command[-1], counts[-1])
            self.assertEqual(counts[-1], counts[0])
        return counts[0]

    def test_reads_topics_that_no_demo_has(self):
        recording = self.folder / "every-topic.mcap"
        recording.unlink(missing_ok=True)
        subprocess.run([self.publisher.with_name("every_topic"), recording], check=True)
        topics = self.decode(recording)
        self.assertEqual(len(topics), 16)
        for topic in ("CanSamples", "DsoRecord", "TssRecord", "CatchUpRequest", "Command"):
            self.assertEqual(topics[topic], 50)

    def test_reads_every_topic_of_a_demo_to_the_last_bit(self):
        programs, folder = self.programs, self.folder
        shutil.rmtree(folder)
        folder.mkdir()
        domain = str(own_dds_domain())
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
        topics = self.decode(recordings[0])
        for topic in ("DauSamples", "AcsSamples", "Measurement", "Excitation", "SourceDescription"):
            self.assertIn(topic, topics)
        self.assertIn("CalibrationResult", topics)


if __name__ == "__main__":
    ARGUMENTS = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1])
