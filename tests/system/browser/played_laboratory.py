"""The laboratory that is played: serves the page and scripted states as dyncal-web would, so that
the page is tested without benches, quickly, and with what no bench would ever say.

    played_laboratory.py [PORT]      to look at the page by hand
"""

import http.server
import json
import pathlib
import sys
import threading
import time
import urllib.parse

import played_figures
import played_state as state

TOP = pathlib.Path(__file__).resolve().parents[3]
PAGE = TOP / "services/programs/web/page"
JAVASCRIPT = pathlib.Path("/usr/share/javascript")
TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript",
         ".svg": "image/svg+xml", ".json": "application/json"}
TOKEN = "let me"
HOUR_MS = 3_600_000  # the clocks of conductors are ahead by it, those of sources behind
CSP = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:"


class Laboratory:
    """The state that is served; a test changes it and calls changed()."""

    def __init__(self):
        self.changes = threading.Condition()
        self.number = 1
        self.origin_ms = None  # of the played clock; None: the real one
        self.benches = {}
        self.programs = []
        self.events = []
        self.points = {}  # by bench
        self.runs = {}
        self.is_over = {}
        self.last_message_ms = {}
        self.stamp = True  # benches are heard just now
        self.may_act = True
        self.max_listeners = 20
        self.listeners = 0
        self.posted = []
        self.signal_changes = {}
        self.stream_gap_s = 0.25
        self.files = {}
        self.flag_legend = [state.FLAG]
        self.journals = {}  # by bench: what was noted of its run
        self.figure_changes = {}  # of every picture
        self.interferometers = set()  # benches that have one
        self.figures_wait = None  # an event: no figures before it is set

    def now_ms(self):
        return time.time() * 1000 if self.origin_ms is None else self.origin_ms

    def changed(self):
        with self.changes:
            self.number += 1
            self.changes.notify_all()

    def add_bench(self, name, run="run-1", **members):
        steps = len(state.FREQUENCIES) * state.REPETITIONS
        self.benches[name] = {
            "bench": name, "state": "running", "run": run, "message": "", "method":
            "sample-timestamping", "step": 1, "step_count": steps, "repetition": 1,
            "frequency_text_hz": "10", "level_m_s2": 2.5, "excitation": "steady",
            "time_left_s": 612.0, "worst": {"severity": "ok", "what": ""}, "lost": "0",
            "clock_offset_s": 3.1e-5, "clock_offset_bound_s": 1.2e-5, "results": 0,
            "results_invalid": 0, "results_flagged": 0, "recording": None, "last_result": None,
            **members}
        self.points[name] = []
        self.runs[name] = [{"run": run, "planned_utc_ms": state.BEGIN_UTC_MS, "state": "running"}]
        self.is_over[name] = False

    def measure(self, name, step, result=None):
        """The next point of a bench has come."""
        result = result or state.point(step)
        self.points[name] = [p for p in self.points[name] if p["step"] != step] + [result]
        shown = {k: result[k] for k in ("channel", "frequency_text_hz", "magnitude", "u_magnitude",
                                        "phase_rad", "u_phase_rad", "unit", "valid", "flag_names",
                                        "text")}
        points = self.points[name]
        self.benches[name].update(
            step=step, repetition=result["repetition"], level_m_s2=result["level_m_s2"],
            frequency_text_hz=result["frequency_text_hz"], last_result=shown, results=len(points),
            results_invalid=sum(not p["valid"] for p in points),
            results_flagged=sum(bool(p["flags"]) for p in points),
            lost=str(sum(p["lost"] for p in points)),
            time_left_s=12.0 * (self.benches[name]["step_count"] - step))

    def finish(self, name):
        self.is_over[name] = True
        self.benches[name].update(state="done", excitation="done", time_left_s=0.0)

    # What is asked for.

    def tile(self, name):
        heard = self.now_ms() if self.stamp else self.last_message_ms.get(name, 0)
        heard = self.last_message_ms.get(name, heard)
        return {**self.benches[name], "last_message_utc_ms": heard}

    def stamped(self, answer):
        return {"number": self.number, "now_utc_ms": self.now_ms(), **answer}

    def laboratory(self):
        now = self.now_ms()
        return self.stamped({
            "software": "dyncal played", "daemon": {"host": "here", "vendor": "fastdds",
                                                    "version": "1", "samples_missed": 0,
                                                    "visitors": self.listeners},
            "may_act": self.may_act, "has_guide": True,
            "benches": [self.tile(name) for name in self.benches],
            "programs": [{"last_message_utc_ms": now, **one} for one in self.programs],
            "events": self.events})

    def bench(self, name):
        tile = self.tile(name)
        now = self.now_ms()
        step_now = tile["step"]
        steps = []
        for i in range(tile["step_count"]):
            p = state.point(i + 1)
            done = any(q["step"] == i + 1 for q in self.points[name])
            steps.append({"step": i + 1, "frequency_text_hz": p["frequency_text_hz"],
                          "level_m_s2": p["level_m_s2"], "repetition": p["repetition"],
                          "settling_s": 1.0, "duration_s": 10.0, "attempt": 1,
                          "state": "done" if done else
                                   (tile["excitation"] if i + 1 == step_now else "open")})
        return self.stamped({
            **tile, "sources": state.sources(self.last_message_ms.get(name, now)),
            "plan": {"run": tile["run"], "state": tile["state"], "message": "", "method":
                     tile["method"], "reference": "acs/reference", "sync_acs": "acs/sync",
                     "sync_dau": "dau/sync", "sync_dso": "", "dut": [state.CHANNEL],
                     "recipe": "", "recipe_sha256": "", "conductor": "dyncal run", "steps": steps},
            "now": {"step": step_now, "state": tile["excitation"],
                    "begin_utc_ms": now + HOUR_MS - 3000, "end_utc_ms": now + HOUR_MS + 7000,
                    "time_left_s": 7.0},
            "messages": [e for e in self.events if e["bench"] == name]})

    def run(self, name, run=None):
        is_over = self.is_over[name]
        return self.stamped({
            "bench": name, "run": run or self.benches[name]["run"],
            "state": self.benches[name]["state"], "message": "", "points": self.points[name],
            "transfer_function": state.transfer(self.points[name]) if is_over else [],
            "channels": [state.channel()] if is_over else [], "flag_legend": self.flag_legend,
            "sample_clock": [state.clock_report()] if is_over else [], "runs": self.runs[name],
            "files": [{"name": n, "bytes": len(t), "href": f"/files/{name}/run-1/{n}"}
                      for n, t in self.files.items()]})

    def journal(self, name, run):
        return {"bench": name, "run": run, "conducted_by": "", "comment": "", "left_out": 0,
                "entries": [], **self.journals.get(name, {})}

    def figures(self, name, run=None, channel="", bars="U"):
        points = [p for p in self.points[name] if p["channel"] == channel]
        if not points:
            raise KeyError(channel)
        is_over = self.is_over[name]
        line = f"bench {name}, run {run}"
        pictures = played_figures.of_channel(
            channel, line, points, state.transfer(points), is_over, bars)
        if is_over:
            pictures += played_figures.of_clock(state.clock_report(), line)
        if name in self.interferometers:
            pictures += played_figures.of_interferometer("acs/displacement", line)
        return {"number": self.number, "bench": name, "run": run, "channel": channel,
                "bars": bars, "pictures": [{**one, **self.figure_changes} for one in pictures]}

    def signal(self, name, source, channel, seconds, columns):
        amplitude = 9.2 if channel == "x_acceleration" else 0.5
        return {**state.signal(float(seconds), int(columns), self.now_ms() - HOUR_MS,
                               self.number, amplitude),
                "source": source, "channel": channel, "now_utc_ms": self.now_ms(),
                **self.signal_changes}


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def send(self, status, body, kind="application/json", **headers):
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Content-Security-Policy", CSP)
        self.send_header("X-Content-Type-Options", "nosniff")
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(body)

    def give(self, answer, status=200):
        self.send(status, json.dumps(answer).encode())

    def refuse(self, status, message):
        self.give({"error": {"code": "refused", "message": message}}, status)

    def do_GET(self):
        url = urllib.parse.urlsplit(self.path)
        asked = dict(urllib.parse.parse_qsl(url.query))
        parts = [urllib.parse.unquote(part) for part in url.path.split("/")[1:]]
        if self.server.is_ending:  # a connection that was kept open dies with its server
            self.close_connection = True
            return
        self.server.asked.append(self.path)
        try:
            self.answer(parts, asked)
        except (BrokenPipeError, ConnectionResetError):
            pass
        except KeyError as missing:
            self.refuse(404, f"there is no {missing}")

    def answer(self, parts, asked):
        lab = self.server.laboratory
        if parts[0] in ("", "page", "javascript"):
            self.send_file(parts)
        elif parts == ["events"]:
            self.stream(asked)
        elif parts == ["api", "laboratory"]:
            self.give(lab.laboratory())
        elif parts == ["api", "history"]:
            self.give(state.history(asked.get("sensor")))
        elif parts == ["api", "bench-files"]:
            if self.may_act():
                self.give({"files": [{"file": "acc-1.toml", "bench": "acc-1"}],
                           "members": ["run"]})
        elif parts[:2] == ["api", "bench"]:
            self.answer_bench(parts[2], parts[3:], asked)
        elif parts[0] == "files":
            self.send(200, lab.files[parts[-1]].encode(),
                      TYPES.get(pathlib.Path(parts[-1]).suffix, "application/octet-stream"))
        else:
            self.refuse(404, "there is no such page")

    def answer_bench(self, name, rest, asked):
        lab = self.server.laboratory
        if not rest:
            self.give(lab.bench(name))
        elif rest == ["run"]:
            self.give(lab.run(name, asked.get("run")))
        elif rest == ["figures"]:
            answer = lab.figures(name, **asked)
            if lab.figures_wait is not None:
                lab.figures_wait.wait()
            self.give(answer)
        elif rest == ["journal"]:
            self.give(lab.journal(name, asked["run"]))
        elif rest == ["budget"]:
            asked.pop("run")
            self.give(state.budget(**asked))
        elif rest == ["signal"]:
            self.give(lab.signal(name, **asked))
        elif rest == ["spectrum"]:
            self.give(state.spectrum())
        elif rest == ["fit"]:
            self.give(state.fit())

    def send_file(self, parts):
        path = {"": PAGE / "index.html"}.get(parts[0])
        if parts[0] == "page":
            path = PAGE / parts[1]
        elif parts[0] == "javascript":
            path = JAVASCRIPT.joinpath(*parts[1:])
        if ".." in parts or not path.is_file():
            self.refuse(404, "there is no such file")
            return
        self.send(200, path.read_bytes(), TYPES.get(path.suffix, "application/octet-stream"))

    def stream(self, asked):
        lab = self.server.laboratory
        if lab.listeners >= lab.max_listeners:
            self.refuse(503, "too many visitors")
            return
        lab.listeners += 1
        try:
            self.send_response(200)
            self.send_header("Content-Type", "text/event-stream")
            self.send_header("Content-Security-Policy", CSP)
            self.send_header("Connection", "close")
            self.end_headers()
            self.wfile.write(b"retry: 1000\n\n")
            shown = None
            while not self.server.is_ending:
                shown = self.send_events(asked, shown)
        finally:
            lab.listeners -= 1

    def send_events(self, asked, shown):
        """shown: number of the results that were sent last; they are sent when they change."""
        lab = self.server.laboratory
        bench = asked.get("bench")
        sent = lab.number
        self.event("laboratory", lab.laboratory())
        if bench in lab.benches:
            self.event("bench", lab.bench(bench))
            if sent != shown:
                self.event("run", lab.run(bench))
            if "signal" in asked:
                source, channel = asked["signal"].split("/", 1)
                self.event("signal", lab.signal(bench, source, channel, asked["seconds"],
                                                asked["columns"]))
        self.wfile.flush()
        with lab.changes:
            lab.changes.wait_for(lambda: lab.number != sent or self.server.is_ending,
                                 timeout=lab.stream_gap_s)
        return sent

    def event(self, name, data):
        text = json.dumps(data)
        self.wfile.write(f"event: {name}\nid: {data['number']}\ndata: {text}\n\n".encode())

    def may_act(self):
        if self.headers.get("Authorization") == f"Bearer {TOKEN}":
            return True
        self.refuse(401, "wrong token")
        return False

    def do_POST(self):
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if self.may_act():
            self.server.laboratory.posted.append((self.path, json.loads(body)))
            self.give({"answer": "accepted", "by": "dyncal-analysis", "message": "as you wish"})


class PlayedServer:
    """Serves a laboratory; stop() and start() again play a restart of the daemon."""

    def __init__(self, laboratory, port=0):
        self.laboratory = laboratory
        self.port = port
        self.asked = []
        self.server = None
        self.start()

    def start(self):
        http.server.ThreadingHTTPServer.allow_reuse_address = True
        server = http.server.ThreadingHTTPServer(("127.0.0.1", self.port), Handler)
        server.daemon_threads = True
        server.block_on_close = False
        server.laboratory = self.laboratory
        server.asked = self.asked
        server.is_ending = False
        self.server = server
        self.port = server.server_address[1]
        threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}/"

    def stop(self):
        self.server.is_ending = True
        self.laboratory.changed()
        self.server.shutdown()
        self.server.server_close()


def example():
    """Three benches: one in the middle of its run, one done, one silent."""
    lab = Laboratory()
    lab.add_bench("acc-1")
    lab.add_bench("acc-2", worst={"severity": "warning", "what": "dau: 12 samples lost"})
    lab.add_bench("gyro", state="silent", message="dyncal-analysis has stopped",
                  worst={"severity": "error", "what": "no analysis answers"})
    for step in range(1, 25):
        lab.measure("acc-1", step)
    for step in range(1, 52):
        lab.measure("acc-2", step)
    lab.finish("acc-2")
    for step in range(1, 8):
        lab.measure("gyro", step)
    lab.last_message_ms["gyro"] = time.time() * 1000 - 93000
    lab.benches["acc-1"]["recording"] = {"state": "recording", "file": "acc-1.mcap",
                                         "messages_stored": "81234",
                                         "messages_not_stored": "0", "message": ""}
    for bench, host in (("acc-1", "lab-1"), ("acc-2", "lab-2")):
        for kind in ("dau", "acs", "analysis"):
            lab.programs.append({
                "name": f"dyncal-{kind}", "kind": kind, "bench": bench, "host": host,
                "process_id": 4711 + len(lab.programs), "version": "1.4.0", "message": "",
                "vendor": "cyclonedds" if kind == "acs" else "fastdds", "health": "ok",
                "clock_offset_s": 3.1e-5, "clock_offset_bound_s": 1.2e-5})
    lab.programs.append({**lab.programs[0], "bench": "gyro", "name": "dyncal-analysis",
                         "health": "silent", "message": "last heard before it stopped",
                         "last_message_utc_ms": lab.last_message_ms["gyro"]})
    now = time.time() * 1000
    lab.events = [
        {"utc_ms": now - 600000, "bench": "acc-2", "severity": "note", "text": "run-1 planned"},
        {"utc_ms": now - 300000, "bench": "acc-2", "severity": "warning",
         "text": "step 9: dau: samples lost"},
        {"utc_ms": now - 93000, "bench": "gyro", "severity": "error",
         "text": "dyncal-analysis is silent"},
        {"utc_ms": now - 20000, "bench": "acc-2", "severity": "ok", "text": "run-1 done"}]
    lab.journals["acc-2"] = {
        "conducted_by": "A. Meter (meter on lab-2)", "comment": "after the move",
        "entries": [
            {"utc_ms": state.BEGIN_UTC_MS + 60000, "kind": "event", "by": "A. Meter",
             "text": "the run has paused for 31 s"},
            {"utc_ms": state.BEGIN_UTC_MS + 90000, "kind": "note", "by": "B. Other",
             "text": "the door was open"},
            {"utc_ms": state.BEGIN_UTC_MS + 7200000, "kind": "amendment", "by": "A. Meter",
             "text": "serial number of dau corrected to 2 on 2026-11-22 by A. Meter: misread"}]}
    lab.files = {"result.json": "{}", "transfer_function.svg":
                 '<svg xmlns="http://www.w3.org/2000/svg" width="80" height="40"/>'}
    return lab


if __name__ == "__main__":
    played = PlayedServer(example(), int(sys.argv[1]) if len(sys.argv) > 1 else 8099)
    print(played.address)
    threading.Event().wait()
