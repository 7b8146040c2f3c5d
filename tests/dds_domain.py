#!/usr/bin/env python3
"""A DDS domain that no other test of this machine has: dds_domain.hpp for tests in Python.

    dds_domain.py COMMAND...    runs it with DYNCAL_DOMAIN, for tests in the shell

A test that draws a domain by itself (from its process number, say) meets another sooner or later,
and then records, shows or evaluates that one's benches beside its own.
"""

import functools
import os
import socket
import subprocess
import sys

DOMAINS = 100  # their ports (7400 + 250 a domain) are below the ones that the kernel hands out


def reserve(name):
    """What keeps `name` for this process until it is closed; None if another process has it."""
    keeper = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        keeper.bind(f"\0dyncal-test-{name}")
    except OSError:
        keeper.close()
        return None
    return keeper


def reserve_dds_domain():
    """A domain, and what keeps it until it is closed: for tests that have several in turn."""
    for i in range(DOMAINS):
        domain = 1 + (os.getpid() + i) % DOMAINS
        keeper = reserve(f"dds-domain-{domain}")
        if keeper:
            return domain, keeper
    raise RuntimeError("every DDS domain for tests is in use")


@functools.cache
def kept_dds_domain():
    return reserve_dds_domain()


def own_dds_domain():
    """The same at every call of a process, and kept until it ends."""
    return kept_dds_domain()[0]


if __name__ == "__main__":
    domain = {"DYNCAL_DOMAIN": str(own_dds_domain())}
    sys.exit(subprocess.run(sys.argv[1:], env={**os.environ, **domain}, check=False).returncode)
