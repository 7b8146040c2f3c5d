"""dyncal-bridge beside a run whose records are played: bridge_test.py PROGRAMS FOLDER

What a client of Foxglove's protocol, mosquitto's subscriber and an OPC UA client see is the result
file, number by number, and the samples of the recording. A bridge that is killed or stopped, or
whose peers take nothing, changes no bit of the result. Needs mosquitto and mosquitto_sub; node and
npm for Foxglove's own client.
"""

import json
import math
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import unittest

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests/faults"), str(TOP / "tests/python")]
from bridge_peers import (  # noqa: E402
    PATIENCE_S,
    SUBPROTOCOL,
    Bridge,
    Broker,
    FoxgloveClient,
    OpcuaClient,
    messages_in,
    wait_until,
)
from bench_laboratory import READY  # noqa: E402
from played_laboratory import PlayedLaboratory  # noqa: E402

import dyncal  # noqa: E402

BENCH, ANOTHER_RUN = "played", "20200101T000000Z"
CHANNELS = [f"acceleration_{axis}" for axis in "xyz"]
# Members of points that the bridge has not: see result_members.py.
NOT_HANDED_ON = {
    *("budget", "signals", "source_samples", "fit", "monte_carlo", "measured_frequency_hz"),
    *("u_measured_frequency_hz", "measured_level_m_s2", "u_measured_level_m_s2"),
}
OF_THE_BRIDGE = {"bench", "run", "provisional"}
SAMPLES = 'samples = ["*/dau/acceleration_z"]\nmax_rate_hz = 10_000\n'
# Foxglove's own client: prints what it gets of the topics that are named.
CLIENT = """
import protocols from "@foxglove/ws-protocol";
import WebSocket from "ws";
const { FoxgloveClient } = protocols;
const [url, protocol, ...topics] = process.argv.slice(2);
const client = new FoxgloveClient({ ws: new WebSocket(url, [protocol]) });
const named = new Map();
client.on("error", (error) => { console.error(String(error)); process.exit(1); });
client.on("advertise", (channels) => {
  for (const channel of channels.filter((one) => topics.includes(one.topic))) {
    named.set(client.subscribe(channel.id), channel.topic);
  }
});
client.on("message", ({ subscriptionId, data }) => {
  console.log(named.get(subscriptionId) + " " + new TextDecoder().decode(data));
});
"""


def point_key(point):
    return point["channel"], point["step"], point["repetition"]


def services_of(laboratory):
    for program in ("dyncal-analysis", "dyncal-acs"):
        laboratory.service(program)


class Seen(unittest.TestCase):
    """One run, looked at by all peers."""

    @classmethod
    def setUpClass(cls):
        folder = FOLDER / "seen"
        shutil.rmtree(folder, ignore_errors=True)
        cls.laboratory = PlayedLaboratory(PROGRAMS, folder / "laboratory", "cyclonedds", speed=1.0)
        cls.addClassCleanup(cls.laboratory.close)
        cls.broker = cls.keep(Broker(folder / "broker"))
        cls.leave_results_of_another_run()
        cls.bridge = cls.keep(
            Bridge(folder / "bridge", cls.laboratory.domain, cls.broker.port, SAMPLES)
        )
        cls.bridge.wait_for(*Bridge.LISTENS, "connected to 127.0.0.1")
        cls.subscriber = cls.keep(cls.broker.subscriber(folder / "subscriber.log", "dyncal/#"))
        cls.client = FoxgloveClient(cls.bridge.foxglove, lambda topic: "/samples/acs/" not in topic)
        services_of(cls.laboratory)
        recordings = folder / "recordings"
        recorder = cls.laboratory.on_bus("dyncal-recorder", ["--runs-only", "--folder", recordings])
        recorder.wait_for_text(READY["dyncal-recorder"])
        cls.laboratory.expect_same_bits(cls.laboratory.run())
        recorder.end()
        cls.recording = dyncal.read_recording(next(recordings.rglob("*.mcap")))
        cls.result = json.loads((cls.laboratory.folder / "run.json").read_text())
        cls.points = {point_key(point): point for point in cls.result["points"]}
        wait_until(cls.is_all_there, "the results to have come to all peers")
        cls.values = OpcuaClient(cls.bridge.opcua).read()
        cls.client.end()

    @classmethod
    def keep(cls, process):
        cls.addClassCleanup(process.end)
        return process

    @classmethod
    def leave_results_of_another_run(cls):
        """As a bridge leaves them that was there before."""
        for bench in (BENCH, "unknown"):
            topic = f"dyncal/benches/{bench}/points/dau/acceleration_z/99/1"
            text = json.dumps({"bench": bench, "run": ANOTHER_RUN, "magnitude": 1.0})
            words = ["mosquitto_pub", "-p", str(cls.broker.port), "-r", "-t", topic, "-m", text]
            subprocess.run(words, check=True)

    @classmethod
    def is_all_there(cls):
        by_mqtt = dict(messages_in(cls.subscriber.text()))
        functions = [one for one in by_mqtt if "/transfer_functions/" in one]
        return (
            len(functions) == len(CHANNELS)
            and by_mqtt.get(f"dyncal/benches/{BENCH}/state", {}).get("state") == "done"
            and all(topic in cls.client.messages for topic in cls.function_topics())
        )

    @classmethod
    def function_topics(cls):
        return [f"/{BENCH}/transfer_functions/dau/{channel}" for channel in CHANNELS]

    def check_point(self, seen):
        """As the file has it, and nothing that it has not."""
        stated = self.points[point_key(seen)]
        self.assertEqual(seen["run"], self.result["run"])
        self.assertIs(seen["provisional"], False)
        without = {key: seen[key] for key in seen if key not in OF_THE_BRIDGE}
        expected = {key: stated[key] for key in stated if key not in NOT_HANDED_ON}
        self.assertEqual(without, expected)

    def check_points(self, seen):
        newest = {point_key(one): one for one in seen}
        self.assertGreaterEqual(len(self.points), 18)
        self.assertEqual(newest.keys(), self.points.keys())
        for one in newest.values():
            self.check_point(one)

    def check_function(self, seen):
        rows = [r for r in self.result["transfer_function"] if r["channel"] == seen["channel"]]
        self.assertEqual(len(rows), 3)
        self.assertEqual(seen["transfer_function"], rows)
        (channel,) = [c for c in self.result["channels"] if c["channel"] == seen["channel"]]
        for member in ("unit", "lost", "flags", "flag_names"):
            self.assertEqual(seen[member], channel[member])
        delays = [d for d in self.result["group_delay"] if d["channel"] == seen["channel"]]
        stated = [{k: d[k] for k in d if k != "phase_covariance_rad2"} for d in delays]
        self.assertEqual([seen["group_delay"]] if seen["group_delay"] else [], stated)

    def test_foxglove_sees_the_results(self):
        topics = [f"/{BENCH}/points/dau/{channel}" for channel in CHANNELS]
        self.check_points([m for topic in topics for _, m in self.client.messages[topic]])
        for topic in self.function_topics():
            self.check_function(self.client.messages[topic][-1][1])
        states = [m["state"] for _, m in self.client.messages[f"/{BENCH}/state"]]
        self.assertEqual(states[-1], "done")
        self.assertIn("running", states)

    def test_foxglove_sees_the_samples(self):
        source = self.recording.source("dau")
        values = dict(zip(source.sample_number.tolist(), source["acceleration_z"].tolist()))
        rows = self.client.messages[f"/{BENCH}/samples/dau/acceleration_z"]
        self.assertGreater(len(rows), 500)
        compared = 0
        for _, row in rows:
            self.assertIn(row["step"], (2, 3))  # some 1 kS/s, 500 rows a second at most
            of_row = [values.get(row["number"] + i) for i in range(row["step"])]
            if None not in of_row:  # else before or after the recording
                compared += 1
                expected = (of_row[0], min(of_row), max(of_row))
                self.assertEqual((row["value"], row["minimum"], row["maximum"]), expected)
        self.assertGreater(compared, 500)

    def test_the_subscriber_sees_the_results(self):
        every = list(messages_in(self.subscriber.text()))
        self.check_points(
            [m for topic, m in every if "/points/" in topic and m["run"] != ANOTHER_RUN]
        )
        functions = {topic: m for topic, m in every if "/transfer_functions/" in topic}
        self.assertEqual(len(functions), len(CHANNELS))
        for one in functions.values():
            self.check_function(one)
        for topic, m in every:
            if "/points/" in topic and m["run"] != ANOTHER_RUN:
                of_channel = f"{m['channel']}/{m['step']}/{m['repetition']}"
                self.assertEqual(topic, f"dyncal/benches/{BENCH}/points/{of_channel}")

    def test_the_subscriber_sees_the_samples_that_were_asked_for(self):
        source = self.recording.source("dau")
        values = dict(zip(source.sample_number.tolist(), source["acceleration_z"].tolist()))
        stamps = dict(zip(source.sample_number.tolist(), source.stamps_ns.tolist()))
        every = [m for m in messages_in(self.subscriber.text()) if "/samples/" in m[0]]
        topic = f"dyncal/benches/{BENCH}/samples/dau/acceleration_z"
        self.assertEqual({one for one, _ in every}, {topic})
        compared = 0
        for _, rows in every:
            self.assertEqual(rows["step"], 1)
            for number, stamp, value in zip(rows["numbers"], rows["stamps_ns"], rows["values"]):
                if number in values:
                    compared += 1
                    self.assertEqual((stamp, value), (stamps[number], values[number]))
        self.assertGreater(compared, 1000)

    def test_what_is_retained_is_of_the_newest_run(self):
        retained = self.broker.retained("dyncal/#", FOLDER / "seen")
        points = {topic: m for topic, m in retained.items() if f"/{BENCH}/points/" in topic}
        self.check_points(points.values())
        self.assertIn("dyncal/benches/unknown/points/dau/acceleration_z/99/1", retained)
        self.assertEqual(retained["dyncal/bridge"], {"state": "online"})
        self.assertNotIn("/samples/", "".join(retained))

    def test_the_opcua_client_sees_the_results(self):
        for channel in CHANNELS:
            place = f"{BENCH}/points/dau/{channel}"
            members = self.members_below(place)
            self.check_point(json.loads(members["json"]))
            stated = self.points["dau/" + channel, members["step"], members["repetition"]]
            for name in ("frequency_hz", "magnitude", "u_magnitude", "phase_rad", "u_phase_rad"):
                self.assertEqual(members[name], stated[name])
            self.assertEqual(members["flag_names"] or [], stated["flag_names"])
            stamps = {
                value.SourceTimestamp
                for path, value in self.values.items()
                if path.startswith(place + "/")
            }
            self.assertEqual(len(stamps), 1)
            self.check_means(channel)
        self.assertEqual(self.values[f"{BENCH}/state/state"].Value.Value, "done")
        self.assertEqual(self.values[f"{BENCH}/state/run"].Value.Value, self.result["run"])

    def members_below(self, place):
        return {
            path.removeprefix(place + "/"): value.Value.Value
            for path, value in self.values.items()
            if path.startswith(place + "/")
        }

    def check_means(self, channel):
        members = self.members_below(f"{BENCH}/transfer_functions/dau/{channel}")
        self.check_function(json.loads(members["json"]))
        rows = [r for r in self.result["transfer_function"] if r["channel"] == f"dau/{channel}"]
        for name in ("frequency_hz", "magnitude", "U_magnitude", "phase_rad", "nu_eff_phase"):
            stated = [row[name] for row in rows]
            is_freedom = name.startswith("nu_eff")
            expected = [math.inf if one is None and is_freedom else one for one in stated]
            np.testing.assert_array_equal(members[f"means_{name}"], expected)

    def test_the_opcua_client_may_not_write(self):
        answers = OpcuaClient(self.bridge.opcua).try_to_write()
        self.assertEqual(len(answers), 3)
        self.assertEqual({one for one in answers if "Denied" not in one}, set(), answers)

    def test_foxgloves_own_client_sees_them_too(self):
        node, npm = shutil.which("node"), shutil.which("npm")
        if not (node and npm):
            self.skipTest("Foxglove's own client needs node and npm")
        folder = FOLDER / "foxglove-client"
        folder.mkdir(exist_ok=True)
        (folder / "package.json").write_text('{"type": "module"}')
        if not (folder / "node_modules/ws").exists():
            words = [npm, "install", "--no-audit", "--no-fund", "--fetch-retries=0"]
            words += ["--fetch-timeout=30000", "@foxglove/ws-protocol@0.8.0", "ws@8"]
            done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                self.skipTest(f"@foxglove/ws-protocol cannot be had from npm: {done.stderr[-300:]}")
        (folder / "client.mjs").write_text(CLIENT)
        topics = [f"/{BENCH}/points/dau/{channel}" for channel in CHANNELS]
        url = f"ws://127.0.0.1:{self.bridge.foxglove}"
        words = [node, folder / "client.mjs", url, SUBPROTOCOL, *topics]
        log = folder / "client.log"
        with log.open("w") as output:
            with subprocess.Popen(words, stdout=output, stderr=subprocess.STDOUT) as client:
                try:
                    wait_until(
                        lambda: log.read_text().count("\n") >= len(self.points),
                        "Foxglove's client to have all points",
                    )
                finally:
                    client.terminate()
        self.check_points([message for _, message in messages_in(log.read_text())])


class Disturbed(unittest.TestCase):
    """Whatever becomes of the bridge, the run is that of `dyncal analyse`, to the last bit."""

    def setUp(self):
        self.folder = FOLDER / self.id().rpartition(".")[2]
        shutil.rmtree(self.folder, ignore_errors=True)
        self.laboratory = PlayedLaboratory(PROGRAMS, self.folder, "cyclonedds")
        self.addCleanup(self.laboratory.close)
        self.broker = Broker(self.folder / "broker")
        self.addCleanup(self.broker.end)
        self.bridge = Bridge(
            self.folder / "bridge", self.laboratory.domain, self.broker.port, SAMPLES
        )
        self.addCleanup(self.bridge.end)
        self.bridge.wait_for(*Bridge.LISTENS, "connected to 127.0.0.1")
        services_of(self.laboratory)

    def run_disturbed_by(self, disturb):
        """Once the bridge has handed on the first result."""
        points = self.broker.subscriber(self.folder / "points.log", "dyncal/benches/+/points/#")
        self.addCleanup(points.end)
        run = self.laboratory.run()
        wait_until(lambda: list(messages_in(points.text())), "the first point")
        self.assertTrue(run.runs())
        disturb()
        self.laboratory.expect_same_bits(run)

    def test_a_killed_bridge(self):
        self.run_disturbed_by(self.bridge.process.kill)

    def test_a_stopped_bridge(self):
        self.run_disturbed_by(lambda: self.bridge.process.send_signal(signal.SIGSTOP))
        self.bridge.process.send_signal(signal.SIGCONT)
        self.expect_it_ends()

    def test_peers_that_take_nothing(self):
        hanging = self.hanging_clients()
        self.run_disturbed_by(lambda: self.broker.process.send_signal(signal.SIGSTOP))
        self.assertEqual(len(hanging), 2)
        self.expect_it_ends()

    def hanging_clients(self):
        """A client of Foxglove's protocol that subscribes and reads no more; one of OPC UA that
        connects and says nothing."""
        from websockets.sync.client import connect

        place = f"ws://127.0.0.1:{self.bridge.foxglove}"
        link = self.enterContext(connect(place, subprotocols=[SUBPROTOCOL], max_queue=1))
        wait_until(lambda: self.subscribe_all(link), "samples to be there to subscribe to")
        silent = socket.create_connection(("127.0.0.1", self.bridge.opcua))
        self.addCleanup(silent.close)
        return link, silent

    def subscribe_all(self, link):
        message = json.loads(link.recv(timeout=PATIENCE_S))
        channels = message.get("channels", [])
        each = [{"id": one["id"], "channelId": one["id"]} for one in channels]
        link.send(json.dumps({"op": "subscribe", "subscriptions": each}))
        return any("/samples/" in one["topic"] for one in channels)

    def expect_it_ends(self):
        """Within 2 s; this machine may be busy with other tests, so that a try is not all."""
        took_s = self.bridge.terminated_within_s()
        print(f"{self.id()}: the bridge ended {took_s:.1f} s after SIGTERM")
        self.assertLess(took_s, 2.0 * SLOWNESS)


SLOWNESS = 5.0  # of a machine that runs other tests beside this one

if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    for program in ("mosquitto", "mosquitto_sub"):
        if not shutil.which(program, path="/usr/sbin:/usr/bin:/usr/local/bin"):
            print(f"SKIPPED: there is no {program} (Debian: mosquitto, mosquitto-clients)")
            sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
