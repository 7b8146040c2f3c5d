#!/usr/bin/env python3
"""What a page shows is held against what is printed neither too strictly nor too loosely."""

import unittest

from expected_output import brought_up_to_date, first_difference


class ExpectedOutput(unittest.TestCase):
    def test_equal(self):
        self.assertIsNone(first_difference("a\nb\n", "a\nb\n"))
        self.assertIsNone(first_difference("a   b", "a b"))

    def test_lines_too_few_and_too_many(self):
        self.assertIsNotNone(first_difference("a\nb\n", "a\n"))
        self.assertIsNotNone(first_difference("a\n", "a\nb\n"))
        self.assertIsNotNone(first_difference("a\n", ""))

    def test_dots_in_a_line_stand_for_any_text(self):
        self.assertIsNone(first_difference("wrote ...json", "wrote x/y.json"))
        self.assertIsNotNone(first_difference("wrote ...json", "wrote x/y.xml"))

    def test_a_line_of_dots_stands_for_any_lines(self):
        self.assertIsNone(first_difference("...\nb\n...", "a\na\nb\nc"))
        self.assertIsNone(first_difference("...\nb", "b"))
        self.assertIsNotNone(first_difference("...\nb", "a\nb\nc"))
        self.assertIsNotNone(first_difference("a\n...\nd", "a\nb\nc"))

    def test_numbers_may_differ_a_little(self):
        self.assertIsNone(first_difference("20 1.0169 0.0010", "20 1.0167 0.0014"))
        self.assertIsNotNone(first_difference("20 1.0169 0.0010", "20 1.0167 0.0020"))
        self.assertIsNotNone(first_difference("20 1.0169 0.0010", "40 1.0169 0.0010"))
        self.assertIsNotNone(first_difference("|H| = 1.02", "|H| = 1.20"))
        self.assertIsNotNone(first_difference("1.0169", "-1.0169"))

    def test_names_of_runs_may_differ(self):
        shown = "runs/x/first.20261122T225758.290Z.4f2a91c0"
        self.assertIsNone(first_difference(shown, "runs/x/first.20270101T000000.001Z.4f2a91c0"))
        self.assertIsNotNone(first_difference(shown, "runs/x/second.20270101T000000.001Z.4f2a91c0"))
    def test_a_page_is_brought_up_to_date(self):
        shown = "f |H| u\n...\n20 1.0169 0.0010\nmean 996.9 us, ... 0 lost\nas it was\n"
        printed = "f  |H|  u\n10  1.2 0.2\n20  1.0172  0.0009\nmean 997.1 us, sd 3, 0 lost\n"
        self.assertEqual(
            brought_up_to_date(shown, printed),
            "f  |H|  u\n...\n20  1.0172  0.0009\nmean 997.1 us, ... 0 lost\nas it was\n",
        )


if __name__ == "__main__":
    unittest.main()
