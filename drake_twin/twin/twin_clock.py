"""How a twin's time passes: its steps, and their pace in a run."""

from dataclasses import replace

from drake_twin.errors import InputError
from drake_twin.twin.group import Group
from drake_twin.twin.owner import any_thread
from drake_twin.twin.recording import Recorder, recorded
from drake_twin.twin.schedule import meeting_step
from drake_twin.twin.session import Session
from drake_twin.twin.stepper import Stepper
from drake_twin.values import is_number

_FASTEST = 1e6  # times real time


class TwinClock(Group, path="twin.clock"):
    """How time passes; `Twin.clock`."""

    def __init__(self, session: Session, stepper: Stepper, recorder: Recorder):
        super().__init__(session, stepper, recorder)
        self._real_time_rate = 1.0

    @property
    @any_thread
    def step_count(self) -> int:
        """The number of physics steps since the start or the last reset."""
        return self._session.clock.step

    @property
    @any_thread
    def simulated(self) -> float:
        """The time that has been simulated since the twin was made (s), also before resets and restored states."""
        return self._session.simulated

    @property
    @any_thread
    def time_step(self) -> float:
        """The physics step (s)."""
        return self._session.clock.time_step

    @property
    @any_thread
    def paused(self) -> bool:
        """Whether time stands still."""
        return self._stepper.paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._stepper.paused = paused

    @property
    @any_thread
    def real_time_rate(self) -> float:
        """The simulated seconds that `Twin.run` grants per second of wall time.

        Raises:
            InputError: If it is set to a value that is not above zero, or above 1e6.
        """
        return self._real_time_rate

    @real_time_rate.setter
    def real_time_rate(self, rate: float) -> None:
        if not is_number(rate, 0.0) or not 0.0 < rate <= _FASTEST:
            raise InputError(f"{rate!r} is not a real-time rate: it must be above zero and at most {_FASTEST:g}")
        self._real_time_rate = float(rate)

    @recorded("set_time_step")
    def set_time_step(self, time_step: float) -> None:
        """Change the physics step; it takes effect at the next multiple of it, and changes no state.

        Args:
            time_step: The new step (s).

        Raises:
            InputError: If the step is not positive or too long, or the present step never meets a multiple of it.
        """
        if not is_number(time_step):
            raise InputError(f"{time_step!r} is not a step: it must be above zero")
        clock = self._session.clock
        new = replace(self._session.scenario, time_step=float(time_step)).time_step  # raises if it is not a step
        meeting_step(clock.step, clock.time_step, new)
        clock.next_time_step = new
        if not self._stepper.is_advancing:
            self._stepper.change_time_step()
