"""A generator with a fault, in front of the virtual bench's: passes SCPI lines on and back.

    sound           as it is
    ignores-off     takes :OUTPut1 OFF without an error, and stays as it is
    late            answers 0.6 s late
    mute            takes everything and answers nothing

begin() says from when on. What came is kept, with its instant and the number of its connection.
"""

import itertools
import socket
import threading
import time

FAULTS = ("sound", "ignores-off", "late", "mute")
LATE_S = 0.6


def end(connection):
    """For the thread that reads from it as well."""
    try:
        connection.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass
    connection.close()


class GeneratorProxy:
    """`call` runs a function where the instruments are, `enter` puts a thread there."""

    def __init__(self, place, call, enter):
        self.place = place
        self.enter = enter
        self.fault = "sound"
        self.link = None
        self.lock = threading.Lock()
        self.heard = []  # (monotonic s, connection, line)
        self.listener = call(lambda: socket.create_server((place[0], 0)))
        self.port = self.listener.getsockname()[1]
        self.start(self.accept)

    def start(self, function, *arguments):
        threading.Thread(target=function, args=arguments, daemon=True).start()

    def begin(self, fault):
        self.fault = fault

    def ask_instrument(self, line):
        """Past the fault, over one connection."""
        with self.lock:
            if self.link is None:
                self.link = socket.create_connection(self.place, 10.0).makefile("rw")
            self.link.write(line + "\n")
            self.link.flush()
            return self.link.readline().strip()

    def accept(self):
        self.enter()
        for connection in itertools.count():
            try:
                client, _ = self.listener.accept()
                instrument = socket.create_connection(self.place, 10.0)
            except OSError:
                return
            instrument.settimeout(None)
            self.start(self.forward, client, instrument, connection)
            self.start(self.answer, instrument, client)

    def forward(self, client, instrument, connection):
        try:
            for line in client.makefile("rb"):
                self.heard.append((time.monotonic(), connection, line.strip().decode()))
                if self.fault == "ignores-off" and line.strip().upper().endswith(b" OFF"):
                    line = b"*CLS\n"
                instrument.sendall(line)
        except OSError:
            pass
        end(instrument)

    def answer(self, instrument, client):
        try:
            for line in instrument.makefile("rb"):
                if self.fault == "late":
                    time.sleep(LATE_S)  # what this fault is
                if self.fault != "mute":
                    client.sendall(line)
        except OSError:
            pass
        end(client)

    def close(self):
        self.listener.close()
