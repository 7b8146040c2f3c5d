"""Every key that dyncal's readers of TOML files ask for, found by asking them.

Beginning with an empty file, each key that was asked for is set to each kind of value it may have;
where that makes a reader ask for something new, the search goes on from there. So nothing has to be
listed by hand: a new driver, table or key is found.
"""

import collections
import copy

import readers
import toml_text

READERS = ("bench", "laboratory", "sensor", "reference")
# What chooses among sets of keys of its own table.
DISCRIMINATORS = ("driver", "kind")
SAMPLES = {
    "table": [{}],
    "text": ["x"],
    "number": [1.5],
    "whole number": [2],
    "true or false": [False],
    "list of texts": [["x"]],
    "number or list of numbers": [1.5],
    "table of texts": [{}],
    "table of numbers": [{}],
    "": ["x", 1.5, [{}]],  # nobody has said yet
}


def table_of(state, names):
    """The table, in a copy of the path to it; None if a key in its way is something else."""
    for name in names:
        state = state.setdefault(name, {})
        if isinstance(state, list):
            state = state[0] if state else None
        if not isinstance(state, dict):
            return None
    return state


def context_of(state, name):
    """What the file says of its kind in the key's own table."""
    table = table_of(copy.deepcopy(state), name.split(".")[:-1]) or {}
    return frozenset((key, table[key]) for key in DISCRIMINATORS if isinstance(table.get(key), str))


def children(state, asked):
    for question in asked:
        *path, key = question["name"].split(".")
        samples = question["choices"] or SAMPLES[question["type"]]
        for sample in samples:
            child = copy.deepcopy(state)
            table = table_of(child, path)
            if table is not None and key not in table:
                table[key] = copy.deepcopy(sample)
                yield child


def search(program, reader, folder):
    """{key: {context: [question, ...]}}"""
    found = collections.defaultdict(lambda: collections.defaultdict(list))
    states = [{}]
    while states:
        answers = readers.ask(
            program, [(reader, toml_text.to_toml(state), folder / "x.toml") for state in states]
        )
        following = []
        for state, answer in zip(states, answers):
            new = False
            for question in answer["asked"]:
                questions = found[question["name"]][context_of(state, question["name"])]
                if question not in questions:
                    questions.append(question)
                    new = True
            if new:
                following.extend(children(state, answer["asked"]))
        states = following
    return found
