"""What dyncal's readers of TOML files say (read_tables.cpp)."""

import atexit
import functools
import json
import subprocess


@functools.cache
def process_of(program):
    process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    atexit.register(process.communicate)  # nothing more is asked, and it ends
    return process


def ask(program, questions):
    """For every (reader, text, path): {"problem": ..., "asked": [...]}."""
    process = process_of(program)
    answers = []
    for reader, text, path in questions:
        question = {"reader": reader, "text": text, "path": str(path)}
        process.stdin.write(json.dumps(question) + "\n")
        process.stdin.flush()
        answers.append(json.loads(process.stdout.readline()))
    return answers


def reader_of(tables):
    """Which of dyncal's files this is."""
    if "laboratory" in tables:
        return "laboratory"
    if "sensor" in tables:
        return "sensor"
    if "bench" in tables:
        return "bench"
    return "reference" if "reference" in tables else "tolerance"


def flags(program):
    done = subprocess.run([program, "--flags"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)
