"""Hosts of a laboratory as network namespaces at one switch. Needs root and Debian's iproute2.

Each host has an interface `lab` whose link can be taken down; nothing reaches the network of the
machine itself. close() removes all of them.
"""

import concurrent.futures
import ctypes
import itertools
import os
import pathlib
import subprocess

CLONE_NEWNET = 0x40000000
SWITCH = "switch"


def ip(*arguments):
    subprocess.run(["ip", *map(str, arguments)], check=True, capture_output=True)


def can_be_made():
    """Whether this machine makes network namespaces for this user."""
    name = f"dyncal-probe-{os.getpid()}"
    made = subprocess.run(["ip", "netns", "add", name], check=False, capture_output=True)
    if made.returncode == 0:
        ip("netns", "delete", name)
    return made.returncode == 0


class Hosts:
    numbers = itertools.count(1)

    def __init__(self, names):
        self.names = names
        self.address = {}
        self.prefix = f"dyncal-{os.getpid()}-{next(Hosts.numbers)}"
        self.callers = {}
        for name in (SWITCH, *names):
            ip("netns", "add", self.namespace(name))
            self.set_link(name, "lo", "up")
        ip("-n", self.namespace(SWITCH), "link", "add", "bridge", "type", "bridge")
        self.set_link(SWITCH, "bridge", "up")
        for number, name in enumerate(names, start=1):
            self.connect(name, f"10.98.0.{number}")

    def namespace(self, name):
        return f"{self.prefix}-{name}"

    def connect(self, name, address):
        here, switch = self.namespace(name), self.namespace(SWITCH)
        port = self.port(name)
        ip("-n", here, "link", "add", "lab", "type", "veth", "peer", "name", port, "netns", switch)
        ip("-n", switch, "link", "set", port, "master", "bridge", "up")
        ip("-n", here, "address", "add", f"{address}/24", "dev", "lab")
        self.set_link(name, "lab", "up")
        self.address[name] = address

    def set_link(self, name, interface, state):
        ip("-n", self.namespace(name), "link", "set", interface, state)

    def set_cable(self, name, state):
        """At the switch, so that the host sees what it sees when a cable is pulled."""
        self.set_link(SWITCH, self.port(name), state)

    @staticmethod
    def port(name):
        """Of the switch."""
        return f"to-{name}"

    def disturb(self, loss_percent, mbit_per_s=0, lost="udp"):
        """As bad_network.sh has it; 0: no loss, unlimited. `lost`: "udp" or "udp, tcp"."""
        address = " ".join(f"[{name}]={place}" for name, place in self.address.items())
        script = pathlib.Path(__file__).with_name("bad_network.sh")
        commands = (
            f". {script}; subject=; prefix={self.prefix}; hosts=({' '.join(self.names)}); "
            f"declare -A address=({address}); limit {mbit_per_s}; "
            f"disturb {loss_percent} '{lost}'"
        )
        done = subprocess.run(
            ["bash", "-e", "-c", commands], check=False, capture_output=True, text=True
        )
        if done.returncode != 0:
            raise OSError(f"bad_network.sh: {done.stdout}{done.stderr}")

    def command(self, name):
        return ["ip", "netns", "exec", self.namespace(name)]

    def call(self, name, function):
        """In a thread that is on this host."""
        if name not in self.callers:
            self.callers[name] = concurrent.futures.ThreadPoolExecutor(
                1, initializer=self.enter, initargs=(name,)
            )
        return self.callers[name].submit(function).result()

    def enter(self, name):
        path = pathlib.Path("/run/netns") / self.namespace(name)
        with open(path, encoding="utf-8") as namespace:
            if ctypes.CDLL(None, use_errno=True).setns(namespace.fileno(), CLONE_NEWNET) != 0:
                raise OSError(ctypes.get_errno(), f"cannot enter {path}")

    def close(self):
        for caller in self.callers.values():
            caller.shutdown()
        for name in (*self.names, SWITCH):
            ip("netns", "delete", self.namespace(name))
