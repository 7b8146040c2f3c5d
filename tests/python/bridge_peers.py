"""dyncal-bridge and peers of its worlds, for tests: a client of Foxglove's protocol, mosquitto and
its subscriber, an OPC UA client. Each collects what it sees."""

import asyncio
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = TOP / "deploy/python/bridge"
PATIENCE_S = 180.0
SUBPROTOCOL = "foxglove.sdk.v1"
NAMESPACE = "urn:dyncal:bridge"


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_until(condition, what, patience_s=PATIENCE_S):
    deadline = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"waited {patience_s:.0f} s for {what}")
        time.sleep(0.05)  # between two looks at the condition


class Process:
    def __init__(self, words, log, **settings):
        self.log = pathlib.Path(log)
        with self.log.open("w", encoding="utf-8") as file:
            self.process = subprocess.Popen(
                list(map(str, words)), stdout=file, stderr=subprocess.STDOUT, **settings
            )

    def text(self):
        return self.log.read_text(encoding="utf-8", errors="replace")

    def wait_for(self, *texts):
        def said():
            if self.process.poll() is not None:
                raise AssertionError(f"{self.log} has ended: {self.text()}")
            return all(text in self.text() for text in texts)

        wait_until(said, f"{texts} in {self.log}")

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGCONT)
            self.process.terminate()
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()


class Bridge(Process):
    """With all plugs, each at a port of its own."""

    LISTENS = ("hands on to", "foxglove INFO: listening", "opcua INFO: listening")

    def __init__(self, folder, domain, broker_port, more=""):
        self.foxglove, self.opcua = free_port(), free_port()
        folder.mkdir(parents=True, exist_ok=True)
        settings = folder / "bridge.toml"
        settings.write_text(
            f"""[foxglove]
listen = "127.0.0.1:{self.foxglove}"
[opcua]
listen = "127.0.0.1:{self.opcua}"
[mqtt]
broker = "127.0.0.1:{broker_port}"
{more}"""
        )
        super().__init__(
            [sys.executable, "-B", "-m", "dyncal_bridge", settings, "--domain", domain],
            folder / "bridge.log",
            env={**os.environ, "PYTHONPATH": str(PACKAGE)},
        )

    def terminated_within_s(self):
        begin = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(60)
        if status != 0:
            raise AssertionError(f"the bridge ends with {status}: {self.text()}")
        return time.monotonic() - begin


class Broker(Process):
    def __init__(self, folder):
        self.port = free_port()
        program = shutil.which("mosquitto", path=f"{os.environ['PATH']}:/usr/sbin")
        folder.mkdir(parents=True, exist_ok=True)
        settings = folder / "mosquitto.conf"
        settings.write_text(f"listener {self.port} 127.0.0.1\nallow_anonymous true\n")
        super().__init__([program, "-c", settings, "-v"], folder / "mosquitto.log")
        self.wait_for("running")

    def subscriber(self, log, topic, *words):
        """Debian's mosquitto_sub: a line a message, "topic payload"."""
        one = Process(["mosquitto_sub", "-p", self.port, "-v", "-t", topic, *words], log)
        return one

    def retained(self, topic, folder):
        """What who comes now gets: {topic: JSON}."""
        log = folder / "retained.log"
        late = self.subscriber(log, topic, "--retained-only", "-W", "5")
        late.process.wait(60)
        return dict(messages_in(log.read_text()))


def messages_in(text):
    for line in text.splitlines():
        topic, _, payload = line.partition(" ")
        if payload.startswith("{"):
            yield topic, json.loads(payload)


class FoxgloveClient(threading.Thread):
    """Subscribes to every topic that `wants` is true of; messages: {topic: [(time_ns, JSON)]}."""

    def __init__(self, port, wants):
        super().__init__(daemon=True)
        self.port, self.wants = port, wants
        self.topics, self.messages, self.problem = {}, {}, None
        self.ending = threading.Event()
        self.start()

    def run(self):
        try:
            self.collect()
        except Exception as problem:  # shown by who waits for messages
            self.problem = problem

    def collect(self):
        from websockets.sync.client import connect

        place = f"ws://127.0.0.1:{self.port}"
        with connect(place, subprotocols=[SUBPROTOCOL], max_size=None) as link:
            while not self.ending.is_set():
                try:
                    message = link.recv(timeout=0.2)
                except TimeoutError:
                    continue
                if isinstance(message, str):
                    self.take_control(link, json.loads(message))
                else:
                    self.take_data(message)

    def take_control(self, link, message):
        if message["op"] != "advertise":
            return
        for channel in message["channels"]:
            if channel["encoding"] != "json" or channel["schemaEncoding"] != "jsonschema":
                raise AssertionError(f"not what viewers plot: {channel}")
            self.topics[channel["id"]] = channel
            if self.wants(channel["topic"]):
                one = {"id": channel["id"], "channelId": channel["id"]}
                link.send(json.dumps({"op": "subscribe", "subscriptions": [one]}))

    def take_data(self, message):
        kind, subscription, time_ns = struct.unpack_from("<BIQ", message)
        if kind != 1:
            return
        topic = self.topics[subscription]["topic"]
        self.messages.setdefault(topic, []).append((time_ns, json.loads(message[13:])))

    def end(self):
        self.ending.set()
        self.join(20)
        if self.problem:
            raise AssertionError(f"the client of Foxglove's protocol: {self.problem!r}")


class OpcuaClient:
    """Reads what there is: {path below the server's object: value}, or raises."""

    def __init__(self, port):
        self.port = port

    def read(self):
        return asyncio.run(self._read())

    async def _read(self):
        from asyncua import Client, ua

        found = {}
        async with Client(f"opc.tcp://127.0.0.1:{self.port}/dyncal", timeout=60) as client:
            index = await client.get_namespace_index(NAMESPACE)

            async def walk(node, path):
                for child in await node.get_children():
                    below = (*path, (await child.read_browse_name()).Name)
                    if await child.read_node_class() == ua.NodeClass.Variable:
                        value = await child.read_data_value(raise_on_bad_status=False)
                        found["/".join(below)] = value
                    else:
                        await walk(child, below)

            await walk(client.get_node(ua.NodeId("dyncal", index)), ())
        return found

    def try_to_write(self):
        """What the server answers to who writes a value, and to who adds a node."""
        return asyncio.run(self._try_to_write())

    async def _try_to_write(self):
        from asyncua import Client, ua

        answers = []
        async with Client(f"opc.tcp://127.0.0.1:{self.port}/dyncal", timeout=60) as client:
            index = await client.get_namespace_index(NAMESPACE)
            root = client.get_node(ua.NodeId("dyncal", index))
            (bench, *_) = await root.get_children()
            (state, *_) = [
                one
                for one in await bench.get_children()
                if (await one.read_browse_name()).Name == "state"
            ]
            (variable, *_) = await state.get_variables()
            for attempt in (
                variable.write_value(1.0),
                variable.write_value("aborted"),
                root.add_variable(ua.NodeId("mine", index), "mine", 1.0),
            ):
                try:
                    await attempt
                    answers.append("done")
                except ua.UaError as refusal:
                    answers.append(type(refusal).__name__)
        return answers
