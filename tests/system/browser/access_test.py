#!/usr/bin/env python3
"""Everybody can use the page: on a phone, with the keyboard alone, with a screen reader, in light
and dark, on paper."""

from page_case import PageCase, run
from played_laboratory import example

VIEWS = ["", "bench/acc-1", "run/acc-2", "history"]
READY = {"": "document.querySelectorAll('.tile').length === 3",
         "bench/acc-1": "document.querySelectorAll('.band li').length === 51 && "
                        "document.querySelector('[data-field=fit_reference]').textContent !== ''",
         "run/acc-2": "document.querySelectorAll('[data-step]').length === 51",
         "history": "document.querySelectorAll('[data-panel=en] tbody tr').length === 34"}
MIN_CONTRAST = 4.5

# Every visible text with its contrast against the ground that is really behind it.
CONTRASTS = """
(() => {
  const numbers = (c) => c.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((v) => v / 255)
    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const ground = (e) => {
    for (let at = e; at; at = at.parentElement) {
      const c = numbers(getComputedStyle(at).backgroundColor);
      if (c.length === 3 || c[3] > 0.99) return c;
    }
    return numbers(getComputedStyle(document.documentElement).backgroundColor);
  };
  const found = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const e = walk.currentNode.parentElement;
    const box = e.getBoundingClientRect();
    if (!walk.currentNode.textContent.trim() || box.width === 0 || !e.checkVisibility()) continue;
    if (e.closest('.only-read, .skip, option, noscript')) continue;
    const [a, b] = [light(numbers(getComputedStyle(e).color)), light(ground(e))];
    found.push([(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05),
                walk.currentNode.textContent.trim().slice(0, 40), e.className]);
  }
  return found;
})()
"""


class Access(PageCase):
    def setUp(self):
        super().setUp()
        self.laboratory = example()
        self.server.laboratory = self.server.server.laboratory = self.laboratory

    def open_ready(self, view, **options):
        page = self.open(view, **options)
        page.wait_for(READY[view])
        return page

    def test_phone_needs_no_scrolling_sideways(self):
        for view in VIEWS:
            page = self.open_ready(view, width=360, height=740)
            self.assertEqual(page.value("document.documentElement.scrollWidth"), 360, view)
            wide = page.value("[...document.querySelectorAll('main *')].filter(e => "
                              "e.getBoundingClientRect().right > 361 && !e.closest('.scroll'))"
                              ".map(e => e.outerHTML.slice(0, 80))")
            self.assertEqual(wide, [], view)
            self.close(page)

    def test_text_stands_out_in_light_and_dark(self):
        for dark in (False, True):
            for view in VIEWS:
                page = self.open_ready(view, dark=dark)
                contrasts = page.value(CONTRASTS)
                self.assertGreater(len(contrasts), 30, view)
                poor = [c for c in contrasts if c[0] < MIN_CONTRAST]
                self.assertEqual(poor, [], (view, dark))
                least = min(contrasts)
                print(f"\n{view or 'laboratory'} {'dark' if dark else 'light'}: least contrast "
                      f"{least[0]:.1f} ({least[1]}) of {len(contrasts)} texts")
                self.close(page)

    def test_every_control_is_reached_by_tab_and_seen(self):
        for view in VIEWS:
            page = self.open_ready(view)
            controls = page.value(
                "(() => { const all = [...document.querySelectorAll('a[href], button, input, "
                "select, summary, [tabindex=\"0\"]')].filter(e => e.checkVisibility() && "
                "!e.disabled && e.id !== 'skip'); all.forEach((e, i) => e.dataset.control = i); "
                "return all.length; })()")
            self.assertGreater(controls, 8, view)
            reached, unseen = set(), []
            for _ in range(2 * controls + 20):
                page.key("Tab", 9)
                at, outline, described = page.value(
                    "(e => [e.dataset?.control ?? null, getComputedStyle(e).outlineStyle, "
                    "e.outerHTML?.slice(0, 80)])(document.activeElement)")
                if at is not None:
                    reached.add(int(at))
                    if outline == "none":
                        unseen.append(described)
                if len(reached) == controls:
                    break
            missed = page.value(
                f"[...document.querySelectorAll('[data-control]')].filter(e => "
                f"!{sorted(reached)}.includes(Number(e.dataset.control)))"
                ".map(e => e.outerHTML.slice(0, 100))")
            self.assertEqual(missed, [], view)
            self.assertEqual(unseen, [], view)
            self.close(page)

    def test_landmarks_headings_and_names(self):
        for view in VIEWS:
            page = self.open_ready(view)
            self.assertEqual(page.value("['header', 'nav', 'main', 'footer'].map(n => "
                                        "document.querySelectorAll(n).length)"), [1, 1, 1, 1])
            levels = page.value("[...document.querySelectorAll('h1, h2, h3, h4')].filter(h => "
                                "h.checkVisibility()).map(h => Number(h.tagName[1]))")
            self.assertEqual(levels.count(1), 1, view)
            self.assertEqual(levels[0], 1, view)
            steps = [b - a for a, b in zip(levels, levels[1:])]
            self.assertLessEqual(max(steps), 1, (view, levels))
            unnamed = page.value(
                "[...document.querySelectorAll('button, input, select, a, [role=img], "
                "[role=region], [role=meter], progress, nav, img, th')].filter(e => "
                "e.checkVisibility() && !(e.textContent.trim() || e.getAttribute('aria-label') || "
                "e.alt || e.labels?.length)).filter(e => e.tagName !== 'TH')"
                ".map(e => e.outerHTML.slice(0, 80))")
            self.assertEqual(unnamed, [], view)
            self.assertEqual(page.value("document.querySelector('[aria-current=page]')"
                                        ".textContent.toLowerCase()"),
                             view.split("/")[0] or "laboratory")
            self.assertEqual(page.value("document.querySelectorAll('table').length === "
                                        "document.querySelectorAll('table > caption').length"),
                             True)
            self.assertGreaterEqual(page.value("document.querySelectorAll('[aria-live]').length"),
                                    2)
            self.close(page)

    def test_no_state_is_told_by_colour_alone(self):
        page = self.open_ready("")
        badges = page.value("[...document.querySelectorAll('.badge')].map(b => b.textContent)")
        self.assertGreater(len(badges), 10)
        for text in badges:
            self.assertRegex(text, r"^\S \w+", "a sign and a word")

    def test_every_axis_has_a_unit(self):
        for view in VIEWS[1:]:
            page = self.open_ready(view)
            page.wait_for("document.querySelectorAll('.y-label').length > 1")
            labels = page.value("[...document.querySelectorAll('.chart')].filter(c => "
                                "c.checkVisibility() && !c.querySelector('.no-data')"
                                ".checkVisibility()).flatMap(c => [c.querySelector('.y-label')"
                                ".textContent, c.querySelector('.x-label').textContent])")
            self.assertGreaterEqual(len(labels), 4)
            for label in labels:
                self.assertRegex(label, r" in \S+|\(unit one\)|count per bin", view)
            self.close(page)

    def test_paper_gets_ink_on_white_without_controls(self):
        page = self.open_ready("run/acc-2", dark=True)
        page.show_as(794, 1123, dark=True, medium="print")
        self.assertEqual(page.value("['nav', '.tools', '[data-step] button'].map(s => "
                                    "document.querySelector(s).checkVisibility())"), [False] * 3)
        self.assertEqual(page.value("getComputedStyle(document.documentElement).backgroundColor"),
                         "rgb(255, 255, 255)")
        poor = [c for c in page.value(CONTRASTS) if c[0] < MIN_CONTRAST]
        self.assertEqual(poor, [])
        paper = page.command("Page.printToPDF", {"printBackground": False})
        self.assertGreater(len(paper["data"]), 20000)


if __name__ == "__main__":
    run()
