"""What the tests of the page share: a browser a file, a played laboratory a test, and the end of a
test that asks whether the page stayed quiet: nothing on the console, no request to elsewhere."""

import pathlib
import sys
import unittest

import chromium
from played_laboratory import Laboratory, PlayedServer

SKIPPED = 77
DYGRAPHS = pathlib.Path("/usr/share/javascript/dygraphs/dygraph.min.js")


def missing():
    """What cannot be had here, or nothing."""
    if chromium.program() is None:
        return "no chromium (Debian: chromium)"
    if not DYGRAPHS.is_file():
        return f"no {DYGRAPHS} (Debian: libjs-dygraphs)"
    return None


def run():
    """In place of unittest.main(): skips loudly where the browser is missing."""
    reason = missing()
    if reason:
        print(f"skipped: {reason}")
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)


class PageCase(unittest.TestCase):
    script_options = ()  # of the browser

    @classmethod
    def setUpClass(cls):
        cls.browser = chromium.Chromium(cls.script_options)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def setUp(self):
        self.laboratory = Laboratory()
        self.server = PlayedServer(self.laboratory)
        self.pages = []
        self.allowed_problems = []  # parts of texts that a test provokes

    def tearDown(self):
        try:
            while self.pages:
                self.close(self.pages[-1])
        finally:
            for page in self.pages:
                page.close()
            self.server.stop()

    def close(self, page):
        """A page that was quiet until its end. A browser has six connections to a server: more than
        six pages at once would wait for each other."""
        self.pages.remove(page)
        page.close()
        problems = [p for p in page.problems
                    if not any(part in p for part in self.allowed_problems)]
        self.assertEqual(problems, [], "the console is not quiet")
        elsewhere = [r for r in page.requests
                     if not r.startswith((self.server.address, "data:", "blob:", "about:"))]
        self.assertEqual(elsewhere, [], "requests leave the origin")
        self.assertGreater(len(page.requests), 10, "the page asked for nothing")
        self.assertEqual(page.dialogs, [])

    def open(self, view="", width=1280, height=900, dark=False):
        page = self.browser.page(f"{self.server.address}#/{view}", width, height, dark)
        self.pages.append(page)
        page.wait_for(connection_is("live"))
        return page


def connection_is(state):
    return f"document.querySelector('#connection').dataset.state === '{state}'"


def text_of(selector):
    return f"document.querySelector({selector!r})?.textContent"


def texts_of(selector):
    return f"[...document.querySelectorAll({selector!r})].map(e => e.textContent)"


def rows_of_chart(chart, canvases=".canvas"):
    """What a chart of the page draws: rows of x and [low, y, high] of each layer."""
    return (f"(g => [...Array(g.numRows()).keys()].map(r => [...Array(g.numColumns()).keys()]"
            ".map(c => c === 0 ? g.getValue(r, c) : g.getValue(r, c) ?? [null])))"
            f"(document.querySelectorAll({canvases!r})[{chart}].graph)")


def choose(page, value):
    """An option of the only list that has it."""
    page.value(f"(s => {{ s.value = {value!r}; s.dispatchEvent(new Event('change')); }})"
               "([...document.querySelectorAll('select')].find(s => [...s.options].some(o => "
               f"o.value === {value!r})))")


def drawn_pixels(chart):
    return (f"(c => c ? (d => {{ let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; "
            "return n; })(c.getContext('2d').getImageData(0, 0, c.width, c.height).data) : 0)"
            f"(document.querySelectorAll('.canvas')[{chart}]?.querySelector('canvas'))")
