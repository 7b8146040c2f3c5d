#!/usr/bin/env python3
"""A picture that has aged is told from one whose noise alone differs."""

import pathlib
import random
import tempfile
import unittest

import pictures

FREQUENCIES_PX = range(100, 700, 50)


def figure(lengths, title="dau/acceleration_z, 8.1 ms"):
    bars = "".join(
        f'<line x1="{x}" x2="{x}" y1="{200 - one / 2}" y2="{200 + one / 2}" stroke="#222222"/>'
        for x, one in zip(FREQUENCIES_PX, lengths)
    )
    return (
        '<svg xmlns="http://www.w3.org/2000/svg">'
        f'<text>{title}</text><g clip-path="url(#clip1)">{bars}</g></svg>'
    )


class Pictures(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def difference(self, *figures):
        paths = [self.folder / f"{i}.svg" for i in range(2)]
        for path, text in zip(paths, figures):
            path.write_text(text)
        return pictures.difference(*paths)

    def test_noise_alone_is_no_difference(self):
        draw = random.Random(5)
        shown, made = (
            [12.0 * draw.uniform(0.85, 1.15) for _ in FREQUENCIES_PX] for _ in range(2)
        )
        other_number = figure(made, "dau/acceleration_z, 8.2 ms")
        self.assertIsNone(self.difference(figure(shown), other_number))

    def test_a_frequency_whose_u_has_changed_is_named(self):
        made = [12.0 for _ in FREQUENCIES_PX]
        for place in range(len(made)):
            shown = list(made)
            shown[place] *= 2.0
            problem = self.difference(figure(shown), figure(made))
            self.assertIn(f"the bar at {FREQUENCIES_PX[place]} px", problem)

    def test_another_text_or_a_missing_bar_is_a_difference(self):
        made = [12.0 for _ in FREQUENCIES_PX]
        self.assertIsNotNone(self.difference(figure(made), figure(made, "another title")))
        self.assertIsNotNone(self.difference(figure(made), figure(made[:-1])))

    def test_a_figure_without_bars_is_none(self):
        self.assertIsNotNone(self.difference(figure([]), figure([])))


if __name__ == "__main__":
    unittest.main()
