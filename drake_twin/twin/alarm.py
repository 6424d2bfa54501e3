"""Stops of the simulation at times that a user of the twin chooses one after the other, such as its node programs."""

from collections import deque
from collections.abc import Callable
from math import inf

from drake_twin.twin.owner import Owned, Owner
from drake_twin.twin.schedule import step_at


class Alarm(Owned, path="twin.alarm"):
    """Calls a function at the first step that is not before a time; each call may set the next time.

    Args:
        owner: The thread that the twin belongs to.
        time_step: The physics step (s).

    Attributes:
        due_step: The step of the next call; infinite without one.
        call: Is called then, after the subscriptions' callbacks; it may do what these may.
        jumped: Is called after a reset or a restored state, with the time (s) before that.
        requests: What can be done only between two advances, such as a spawn; an advance ends for them.
    """

    def __init__(self, owner: Owner, time_step: float):
        self._owner = owner
        self.due_step: float = inf
        self.call: Callable[[], None] = lambda: None
        self.jumped: Callable[[float], None] = lambda before: None
        self.requests: deque[Callable[[], None]] = deque()
        self._time_step = time_step
        self._time = inf

    def set(self, time: float) -> None:
        """Set the time (s) of the next call; infinite for none."""
        self._time = time
        self.due_step = inf if time == inf else step_at(time, self._time_step)

    def hasten(self, time: float) -> None:
        """Set the time (s) of the next call, unless it is earlier already."""
        if time < self._time:
            self.set(time)

    def use(self, time_step: float) -> None:
        """Count in steps of this length (s) from now on."""
        self._time_step = time_step
        self.set(self._time)

    def ring(self) -> None:
        """Call the function."""
        self.set(inf)
        self.call()

    def do_requests(self) -> None:
        """Do what can be done only between two advances."""
        while self.requests:
            self.requests.popleft()()
