"""What is set of the controllers' parameters while the twin runs.

As upstream, an active controller follows some of them at once, and the others when it is configured next. Here, those
of a controller that is not active are followed at once, too: it does nothing until it is activated.

The robots' nodes that are no controllers are ``controller_manager`` and ``robot_state_publisher``: what is set of them
and cannot be followed is kept, like the values of a controller that is not configured yet.
"""

import logging
from collections.abc import Callable, Container, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Protocol

from drake_twin.description.declared_parameters import DeclaredParameter
from drake_twin.errors import InputError
from drake_twin.messages import time_message
from drake_twin.messages.parameter_value import FIELDS, value_fields
from drake_twin.planning.controller_plan import USE_SIM_TIME, ControllerPlan
from drake_twin.planning.node_parameters import (
    CONTROLLER_MANAGER,
    STATE_PUBLISHER,
    STRICTNESS,
    STRICTNESSES,
    node_parameters,
)
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import Scenario
from drake_twin.twin.event_topics import PARAMETER_EVENTS, EventTopics
from drake_twin.twin.robot_control import RobotControl

_log = logging.getLogger(__name__)


class Rebuilt(Protocol):
    """What is built again with other parameters, which is `Session`; its members are described there."""

    scenario: Scenario
    events: EventTopics
    is_advancing: Callable[[], bool]

    def between_advances(self, act: Callable[[], None]) -> None:
        """Do what a callback cannot do, once the present advance has ended."""

    def control(self, robot: Any) -> RobotControl:
        """Return a robot's controllers."""

    def rebuild(self, scenario: Scenario) -> None:
        """Switch to the diagram of another scenario."""


class ParameterChanges:
    """The changes of a session's controllers.

    Args:
        session: The session.
        now: Returns the simulation time (s).
    """

    def __init__(self, session: Rebuilt, now: Callable[[], float]):
        self._session, self._now = session, now
        self._pending: dict[tuple[str, str], dict[str, Any]] = {}

    def declared(self, robot: str, controller: str) -> dict[str, DeclaredParameter]:
        """Return a controller's parameters as its node declares them, with their present values.

        Raises:
            InputError: If the robot or the controller is unknown.
        """
        plan = self._session.control(robot).plan
        found = node_parameters(plan, controller) or _plan_of(plan, controller).declared
        for name, value in self._pending.get((robot, controller), {}).items():
            found[name] = replace(found[name], value=_frozen(value))
        return found

    def set(self, robot: str, controller: str, values: Mapping[str, Any]) -> None:
        """Set parameters, all or none; see `Control.set_parameters`."""
        declared, control = self.declared(robot, controller), self._session.control(robot)
        for name, value in values.items():
            if name not in declared:
                raise InputError(f"parameter '{name}' cannot be set because it was not declared")
            if reason := declared[name].refusal(value):
                raise InputError(reason)
            if name == USE_SIM_TIME and not value:
                raise InputError("parameter 'use_sim_time' cannot be false: the twin has no other time")
        changed = {name: value for name, value in values.items() if _frozen(value) != declared[name].value}
        pending = self._pending.pop((robot, controller), {}) | changed
        is_node = bool(node_parameters(control.plan, controller))
        waits = is_node or control.manager.is_active(controller)
        later = {name: value for name, value in pending.items() if waits and not declared[name].is_live}
        if is_node and STRICTNESS in pending:  # the manager asks for it
            later[STRICTNESS] = pending[STRICTNESS]
        at_once = {name: value for name, value in pending.items() if name not in later}
        if at_once:
            self._build(robot, controller, at_once)
        if later:
            self._pending[robot, controller] = later
        self._tell(control.plan, controller, "changed_parameters", values, declared)

    def strictness(self, robot: str) -> int:
        """Return the strictness of a robot's switches that name none."""
        return STRICTNESSES[self.declared(robot, CONTROLLER_MANAGER)[STRICTNESS].value]

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps: what has been set and is not followed yet."""
        waiting: dict[str, dict[str, Any]] = {}
        for (robot, node), values in sorted(self._pending.items()):
            plain = {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}
            waiting.setdefault(robot, {})[node] = plain
        return {"later_parameters": waiting} if waiting else {}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned."""
        self._pending = {}
        for robot, nodes in state.get("later_parameters", {}).items():
            for node, values in nodes.items():
                declared = self.declared(robot, node)
                if any(name not in declared or declared[name].refusal(value) for name, value in values.items()):
                    raise ValueError(f"the parameters of {node}")
                self._pending[robot, node] = dict(values)

    def keep(self, robots: Container[str]) -> None:
        """Forget what was set of other robots."""
        self._pending = {key: values for key, values in self._pending.items() if key[0] in robots}

    def configured(self, robot: str, controller: str) -> None:
        """Let a controller that has been configured follow what has been set before."""
        values = self._pending.pop((robot, controller), None)
        if not values:
            return
        if self._session.is_advancing():
            self._session.between_advances(partial(self._build_late, robot, controller, values))
        else:
            self._build_late(robot, controller, values)

    def loaded(self, robot: str, controller: str) -> None:
        """Tell of the parameters of a controller that has been loaded."""
        if self._session.events[PARAMETER_EVENTS].is_heard:
            declared = self.declared(robot, controller)
            values = {name: item.value for name, item in declared.items()}
            self._tell(self._session.control(robot).plan, controller, "new_parameters", values, declared)

    def _build_late(self, robot: str, controller: str, values: Mapping[str, Any]) -> None:
        try:
            self._build(robot, controller, values)
        except InputError as error:
            node = _node(self._session.control(robot).plan, controller)
            _log.error("%s: its parameters stay as they were: %s", controller, error, extra={"node": node})

    def _build(self, robot: str, controller: str, values: Mapping[str, Any]) -> None:
        scenario = self._session.scenario
        robots = []
        for item in scenario.robots:
            if item.name == robot and controller == STATE_PUBLISHER:
                item = replace(item, **values)
            elif item.name == robot:
                given = dict(item.controller_parameters)
                given[controller] = {**given.get(controller, {}), **values}
                item = replace(item, controller_parameters=given)
            robots.append(item)
        self._session.rebuild(replace(scenario, robots=tuple(robots)))

    def _tell(
        self,
        plan: RobotPlan,
        controller: str,
        kind: str,
        values: Mapping[str, Any],
        declared: Mapping[str, DeclaredParameter],
    ) -> None:
        stamp, node = time_message(self._now()), _node(plan, controller)
        items = [{"name": name, "value": value_of(declared[name].type, value)} for name, value in values.items()]
        self._session.events[PARAMETER_EVENTS].put(lambda: {"stamp": stamp, "node": node, kind: items})


def value_of(kind: int, value: Any) -> Mapping[str, Any]:
    """Return the fields of a ``ParameterValue`` of a type, which an empty list does not tell."""
    if kind not in FIELDS:
        return value_fields(value)
    return {"type": kind, FIELDS[kind]: list(value) if isinstance(value, tuple) else value}


def _plan_of(plan: RobotPlan, controller: str) -> ControllerPlan:
    for item in plan.controllers:
        if item.name == controller:
            return item
    text = f"robot {plan.name!r} has no controller {controller!r}"
    raise InputError(text, value=str(controller), valid=[item.name for item in plan.controllers])


def _node(plan: RobotPlan, controller: str) -> str:
    return f"{plan.robot.topic_namespace}/{controller}"


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
