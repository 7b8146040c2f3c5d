"""Holds a figure that a page shows against the one that its commands make.

A page names both in a comment: `<!-- picture ../images/demo.svg is demo/transfer-function.svg -->`.
A bench in real time never gives the same noise twice, so that not all of it is compared: the texts
without their numbers, and in every panel the bars of u, at which frequency they stand and how long
they are beside the others. What a page shows with bars that the program does not give any more, or
gives to other frequencies, has aged.
"""

import re
import statistics
import xml.etree.ElementTree

NAMED = re.compile(r"^<!-- picture (\S+) is (\S+) -->$", re.M)
OF_THE_MEAN = "#222222"
MAX_RATIO = 1.6  # of two bars that are alike: u itself scatters a little
VISIBLE_PX = 1.0  # shorter ones are rounded


def name_of(element):
    return element.tag.rpartition("}")[2]


def texts_of(svg):
    texts = ["".join(one.itertext()) for one in svg.iter() if name_of(one) == "text"]
    words = (re.sub(r"[-+−]?\d[\d  ]*(?:\.\d+)?", "#", text) for text in texts)
    return sorted({one for one in words if re.search(r"[A-Za-z]", one)})


def bars_of(panel):
    """Place to length, in pixels."""
    bars = {}
    for line in panel.iter():
        if name_of(line) == "line" and line.get("stroke") == OF_THE_MEAN:
            if line.get("x1") == line.get("x2"):
                bars[round(float(line.get("x1")))] = abs(
                    float(line.get("y1")) - float(line.get("y2"))
                )
    return bars


def panels_of(svg):
    return [one for one in svg.iter() if name_of(one) == "g" and one.get("clip-path")]


def bars_difference(shown, made):
    if shown.keys() != made.keys():
        return f"bars at {sorted(shown)} px, but: {sorted(made)}"
    if not shown:
        return None
    usual = [max(VISIBLE_PX, statistics.median(bars.values())) for bars in (shown, made)]
    for place in shown:
        of_shown = max(VISIBLE_PX, shown[place]) / usual[0]
        of_made = max(VISIBLE_PX, made[place]) / usual[1]
        if not 1.0 / MAX_RATIO < of_shown / of_made < MAX_RATIO:
            return f"the bar at {place} px is {of_shown:.2f} of the usual, but: {of_made:.2f}"
    return None


def difference(shown_path, made_path):
    """None, or a sentence."""
    shown, made = (
        xml.etree.ElementTree.parse(path).getroot() for path in (shown_path, made_path)
    )
    if texts_of(shown) != texts_of(made):
        return f"texts {texts_of(shown)}, but: {texts_of(made)}"
    panels = [[bars_of(one) for one in panels_of(svg)] for svg in (shown, made)]
    if len(panels[0]) != len(panels[1]) or not any(panels[0]):
        bars = sum(map(len, panels[0]))
        return f"{len(panels[0])} panels with {bars} bars, but: {len(panels[1])} panels"
    for number, (of_shown, of_made) in enumerate(zip(*panels), 1):
        if problem := bars_difference(of_shown, of_made):
            return f"panel {number}: {problem}"
    return None
