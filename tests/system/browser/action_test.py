#!/usr/bin/env python3
"""Actions need a token, which is kept nowhere, and a confirmation; their answers are shown."""

from page_case import PageCase, run, text_of
from played_laboratory import TOKEN


class Actions(PageCase):
    def setUp(self):
        super().setUp()
        self.laboratory.add_bench("acc-1", run="run-5")

    def press(self, page, text, within="document"):
        page.wait_for(f"[...{within}.querySelectorAll('button')].some(b => "
                      f"b.textContent === {text!r} && b.checkVisibility())")
        page.value(f"(b => {{ b.focus(); b.click(); }})([...{within}.querySelectorAll('button')]"
                   f".find(b => b.textContent === {text!r} && b.checkVisibility()))")

    def in_dialog(self, page, text):
        self.press(page, text, "document.querySelector('dialog')")
        page.wait_for("document.querySelector('dialog') === null")

    def unlock(self, page, token=TOKEN):
        self.press(page, "Act with a token …")
        page.wait_for("document.activeElement.type === 'password'")
        page.value(f"document.activeElement.value = {token!r}")
        self.in_dialog(page, "Unlock")

    def test_without_a_configured_token_there_are_no_actions(self):
        self.laboratory.may_act = False
        page = self.open("bench/acc-1")
        page.wait_for("document.querySelectorAll('.band li').length === 51")
        self.assertFalse(page.value("document.querySelector('.actions').checkVisibility()"))

    def test_wrong_token_is_said_to_be_wrong(self):
        self.allowed_problems = ["401"]
        page = self.open("bench/acc-1")
        self.unlock(page, "guessed")
        page.wait_for(f"{text_of('.answer')} === '✕ the token is not the daemon\\'s'")
        self.assertEqual(self.laboratory.posted, [])

    def test_abort_is_confirmed_and_answered(self):
        page = self.open("bench/acc-1")
        page.wait_for("document.querySelectorAll('.band li').length === 51")
        self.assertFalse(page.value("[...document.querySelectorAll('button')].some(b => "
                                    "b.textContent === 'Abort the run' && b.checkVisibility())"))
        self.unlock(page)
        self.press(page, "Abort the run")
        page.wait_for("document.querySelector('dialog')?.open")
        self.assertEqual(page.value("document.activeElement.textContent"), "Cancel")
        self.in_dialog(page, "Cancel")
        self.assertEqual(self.laboratory.posted, [])
        self.press(page, "Abort the run")
        self.in_dialog(page, "Abort the run")
        page.wait_for(f"{text_of('.answer')}.includes('accepted by dyncal-analysis: as you wish')")
        self.assertEqual(self.laboratory.posted, [
            ("/api/bench/acc-1/command", {"command": "abort", "run": "run-5"})])
        # Nothing that outlives the page has the token.
        self.assertEqual(page.value("localStorage.length + sessionStorage.length"), 0)
        self.assertEqual(page.value("document.cookie"), "")
        self.assertNotIn(TOKEN, page.value("document.documentElement.outerHTML"))

    def test_step_is_repeated_by_its_number(self):
        page = self.open("bench/acc-1")
        page.wait_for("document.querySelectorAll('.band li').length === 51")
        self.unlock(page)
        self.press(page, "Repeat a step …")
        page.wait_for("document.activeElement.type === 'number'")
        page.value("document.activeElement.value = '17'")
        self.in_dialog(page, "Repeat the step")
        page.wait_for(f"{text_of('.answer')}.includes('accepted')")
        self.assertEqual(self.laboratory.posted[0][1],
                         {"command": "repeat", "step": 17, "run": "run-5"})

    def test_run_is_started_from_a_file_of_the_server(self):
        page = self.open()
        self.unlock(page)
        self.press(page, "Start a run …")
        page.wait_for("document.querySelector('dialog select')?.value === 'acc-1.toml'")
        page.value("document.querySelector('dialog [name=run]').value = ' daily 7 '")
        self.in_dialog(page, "Start the run")
        page.wait_for(f"{text_of('.answer')}.includes('accepted')")
        self.assertEqual(self.laboratory.posted,
                         [("/api/run", {"file": "acc-1.toml", "run": "daily 7"})])
        self.press(page, "Forget token")
        page.wait_for("[...document.querySelectorAll('button')].some(b => "
                      "b.textContent === 'Act with a token …' && b.checkVisibility())")

    def test_escape_cancels(self):
        page = self.open()
        self.press(page, "Act with a token …")
        page.wait_for("document.querySelector('dialog')?.open")
        page.key("Escape", 27)
        page.wait_for("document.querySelector('dialog') === null")
        self.assertEqual(page.value("document.activeElement.textContent"), "Act with a token …")


if __name__ == "__main__":
    run()
