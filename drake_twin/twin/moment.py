"""What a failed step is taken back to."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from drake_twin.controllers.stateful_controller import Sample
from drake_twin.twin.late_measurements import Past

if TYPE_CHECKING:
    from drake_twin.islands.archipelago import Memory


class Moment(NamedTuple):  # made before each advance, in a third of the time that a dataclass takes
    """The content of a diagram's context between two steps, to return to after a failed step.

    Attributes:
        time: The time (s).
        state: The plant's ``[q; v]``.
        samples: The sample of each stateful controller, in the order of their contexts; None if no step changes it.
        past: The past of each measurement delay.
        islands: What the islands remember; None without islands.
    """

    time: float
    state: np.ndarray
    samples: list[Sample | None]
    past: Past
    islands: "Memory | None" = None
