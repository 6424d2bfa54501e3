"""``/diagnostics``: how the simulation keeps up, and the robots' controller managers, controllers and hardware.

The names, levels and texts of a controller manager are those of ros2_control (controller_manager.cpp, Jazzy). Execution
times are left out: a controller's update is part of a step. Periods are those of simulation time.
"""

from collections import deque
from collections.abc import Iterator, Mapping
from time import perf_counter
from typing import Any

from drake_twin.diagram.update_periods import update_steps, whole_steps
from drake_twin.messages import header
from drake_twin.planning.controller_plan import ACTIVE
from drake_twin.twin.controller_manager import ControllerManager
from drake_twin.twin.event_topics import DIAGNOSTICS
from drake_twin.twin.real_time import Frames
from drake_twin.twin.robot_control import RobotControl
from drake_twin.twin.session import Session
from drake_twin.twin.twin_clock import TwinClock

OK, WARN, ERROR = 0, 1, 2  # diagnostic_msgs/msg/DiagnosticStatus
_WARN_BEYOND, _ERROR_BEYOND = 5.0, 10.0  # Hz of a manager's mean error, as ros2_control's parameters have them
_SHORTEST = 0.1  # s of wall time over which a factor is measured
_SPAN = 1.0  # s of wall time over which it is measured, if it is read so often


class Status:
    """A ``diagnostic_msgs/msg/DiagnosticStatus`` in the making, as diagnostic_updater merges summaries.

    Args:
        name: Its name.
        hardware: The hardware's id.
        message: The summary, of level OK.
    """

    def __init__(self, name: str, hardware: str, message: str):
        self._name, self._hardware = name, hardware
        self._level, self._message = OK, message
        self._values: list[dict[str, str]] = []

    def add(self, key: str, value: float | str) -> None:
        """Add a value; numbers with a point have six places."""
        self._values.append({"key": key, "value": f"{value:f}" if isinstance(value, float) else str(value)})

    def merge(self, level: int, message: str) -> None:
        """Add another summary: the worse one counts, of two bad ones both."""
        if level > OK and self._level > OK:
            self._message += f"; {message}"
        elif level > self._level:
            self._message = message
        self._level = max(level, self._level)

    def fields(self) -> dict[str, Any]:
        """Return the message's fields."""
        texts = {"name": self._name, "message": self._message, "hardware_id": self._hardware}
        return {"level": self._level, **texts, "values": self._values}


class Diagnostics:
    """Reports on a session.

    Args:
        session: The session.
        clock: The pace of its time.
        frames: The frames of a run in real time.
    """

    def __init__(self, session: Session, clock: TwinClock, frames: Frames):
        self._session, self._clock, self._frames = session, clock, frames
        self._moments = deque([(perf_counter(), session.clock.time)])  # wall time and simulation time (s)
        topic = session.events[DIAGNOSTICS]
        topic.report = self.fields
        self._period = 1.0 / (topic.endpoint.rate or 1.0)

    def fields(self) -> dict[str, Any]:
        """Return the fields of the present ``diagnostic_msgs/msg/DiagnosticArray``."""
        of_robots = (item for control in self._session.controls.values() for item in self._of_robot(control))
        status = [item.fields() for item in (self._of_simulation(), *of_robots)]
        return {"header": header(self._session.clock.time), "status": status}

    def _of_simulation(self) -> Status:
        time, factor = self._session.clock.time, self._factor()
        status = Status("drake_twin: Simulation", "drake_twin", "Simulation is running")
        if 0.0 <= time - self._frames.missed_at <= self._period:
            status.merge(WARN, "Simulation is slower than its real-time rate")
        if factor is not None:
            status.add("real_time_factor", factor)
        status.add("real_time_rate", self._clock.real_time_rate)
        status.add("time_step", self._clock.time_step)
        status.add("missed_time", self._frames.missed)
        return status

    def _factor(self) -> float | None:
        """Return the real-time factor of the last span, which no other reader changes; None if it is too short.

        Moments at which it was read are kept for that, the last of them that is a span old and newer ones.
        """
        now, time, moments = perf_counter(), self._session.clock.time, self._moments
        if time < moments[-1][1]:  # the twin has gone back
            moments.clear()
        while len(moments) > 1 and now - moments[1][0] >= _SPAN:
            moments.popleft()
        if not moments or now - moments[-1][0] >= _SHORTEST:
            moments.append((now, time))
        before, then = moments[0]
        return (time - then) / (now - before) if now - before >= _SHORTEST else None

    def _of_robot(self, control: RobotControl) -> Iterator[Status]:
        manager, plan = control.manager, control.plan
        if not manager.states and not plan.description.systems:
            return
        namespace = plan.robot.topic_namespace
        node = f"{namespace}/controller_manager" if namespace else "controller_manager"
        components = {item.name: item.state for item in manager.list_hardware_components()}
        yield self._of_controllers(f"{node}: Controllers Activity", control, components)
        yield _of_hardware(f"{node}: Hardware Components Activity", components)
        yield self._of_manager(f"{node}: Controller Manager Activity", control)

    def _of_controllers(self, name: str, control: RobotControl, components: Mapping[str, str]) -> Status:
        manager: ControllerManager = control.manager
        are_active = all(state == ACTIVE for state in manager.states.values())
        status = Status(name, "ros2_control", _all_or_not("controllers", are_active=are_active))
        rate, step = control.plan.manager.update_rate, self._clock.time_step
        plans = {item.name: item for item in control.plan.controllers}
        for item in manager.list_controllers():
            status.add(f"{item.name}.state", item.state)
            if item.state == ACTIVE and item.update_rate != rate:
                found = 1.0 / (update_steps(plans[item.name], whole_steps(rate, step), step) * step)
                text = f"Avg: {found:.2f} [{found:.2f} - {found:.2f}] Hz, StdDev: 0.00"
                status.add(f"{item.name}.periodicity", f"{text} -> Desired : {round(item.update_rate)} Hz")
        if ACTIVE not in components.values():
            status.merge(ERROR, "No hardware components are currently active to activate controllers")
        elif not manager.states:
            status.merge(WARN, "No controllers are currently loaded")
        return status

    def _of_manager(self, name: str, control: RobotControl) -> Status:
        wanted = control.plan.manager.update_rate
        found = 1.0 / (whole_steps(wanted, self._clock.time_step) * self._clock.time_step)
        status = Status(name, "ros2_control", "Controller Manager is running")
        status.add("update_rate", str(round(wanted)))
        for key, value in {"average": found, "standard_deviation": 0.0, "min": found, "max": found}.items():
            status.add(f"periodicity.{key}", value)
        status.add("missed_periods", str(int(self._frames.missed * wanted)))
        if (error := abs(found - wanted)) > _WARN_BEYOND:
            text = f"Controller Manager has bad periodicity : {found:g} Hz. Expected consistent {wanted:g} Hz"
            status.merge(ERROR if error > _ERROR_BEYOND else WARN, text)
        return status


def _of_hardware(name: str, components: Mapping[str, str]) -> Status:
    are_active = all(state == ACTIVE for state in components.values())
    status = Status(name, "ros2_control", _all_or_not("hardware components", are_active=are_active))
    if not components:
        status.merge(ERROR, "No hardware components are loaded!")
    elif ACTIVE not in components.values():
        status.merge(WARN, "No hardware components are currently active")
    else:
        for component, state in components.items():
            status.add(f"{component}.state", state)
    return status


def _all_or_not(what: str, *, are_active: bool) -> str:
    return f"{'All' if are_active else 'Not all'} {what} are active"
