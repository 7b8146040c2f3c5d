"""Holds what a program prints against what a page shows.

Line by line; spaces count as one. `...` stands for any text, a line of it alone for any lines.
Names of runs (20261122T225758.290Z) may differ. A number with a decimal point may differ by 5 %, or
by six of its last digit: a bench in real time never gives the same noise twice, and what two
repetitions say of their scatter differs most.
"""

import re

RUN = re.compile(r"\d{8}T\d{6}(\.\d+)?Z(\.[0-9a-f]{8}\b)?")
DECIMAL = r"[-+]?\d+\.\d+(?:e[-+]\d+)?"
NUMBER = re.compile(rf"(?<![\w.]){DECIMAL}(?!\.?\w)")


def near(a, b):
    digits = len(a.split(".")[1].split("e")[0])
    exponent = int(a.split("e")[1]) if "e" in a else 0
    allowed = max(0.05 * abs(float(a)), 6.001 * 10.0 ** (exponent - digits))
    return abs(float(a) - float(b)) <= allowed


def line_matches(shown, printed):
    shown = RUN.sub("RUN", " ".join(shown.split()))
    printed = RUN.sub("RUN", " ".join(printed.split()))
    pattern = ""
    numbers = []
    for part in re.split(r"(\.\.\.)", shown):
        if part == "...":
            pattern += ".*"
            continue
        last = 0
        for number in NUMBER.finditer(part):
            pattern += re.escape(part[last : number.start()]) + f"({DECIMAL})"
            numbers.append(number[0])
            last = number.end()
        pattern += re.escape(part[last:])
    found = re.fullmatch(pattern, printed)
    return bool(found) and all(near(a, b) for a, b in zip(numbers, found.groups()))


def brought_up_to_date(shown, printed):
    """What is shown, with the numbers that were printed: of each line that was printed with others,
    in their order."""
    left = printed.splitlines()
    lines = []
    for line in shown.splitlines():
        place = next((i for i, one in enumerate(left) if _is_alike(line, one)), None)
        if place is not None:
            line = _with_numbers_of(line, left[place])
            del left[: place + 1]
        lines.append(line)
    return "\n".join(lines) + "\n"


def _pattern(shown):
    parts = []
    for part in re.split(r"(\.\.\.|" + NUMBER.pattern + ")", " ".join(shown.split())):
        is_number = bool(NUMBER.fullmatch(part))
        parts.append(".*" if part == "..." else f"({DECIMAL})" if is_number else re.escape(part))
    return "".join(parts)


def _is_alike(shown, printed):
    return shown.strip() != "..." and re.fullmatch(_pattern(shown), " ".join(printed.split()))


def _with_numbers_of(shown, printed):
    if "..." not in shown and not RUN.search(shown):
        return printed.rstrip()
    numbers = iter(re.fullmatch(_pattern(shown), " ".join(printed.split())).groups())

    def brought(number):
        printed_number = next(numbers)
        is_begun = shown.startswith("...", number.end())  # 1.0... stands for any further digits
        return number[0] if is_begun else printed_number

    return NUMBER.sub(brought, shown)


def first_difference(shown, printed):
    """None, or what is shown and was not printed."""
    shown = [line.rstrip() for line in shown.strip("\n").splitlines()]
    printed = [line.rstrip() for line in printed.strip("\n").splitlines()]
    return _difference(shown, printed)


def _difference(shown, printed):
    at = 0
    for i, line in enumerate(shown):
        if line.strip() == "...":
            rest = shown[i + 1 :]
            if not rest:
                return None
            for start in range(at, len(printed) + 1):
                if _difference(rest, printed[start:]) is None:
                    return None
            return f"after '...': {rest[0]}"
        if at >= len(printed):
            return f"{line}   (nothing more was printed)"
        if not line_matches(line, printed[at]):
            return f"{line}\n  but: {printed[at]}"
        at += 1
    return None if at == len(printed) else f"nothing more, but: {printed[at]}"
