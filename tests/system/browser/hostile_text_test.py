#!/usr/bin/env python3
"""Names and messages that come from the network never become markup, requests or scripts, and never
hide or turn what stands beside them. The page's own sources hold nothing that could do it."""

import re
import time

import played_figures
import played_state
from page_case import PageCase, run, texts_of
from played_laboratory import PAGE

IMAGE = "<img src=x onerror=alert(1)>"
HOSTILE = [
    IMAGE,
    "\"'><script>alert(2)</script>",
    "</textarea></style><svg onload=alert(3)>",
    "javascript:alert(4)",
    "\u202egnp.exe\u2066",
    "very " * 2000,
    "%2F..%2F..%2Fetc/passwd?#&a=b",
    "{{constructor.constructor('alert(5)')()}}",
    "\x00\x1b[31m",
]
# What makes markup or code of text.
FORBIDDEN = re.compile(
    r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|DOMParser|createContextualFragment"
    r"|srcdoc|\beval\b|new Function|setHTML|XSLTProcessor|https?://|//cdn|importScripts"
    r"|localStorage|sessionStorage|document\.cookie"
)
INLINE = re.compile(r"<script(?![^>]*\bsrc=)|\son\w+\s*=|\sstyle\s*=|<style", re.I)
MAX_LINES = 400


class HostileText(PageCase):
    def setUp(self):
        super().setUp()
        self.allowed_problems = ["404"]  # of a bench that cannot be asked for by such a name
        now = time.time() * 1000
        for text in HOSTILE:
            self.laboratory.add_bench(text, run=text, message=text,
                                      worst={"severity": "error", "what": text},
                                      frequency_text_hz=text)
            self.laboratory.programs.append({
                "name": text, "kind": text, "bench": text, "host": text, "process_id": 1,
                "version": text, "vendor": text, "health": text, "message": text,
                "clock_offset_s": None, "clock_offset_bound_s": None})
            self.laboratory.events.append({"utc_ms": now, "bench": text, "severity": text,
                                           "text": text})
        bench = self.laboratory.benches[IMAGE]
        bench["recording"] = {"state": IMAGE, "file": IMAGE,
                              "messages_stored": IMAGE, "messages_not_stored": IMAGE,
                              "message": IMAGE}
        result = {**played_state.point(1), "channel": f"dau/{IMAGE}", "unit": IMAGE,
                  "frequency_text_hz": IMAGE,
                  "flags": HOSTILE, "flag_names": HOSTILE}
        self.laboratory.flag_legend = [
            {"name": t, "sentences": [t], "meaning": t} for t in HOSTILE]
        self.laboratory.measure(IMAGE, 1, result)
        self.laboratory.measure(IMAGE, 2, {**result, "step": 2, "valid": False, "problem": IMAGE})
        figure = {**played_figures.panel(IMAGE, IMAGE), "band_label": IMAGE, "dots_label": IMAGE,
                  "colour": IMAGE, "band": [[1, 2, 3], [2, 2, 3]], "dots": [[1, 2]]}
        series = [played_figures.one_series(text, [[10, 1, 0.1, 1]], colour=text, marker=text,
                                            dashes=text) for text in HOSTILE]
        self.laboratory.figure_changes = {
            "title": HOSTILE[5] + IMAGE, "subtitle": IMAGE,
            "panels": [figure, {**figure, "x_label": HOSTILE[5], "y_label": HOSTILE[5],
                                "series": series}]}
        self.laboratory.files = {IMAGE: "", "a.svg": "<svg/>"}
        self.laboratory.journals[IMAGE] = {
            "conducted_by": IMAGE, "comment": HOSTILE[5], "problem": IMAGE,
            "entries": [{"utc_ms": now, "kind": text, "by": text, "text": text}
                        for text in HOSTILE]}
        self.laboratory.signal_changes = {"unit": IMAGE, "channel": "x_acceleration"}

    def assert_harmless(self, page):
        self.assertEqual(page.value("document.querySelectorAll("
                                    "'img, script:not([src]), svg, iframe, object').length"), 0)
        self.assertEqual(page.value("[...document.querySelectorAll('*')].filter(e => "
                                    "[...e.attributes].some(a => a.name.startsWith('on')))"
                                    ".map(e => e.outerHTML)"), [])
        hrefs = page.value("[...document.querySelectorAll('a')].map(a => a.getAttribute('href'))")
        self.assertEqual([h for h in hrefs if not h.startswith(("#/", "/files/", "/guide/"))], [])
        self.assertNotRegex(page.value("document.body.textContent"), "[\u202a-\u202e\u2066-\u2069]")
        self.assertLessEqual(page.value("document.documentElement.scrollWidth"),
                             page.value("window.innerWidth"))

    def test_laboratory(self):
        page = self.open(width=360)
        page.wait_for(f"document.querySelectorAll('.tile').length === {len(HOSTILE)}")
        page.wait_for(f"document.querySelectorAll('.events li').length === {len(HOSTILE)}")
        titles = page.value(texts_of(".tile h3"))
        self.assertIn(IMAGE, titles)
        self.assertIn("⟨U+202E⟩gnp.exe⟨U+2066⟩", titles)
        self.assertLess(max(map(len, titles)), 60)
        self.assert_harmless(page)

    def test_bench(self):
        page = self.open("bench/" + quoted(IMAGE))
        page.wait_for("document.querySelectorAll('.band li').length === 51")
        page.wait_for("document.querySelector('[data-field=level]').textContent.includes('peak')")
        self.assertIn(IMAGE, page.value("document.querySelector('h1').textContent"))
        self.assertIn(f"value in {IMAGE}", page.value(texts_of(".y-label")))
        self.assert_harmless(page)

    def test_run(self):
        page = self.open("run/" + quoted(IMAGE))
        page.wait_for("document.querySelectorAll('[data-step]').length === 2")
        text = page.value("document.querySelector('[data-panel=flags]').textContent")
        self.assertIn(IMAGE, text)
        self.assertEqual(page.value(texts_of(".files a")), [IMAGE, "a.svg"])
        page.wait_for(f"document.querySelectorAll('[data-entry]').length === {len(HOSTILE)}")
        notes = page.value(texts_of("[data-entry] td"))
        self.assertEqual(notes[0], IMAGE)
        self.assertIn("⟨U+202E⟩gnp.exe⟨U+2066⟩", notes)
        self.assertLess(max(map(len, notes)), 610)
        page.wait_for("document.querySelectorAll('.picture .canvas').length === 4")
        self.assertEqual(page.value(texts_of(".picture .y-label"))[0], IMAGE)
        legends = page.value(texts_of(".picture .legend li span"))
        self.assertIn(HOSTILE[1], legends)
        self.assertIn("⟨U+202E⟩gnp.exe⟨U+2066⟩", legends)
        self.assertLess(max(map(len, legends)), 130)
        page.value("document.querySelector('[data-step=\"1\"] button').click()")
        page.wait_for("document.querySelectorAll('[data-panel=budget] tbody tr').length === 5")
        self.assert_harmless(page)

    def test_files_elsewhere_are_no_links(self):
        page = self.open()
        given = page.value(
            "import('/page/foreign_text.js').then(m => ['javascript:alert(1)', '//evil.example/', "
            "'http://evil.example/files/a', 'data:text/html,a', '/files/../api/x', '/files/a b'"
            "].map(m.download_path))")
        self.assertEqual(given, [None, None, None, None, None, "/files/a%20b"])

    def test_script_within_the_page_is_refused(self):
        self.allowed_problems = ["Content Security Policy", "Content-Security-Policy"]
        page = self.open()
        page.value("(s => { s.textContent = 'window.injected = true'; document.body.append(s); })"
                   "(document.createElement('script'))")
        page.value("(i => { i.src = 'http://127.0.0.1:9/x.png'; document.body.append(i); })"
                   "(new Image())")
        page.wait_for("document.images.length === 1")
        self.assertIsNone(page.value("window.injected"))
        self.assertTrue(any("Content Security Policy" in p for p in page.problems), page.problems)
        page.requests = [r for r in page.requests if "127.0.0.1:9/" not in r]


class Sources(PageCase):
    @classmethod
    def setUpClass(cls):
        pass

    tearDownClass = setUpClass

    def setUp(self):
        pass

    tearDown = setUp

    def test_nothing_in_the_sources_makes_markup_of_text(self):
        paths = [p for p in PAGE.iterdir() if p.suffix in (".js", ".html", ".css")]
        self.assertGreater(len(paths), 20)
        for path in paths:
            text = path.read_text()
            self.assertEqual(FORBIDDEN.findall(text), [], path)
            self.assertLess(text.count("\n"), MAX_LINES, path)
            if path.suffix == ".html":
                self.assertEqual(INLINE.findall(text), [], path)
            if path.suffix == ".js":
                self.assertTrue(text.startswith("/**\n * "), f"{path} does not say what it is for")

    def test_the_checks_find_what_they_are_for(self):
        self.assertTrue(FORBIDDEN.search("node.innerHTML = x"))
        self.assertTrue(FORBIDDEN.search("fetch('https://elsewhere')"))
        self.assertTrue(INLINE.search("<a onclick=x>"))
        self.assertTrue(INLINE.search("<script>x</script>"))
        self.assertFalse(INLINE.search('<script src="/page/main.js" type="module"></script>'))


def quoted(text):
    return "".join(f"%{byte:02X}" for byte in text.encode())


if __name__ == "__main__":
    run()
