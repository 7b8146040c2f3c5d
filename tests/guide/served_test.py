#!/usr/bin/env python3
"""dyncal-web serves the guide that is installed beside it, below /guide/.

    served_test.py GUIDE --bin PROGRAMS
"""

import argparse
import os
import pathlib
import subprocess
import sys
import time
import urllib.error
import urllib.request

import run_page

SECONDS = 60


def get(port, path):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=10) as answer:
        return answer.headers, answer.read()


def wait_for(port, program):
    deadline = time.monotonic() + SECONDS
    while True:
        try:
            return get(port, "/guide/index.html")
        except urllib.error.URLError as error:
            if program.poll() is not None or time.monotonic() > deadline:
                sys.exit(f"dyncal-web serves no guide: {error}")
            time.sleep(0.05)  # until it listens


def check(guide, port, program):
    headers, page = wait_for(port, program)
    if page != (guide / "index.html").read_bytes():
        sys.exit("/guide/index.html is another page")
    policy = headers["Content-Security-Policy"]
    for directive in ("style-src", "img-src"):
        allowed = [part for part in policy.split(";") if part.strip().startswith(directive)]
        if not allowed or "'self'" not in allowed[0]:
            sys.exit(f"the guide's pages need {directive} 'self': {policy}")
    types = {".html": "text/html", ".css": "text/css", ".svg": "image/svg+xml",
             ".png": "image/png", ".toml": ""}
    served = 0
    for path in guide.rglob("*"):
        if path.is_file():
            headers, content = get(port, f"/guide/{path.relative_to(guide)}")
            if content != path.read_bytes():
                sys.exit(f"{path.name} is served otherwise than it is")
            if not (headers["Content-Type"] or "").startswith(types[path.suffix]):
                sys.exit(f"{path.name} is served as {headers['Content-Type']}")
            served += 1
    print(f"{served} files served")
    if served < 20:
        sys.exit("these are too few")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("guide", type=pathlib.Path)
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    options = parser.parse_args()
    program = options.bin / "dyncal-web"
    if not program.exists() or not (options.guide / "index.html").exists():
        print("SKIPPED: this build has no dyncal-web, or no HTML of the guide")
        sys.exit(run_page.SKIPPED)
    domain, held_domain = run_page.reserve_dds_domain()
    port, held_port = run_page.free_port()
    with held_domain, held_port:
        running = subprocess.Popen(
            [program, "--listen", f"127.0.0.1:{port}", "--store", "none"],
            env={**os.environ, "DYNCAL_DOMAIN": str(domain)},
        )
        try:
            check(options.guide, port, running)
        finally:
            running.terminate()
            running.wait()


if __name__ == "__main__":
    main()
