"""Chromium over a pipe, in the words of its DevTools protocol: file descriptor 3 takes commands, 4
gives answers and events, JSON texts that end with a zero byte.

Needs nothing but Python and Debian's `chromium`. Every browser has a folder of its own and no
network but the host that the test serves.
"""

import base64
import json
import os
import queue
import shutil
import signal
import subprocess
import tempfile
import threading
import time

PATIENCE_S = float(os.environ.get("DYNCAL_PATIENCE_S", "30"))


class BrowserFailure(Exception):
    pass


def program():
    return shutil.which("chromium")


class Chromium:
    """script_options: of its JavaScript engine."""

    def __init__(self, script_options=()):
        self.folder = tempfile.mkdtemp(prefix="dyncal-browser-")
        to_browser, self._commands = os.pipe()
        self._answers, from_browser = os.pipe()
        options = [
            "--headless=new",
            "--remote-debugging-pipe",
            f"--user-data-dir={self.folder}/profile",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-extensions",
            "--no-first-run",
            "--no-default-browser-check",
            "--mute-audio",
            "--lang=en-US",
            f"--js-flags={' '.join(('--expose-gc', *script_options))}",
            "--enable-precise-memory-info",
        ]
        if os.geteuid() == 0:
            options.append("--no-sandbox")  # it does not start otherwise
        # A shell moves the two ends to 3 and 4: they may lie in each other's way.
        self.process = subprocess.Popen(
            ["sh", "-c", f'exec "$0" "$@" 3<&{to_browser} 4>&{from_browser}', program(), *options],
            pass_fds=(to_browser, from_browser),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "TZ": "UTC", "HOME": self.folder},
            start_new_session=True,
        )
        os.close(to_browser)
        os.close(from_browser)
        self._number = 0
        self._waiting = {}
        self._lock = threading.Lock()
        self.pages = {}
        threading.Thread(target=self._read, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        try:
            self.command("Browser.close", patience_s=5)
        except BrowserFailure:
            pass
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
        os.close(self._commands)
        shutil.rmtree(self.folder, ignore_errors=True)

    def _read(self):
        buffer = b""
        while True:
            try:
                piece = os.read(self._answers, 1 << 16)
            except OSError:
                piece = b""
            if not piece:
                break
            buffer += piece
            *texts, buffer = buffer.split(b"\0")
            for text in texts:
                self._take(json.loads(text))
        with self._lock:
            for answer in self._waiting.values():
                answer.put({"error": {"message": "the browser has ended"}})

    def _take(self, message):
        if "id" in message:
            with self._lock:
                answer = self._waiting.pop(message["id"], None)
            if answer:
                answer.put(message)
            return
        page = self.pages.get(message.get("sessionId"))
        if page:
            page.take(message["method"], message.get("params", {}))

    def command(self, method, parameters=None, session=None, patience_s=PATIENCE_S):
        answer = queue.Queue()
        with self._lock:
            self._number += 1
            message = {"id": self._number, "method": method, "params": parameters or {}}
            if session:
                message["sessionId"] = session
            self._waiting[self._number] = answer
            try:
                os.write(self._commands, json.dumps(message).encode() + b"\0")
            except OSError as problem:
                raise BrowserFailure(f"{method}: {problem}") from problem
        try:
            given = answer.get(timeout=patience_s)
        except queue.Empty:
            raise BrowserFailure(f"{method}: no answer within {patience_s} s") from None
        if "error" in given:
            raise BrowserFailure(f"{method}: {given['error']['message']}")
        return given["result"]

    def page(self, address, width=1280, height=900, dark=False):
        return Page(self, address, width, height, dark)


class Page:
    """A page of its own, with what it logged, what it threw and what it asked the network for."""

    def __init__(self, browser, address, width, height, dark):
        self.browser = browser
        self.problems = []  # errors on the console, exceptions, violations of the CSP
        self.requests = []
        self.dialogs = []
        target = browser.command("Target.createTarget", {"url": "about:blank"})["targetId"]
        self.target = target
        attached = browser.command(
            "Target.attachToTarget", {"targetId": target, "flatten": True}
        )
        self.session = attached["sessionId"]
        browser.pages[self.session] = self
        for domain in ("Runtime", "Log", "Page", "Network"):
            self.command(f"{domain}.enable")
        self.show_as(width, height, dark)
        self.open(address)

    def command(self, method, parameters=None, patience_s=PATIENCE_S):
        return self.browser.command(method, parameters, self.session, patience_s)

    def take(self, method, parameters):
        if method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            thrown = details.get("exception", {}).get("description", details.get("text"))
            self.problems.append(f"exception: {thrown}")
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "assert"):
            self.problems.append(f"console: {parameters['args']}")
        elif method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            entry = parameters["entry"]
            self.problems.append(f"log: {entry['text']} {entry.get('url', '')}")
        elif method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])
        elif method == "Page.javascriptDialogOpening":
            self.dialogs.append(parameters["message"])

    def open(self, address):
        self.command("Page.navigate", {"url": address})

    def show_as(self, width, height, dark=False, medium="screen"):
        self.command(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500},
        )
        scheme = "dark" if dark else "light"
        self.command(
            "Emulation.setEmulatedMedia",
            {"media": medium, "features": [{"name": "prefers-color-scheme", "value": scheme}]},
        )

    def value(self, expression, patience_s=PATIENCE_S):
        """What an expression of JavaScript gives; promises are waited for."""
        answer = self.command(
            "Runtime.evaluate",
            {"expression": expression, "returnByValue": True, "awaitPromise": True},
            patience_s,
        )
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            said = details.get("exception", {}).get("description", details["text"])
            raise BrowserFailure(f"{expression}: {said}")
        return answer["result"].get("value")

    def wait_for(self, expression, patience_s=PATIENCE_S):
        """Asks until the expression is true, and returns it and the seconds that it took."""
        began = time.monotonic()
        problem = ""
        while True:
            try:
                given = self.value(expression)
            except BrowserFailure as failure:  # what it asks for is not there yet
                given, problem = None, str(failure)
            took = time.monotonic() - began
            if given:
                return given, took
            if took > patience_s:
                shown = self.value("document.body?.innerText.slice(0, 1500)")
                raise BrowserFailure(
                    f"not within {patience_s} s: {expression}\n{problem}\n{shown}"
                )
            threading.Event().wait(0.02)

    def key(self, name, code, modifiers=0):
        for kind in ("keyDown", "keyUp"):
            self.command(
                "Input.dispatchKeyEvent",
                {"type": kind, "key": name, "code": name, "windowsVirtualKeyCode": code,
                 "modifiers": modifiers},
            )

    def click(self, x, y):
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            button = {} if kind == "mouseMoved" else {"button": "left", "clickCount": 1}
            self.command("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, **button})

    def heap_bytes(self):
        """Of JavaScript, after everything that nobody holds has been collected."""
        self.command("HeapProfiler.collectGarbage")
        return self.command("Runtime.getHeapUsage")["usedSize"]

    def picture(self, path, whole=True):
        parameters = {"format": "png", "captureBeyondViewport": whole}
        if whole:
            size = self.command("Page.getLayoutMetrics")["cssContentSize"]
            parameters["clip"] = {"x": 0, "y": 0, "width": size["width"],
                                  "height": size["height"], "scale": 1}
        data = self.command("Page.captureScreenshot", parameters)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))

    def close(self):
        self.browser.command("Target.closeTarget", {"targetId": self.target})
        self.browser.pages.pop(self.session, None)
