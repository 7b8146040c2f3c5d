"""One row of what is expected, and the quantities that rows judge."""

import dataclasses
import math

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
    below_hz: float = math.inf  # what is judged: only frequencies below

    def judges(self, claim):
        """Refusals of a whole calibration have no frequency, and always count."""
        return not claim.frequency or float(claim.frequency) < self.below_hz
