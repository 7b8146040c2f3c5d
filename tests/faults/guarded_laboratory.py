"""Laboratories whose exciter is guarded, for unattended_campaign.py: the generator behind a proxy
that can fail, and a path between operator and bench that fails in one direction, in both, for
datagrams, for the generator's TCP, or with a certain command in flight.

The path fails beyond the hosts' own interfaces: what they send is lost where it arrives.
"""

import subprocess
import threading
import time

from generator_proxy import GeneratorProxy
from link_campaign import SpreadLaboratory

# Of the payload of a segment with time stamps (RFC 7323), as Linux sends it.
ON = "@th,256,88 0x" + b":OUTPut1 ON".hex()
FREQUENCY = "@th,256,128 0x" + b":SOURce1:FREQuen".hex()
FOR_EVER = "timeout 1h"


class GuardedLaboratory(SpreadLaboratory):
    """Its generator is reached through a proxy, and asked directly by the campaign."""

    proxy = None
    duration_s = 1.5

    def bench_text(self):
        place = (self.generator_host(), self.ports["generator"])
        self.proxy = GeneratorProxy(
            place,
            lambda function: self.hosts.call("bench", function),
            lambda: self.hosts.enter("bench"),
        )
        text = super().bench_text()
        return text.replace(f":{place[1]}", f":{self.proxy.port}").replace(
            "duration_s = 1.5", f"duration_s = {self.duration_s}"
        )

    def ask_generator(self, line):
        return self.hosts.call("bench", lambda: self.proxy.ask_instrument(line))

    def output_is_on(self):
        return self.ask_generator(":OUTPut1?") == "ON"

    def set_by_person(self, frequency_hz):
        for line in (f":SOURce1:FREQuency {frequency_hz}", ":OUTPut1 ON"):
            self.ask_generator(f"{line}\n:SYSTem:ERRor?")

    def switch_off_by_person(self):
        self.ask_generator(":OUTPut1 OFF\n:SYSTem:ERRor?")

    def guard_words(self):
        return "".join(one.errors() for one in self.started if "dyncal-guard" in str(one.log))

    def filter_at(self, host, rules):
        """What arrives at the host goes through these rules of nftables."""
        table = f"""table ip unattended {{
            set gone {{ type ipv4_addr; flags dynamic,timeout; timeout 1h; }}
            set deaf {{ type ipv4_addr; flags dynamic,timeout; timeout 1h; }}
            chain arriving {{ type filter hook prerouting priority 0
                {rules}
            }}
        }}"""
        nft = [*self.hosts.command(host), "nft", "-f", "-"]
        subprocess.run(nft, check=True, input=table, text=True)

    def lose_path(self, kind):
        operator, bench = self.hosts.address["operator"], self.hosts.address["bench"]
        generator = f"tcp dport {self.proxy.port}"
        arriving = {
            "path": ("bench", f"ip saddr {operator} drop"),
            "to-bench": ("bench", f"ip saddr {operator} drop"),
            "from-bench": ("operator", f"ip saddr {bench} drop"),
            "datagrams": ("bench", f"ip saddr {operator} meta l4proto udp drop"),
            "generator-tcp": ("bench", f"ip saddr {operator} {generator} drop"),
        }
        self.filter_at(*arriving[kind])
        if kind == "path":
            self.lose_path_to_operator()

    def lose_path_with_on(self, heard, delivered):
        """From the next ON of the conductor on the path is gone, with that ON or just after it; not
        `heard`: the word that precedes it is lost as well."""
        operator = self.hosts.address["operator"]
        source = f"ip saddr {operator}"
        generator = f"{source} tcp dport {self.proxy.port}"
        rules = [f"{source} ip saddr @gone drop", f"{source} ip saddr @deaf meta l4proto udp drop"]
        if not heard:
            rules.append(f"{generator} {FREQUENCY} add @deaf {{ ip saddr {FOR_EVER} }} accept")
        verdict = "accept" if delivered else "drop"
        rules.append(f"{generator} {ON} add @gone {{ ip saddr {FOR_EVER} }} {verdict}")
        self.filter_at("bench", "\n".join(rules))

    def lose_path_to_operator(self):
        self.filter_at("operator", f"ip saddr {self.hosts.address['bench']} drop")

    def path_is_lost(self):
        nft = [*self.hosts.command("bench"), "nft", "list", "set", "ip", "unattended", "gone"]
        told = subprocess.run(nft, check=True, capture_output=True, text=True).stdout
        return self.hosts.address["operator"] in told

    def restore_path(self):
        for host in ("bench", "operator"):
            nft = [*self.hosts.command(host), "nft", "delete", "table", "ip", "unattended"]
            subprocess.run(nft, check=True)

    def close(self):
        if self.proxy:
            self.proxy.close()
        super().close()


class SchedulingDelay:
    """How much later than asked for this machine lets programs go on, at the worst so far."""

    INTERVAL_S = 0.02

    def __init__(self):
        self.worst_s = 0.0
        self.ends = threading.Event()
        threading.Thread(target=self.measure, daemon=True).start()

    def measure(self):
        before_s = time.monotonic()
        while not self.ends.wait(self.INTERVAL_S):
            now_s = time.monotonic()
            self.worst_s = max(self.worst_s, now_s - before_s - self.INTERVAL_S)
            before_s = now_s

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ends.set()
