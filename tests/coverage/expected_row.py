"""One row of what is expected, and the quantities that rows judge."""

import dataclasses

VALUE = ("magnitude", "phase")
MAGNITUDE = ("magnitude",)
PHASE = ("phase",)
MEAN = ("mean magnitude", "mean phase")
RATE = ("rate",)
LOSSES = ("losses",)


@dataclasses.dataclass(frozen=True)
class Row:
    fault_class: str
    judged: tuple
    wanted: str
    fails_at: str = ""  # empty: holds
