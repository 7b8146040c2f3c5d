#!/usr/bin/env python3
"""The page over TLS: by a certificate of dyncal-web's own, and behind nginx as shipped.

    web_encryption_test.py DYNCAL_WEB NGINX_CONF own_certificate|behind_nginx

Both ways: the page, an event, an action with and without the token, and of another page.
"""

import http.client
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

NAME = "calibration.example.org"
TOKEN = "0123456789abcdef0123456789abcdef"
READY_S = 60
NGINX = shutil.which("nginx", path="/usr/sbin:/usr/bin")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Programs:
    """What a test has started; all of it is ended with it."""

    def __init__(self):
        self.started = []

    def start(self, arguments, log):
        with open(log, "wb") as output:
            self.started.append(
                subprocess.Popen(arguments, stdout=output, stderr=output, start_new_session=True)
            )

    def end(self):
        for program in self.started:
            os.killpg(program.pid, signal.SIGTERM)
        for program in self.started:
            program.wait()


def wait_for(what, log):
    """What `what` returns, once it returns something."""
    end = time.monotonic() + READY_S
    while time.monotonic() < end:
        if (found := what()) is not None:
            return found
        time.sleep(0.05)
    raise AssertionError(log.read_text(errors="replace"))


class Encryption(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="dyncal-encryption-")
        self.folder = pathlib.Path(self.temporary.name)
        self.programs = Programs()
        self.addCleanup(self.temporary.cleanup)
        self.addCleanup(self.programs.end)
        self.certificate = self.folder / "page.pem"
        self.key = self.folder / "page-key.pem"
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256",
             "-nodes", "-keyout", self.key, "-out", self.certificate, "-days", "2", "-subj",
             f"/CN={NAME}", "-addext", f"subjectAltName=DNS:{NAME}"],
            check=True, capture_output=True,
        )  # fmt: skip
        token = self.folder / "token"
        token.write_text(f"operate ada {TOKEN}\n")
        token.chmod(0o400)
        self.token_file = token

    def start_web(self, *options):
        log = self.folder / "web.log"
        self.programs.start(
            [WEB, "--domain", str(own_dds_domain()), "--listen", "127.0.0.1:0", "--own-name", NAME,
             "--token-file", self.token_file, *options],
            log,
        )  # fmt: skip

        def port():
            found = re.search(r"page at (https?)://127\.0\.0\.1:(\d+)/", log.read_text())
            return found and (found.group(1), int(found.group(2)))

        return wait_for(port, log)

    def connect(self, port):
        """As a browser that knows the certificate, which is held against the name."""
        context = ssl.create_default_context(cafile=str(self.certificate))
        connection = http.client.HTTPSConnection("127.0.0.1", port, context=context, timeout=30)
        plain = socket.create_connection(("127.0.0.1", port), timeout=30)
        connection.sock = context.wrap_socket(plain, server_hostname=NAME)
        self.addCleanup(connection.close)
        return connection

    def ask(self, port, method, path, body=None, **headers):
        connection = self.connect(port)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        host = f"{NAME}:{port}"
        connection.request(method, path, body, {"Host": host, "Origin": f"https://{host}", **named})
        answer = connection.getresponse()
        return answer.status, answer.read()

    def check_page(self, port):
        status, page = self.ask(port, "GET", "/")
        self.assertEqual(status, 200)
        self.assertIn(b"</html>", page)
        status, state = self.ask(port, "GET", "/api/laboratory")
        self.assertEqual(status, 200)
        self.assertTrue(json.loads(state)["may_act"])
        connection = self.connect(port)
        connection.request("GET", "/events", headers={"Host": f"{NAME}:{port}"})
        self.assertIn(b"event", connection.getresponse().read1(4096))
        action = {"Content_Type": "application/json"}
        body = json.dumps({"command": "abort", "run": "r1"})
        status, _ = self.ask(port, "POST", "/api/bench/acc-1/command", body, **action)
        self.assertEqual(status, 401)
        action["Authorization"] = f"Bearer {TOKEN}"
        status, answer = self.ask(port, "POST", "/api/bench/acc-1/command", body, **action)
        self.assertEqual(status, 409, answer)
        self.assertIn(b"no conductor", answer)
        action["Origin"] = "https://elsewhere.example.org"
        status, answer = self.ask(port, "POST", "/api/bench/acc-1/command", body, **action)
        self.assertEqual(status, 403, answer)
        self.assertIn(" of ada, ", (self.folder / "web.log").read_text())

    def test_own_certificate(self):
        scheme, port = self.start_web("--tls-certificate", self.certificate, "--tls-key", self.key)
        self.assertEqual(scheme, "https")
        self.check_page(port)
        with socket.create_connection(("127.0.0.1", port), timeout=30) as plain:
            plain.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
            self.assertIn(b"https://", plain.recv(4096))

    def test_behind_nginx(self):
        scheme, web_port = self.start_web()
        self.assertEqual(scheme, "http")
        port = free_port()
        text = pathlib.Path(NGINX_CONF).read_text()
        for shipped, here in (
            ("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"),
            ("/etc/ssl/calibration.pem", str(self.certificate)),
            ("/etc/ssl/private/calibration-key.pem", str(self.key)),
            ("http://127.0.0.1:8080", f"http://127.0.0.1:{web_port}"),
        ):
            self.assertIn(shipped, text)
            text = text.replace(shipped, here)
        folders = "".join(
            f"  {kind}_temp_path {self.folder}/{kind};\n"
            for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
        )
        log = self.folder / "nginx.log"
        conf = self.folder / "nginx.conf"
        conf.write_text(
            f"daemon off;\nuser root;\npid {self.folder}/nginx.pid;\nerror_log {log};\n"
            f"events {{}}\nhttp {{\n  access_log off;\n{folders}{text}}}\n"
        )
        self.programs.start([NGINX, "-c", conf, "-p", self.folder], log)

        def listens():
            with socket.socket() as probe:
                return True if probe.connect_ex(("127.0.0.1", port)) == 0 else None

        wait_for(listens, log)
        self.check_page(port)


if __name__ == "__main__":
    WEB, NGINX_CONF, WAY = sys.argv[1:4]
    if WAY == "behind_nginx" and NGINX is None:
        print("skipped: nginx is not installed")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], f"Encryption.test_{WAY}"])
