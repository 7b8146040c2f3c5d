#!/usr/bin/env python3
"""A day of a laboratory does not make the page grow: JavaScript's heap and the number of elements
at a third of the day and at its end.

The day is played fast, every 1800th of its 86400 seconds; DYNCAL_BROWSER_DAY=1 plays all of them.
"""

import os
import time

import played_state
from page_case import PageCase, run

SECONDS = 86400
STEPS = 51
EVERY_S = int(os.environ.get("DYNCAL_BROWSER_DAY", "1800"))
RUN_S = 3600 if EVERY_S <= 450 else 14400  # a third of the day ends with a run, as the day does
MAX_ELEMENT_GROWTH = 1.10
MAX_GROWTH_BYTES = 150e3  # seen: 70 kB; of a page that keeps every answer 240 kB and more
# An answer just read is held for a while, longer on a busy machine. What the page keeps does not
# become less by waiting.
SETTLES_WITHIN_S = 60.0
SHOWN_FOR_S = 2.0
PAUSE_S = 0.2


def wait_until_shown(page):
    """Until the elements stay what they are: a view that has yet to get the fit of its step holds
    500 kB less than one that shows it."""
    deadline = time.monotonic() + SETTLES_WITHIN_S
    count, since = elements_of(page), time.monotonic()
    while time.monotonic() < min(deadline, since + SHOWN_FOR_S):
        time.sleep(PAUSE_S)
        if (now := elements_of(page)) != count:
            count, since = now, time.monotonic()


def settled(measure):
    """The least of some measurements, so that what is about to go is not part of it."""
    values = []
    for _ in range(5):
        values.append(measure())
        time.sleep(PAUSE_S)
    return min(values)


def settled_below(measure, limit):
    """Measures until it is below the limit, or for as long as it may take; returns the newest."""
    deadline = time.monotonic() + SETTLES_WITHIN_S
    while (value := measure()) >= limit and time.monotonic() < deadline:
        time.sleep(PAUSE_S)
    return value


def elements_of(page):
    return page.value("document.querySelectorAll('*').length")


class Memory(PageCase):
    # Code that is compiled as the page is used would be half of the heap, and is not the page's.
    script_options = ("--jitless",)

    def play(self, page, begin_s, end_s):
        """The states between two seconds of the day, in portions of one answer each."""
        lab = self.laboratory
        for second in range(begin_s, end_s, EVERY_S):
            run_number, within = divmod(second, RUN_S)
            lab.origin_ms = played_state.BEGIN_UTC_MS + 1000 * second
            for name in lab.benches:
                if within < EVERY_S:
                    lab.points[name] = []
                    lab.is_over[name] = False
                    lab.benches[name].update(run=f"run-{run_number}", state="running")
                    lab.runs[name] = [{"run": f"run-{n}", "state": "done",
                                       "planned_utc_ms": played_state.BEGIN_UTC_MS + n * RUN_S}
                                      for n in range(run_number - 20, run_number + 1)]
                step = min(STEPS, 1 + within * STEPS // (RUN_S - 120))
                lab.measure(name, step, {**played_state.point(step, seed=run_number),
                                         "u_magnitude": 1e-3 + 1e-9 * second})
                if within >= RUN_S - max(EVERY_S, 120):
                    lab.finish(name)
            if second % 600 < EVERY_S:
                lab.events = [*lab.events[-199:], {
                    "utc_ms": lab.origin_ms, "bench": "acc-1", "severity": "note",
                    "text": f"second {second} of the day"}]
            lab.changed()
            page.wait_for(f"Number(document.querySelector('.view').dataset.number) >= {lab.number}")

    def grow(self, view):
        for name in ("acc-1", "acc-2", "acc-3"):
            self.laboratory.add_bench(name)
        self.laboratory.events = [
            {"utc_ms": played_state.BEGIN_UTC_MS - 1000 * n, "bench": "acc-1", "severity": "note",
             "text": f"{n} s before the day"} for n in range(200, 0, -1)]  # as many as there may be
        page = self.open(view)
        page.wait_for("document.querySelector('.view')?.dataset.number")
        if view.startswith("bench/"):  # whole: its charts come later than its state
            page.wait_for("document.querySelector('[data-field=spectrum]').textContent !== ''")
        began = time.monotonic()
        self.play(page, 0, SECONDS // 3)
        wait_until_shown(page)
        heap_third, elements_third = settled(page.heap_bytes), elements_of(page)
        self.play(page, SECONDS // 3, SECONDS)
        wait_until_shown(page)
        max_heap = heap_third + MAX_GROWTH_BYTES
        heap_end, elements_end = settled_below(page.heap_bytes, max_heap), elements_of(page)
        print(f"\n{view or 'laboratory'}: {SECONDS // EVERY_S} states in "
              f"{time.monotonic() - began:.0f} s; heap {heap_third / 1e6:.2f} MB at a third, "
              f"{heap_end / 1e6:.2f} MB at the end; {elements_third} and {elements_end} elements")
        self.assertLess(heap_end, max_heap)
        # Elements differ by what the hour has: a run just begun, or done.
        self.assertLess(elements_end, MAX_ELEMENT_GROWTH * elements_third + 4 * 200)

    def test_laboratory(self):
        self.grow("")

    def test_bench(self):
        self.grow("bench/acc-1")

    def test_run(self):
        self.grow("run/acc-1")

    def test_going_from_view_to_view_leaves_nothing_behind(self):
        self.laboratory.add_bench("acc-1")
        for step in range(1, STEPS + 1):
            self.laboratory.measure("acc-1", step)
        self.laboratory.finish("acc-1")
        page = self.open()
        rounds = 9

        def go_round():
            for view in ("bench/acc-1", "run/acc-1", "history", ""):
                page.value(f"location.hash = '#/{view}'")
                name = view.split("/")[0] or "laboratory"
                page.wait_for(f"document.querySelector('.view').dataset.view === '{name}'")
                if view == "run/acc-1":
                    page.wait_for("document.querySelectorAll('[data-step]').length === 51")
                if view == "history":
                    rows = "document.querySelectorAll('[data-panel=en] tbody tr')"
                    page.wait_for(f"{rows}.length === 34")

        for _ in range(rounds // 3):
            go_round()
        third = settled(page.heap_bytes)
        for _ in range(rounds - rounds // 3):
            go_round()
        max_heap = third + MAX_GROWTH_BYTES
        end = settled_below(page.heap_bytes, max_heap)
        print(f"\n{rounds} rounds through the views: heap {third / 1e6:.2f} MB after a third, "
              f"{end / 1e6:.2f} MB at the end")
        # Four views each time: one that stays would be 8 times its own few hundred kB.
        self.assertLess(end, max_heap)


if __name__ == "__main__":
    run()
