"""The plan of one controller: its typed parameters, and what it claims and offers."""

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache
from graphlib import CycleError, TopologicalSorter
from typing import Any

from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller_class, controller_types
from drake_twin.description.controllers_yaml import HIGHEST_RATE, LOWEST_RATE, ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import InputError
from drake_twin.findings import Finding
from drake_twin.planning.controller_plan import ControllerPlan, chained_to, is_chained


def plan_controller(
    controller: ControllerParameters,
    description: RobotDescription,
    manager_rate: float,
    known: Container[str],
) -> tuple[ControllerPlan, tuple[Finding, ...]]:
    """Plan a controller.

    Args:
        controller: Its parameters.
        description: The robot.
        manager_rate: The controller manager's rate (Hz).
        known: The names of all controllers, whose references it may claim.

    Raises:
        InputError: If its parameters are wrong.
    """
    rate = controller.parameters.get("update_rate", manager_rate)
    if (
        isinstance(rate, bool)
        or not isinstance(rate, int | float)
        or not (rate == 0 or LOWEST_RATE < rate < HIGHEST_RATE)
    ):
        raise controller.error(f"{rate!r} is not a rate (Hz)", "update_rate")
    fallbacks = controller.names("fallback_controllers")
    if controller.name in fallbacks:
        raise controller.error("a controller cannot be its own fallback", "fallback_controllers")
    plan = ControllerPlan(
        controller.name,
        controller.type,
        update_rate=float(rate) or manager_rate,
        fallbacks=fallbacks,
        ros_parameters=controller.parameters,
    )
    kind = controller_class(controller.type)
    if kind is None:
        hint = _hint(controller.type, controller_types())
        return replace(plan, problem=f"type {controller.type} is not supported; {hint}"), ()
    parameters, ignored = read_parameters(kind.Parameters, controller)
    try:
        claims = kind.claimed_interfaces(parameters, description)
    except InputError as error:
        raise controller.error(error.message, value=error.value, valid=error.valid) from None
    _check_joints(controller, claims, description, known)
    own_joints = [claim for claim in claims if not is_chained(claim, known)]
    problems = (_unusable(claim, description, kind.needs_command_interfaces) for claim in own_joints)
    problem = next(filter(None, problems), None)
    problem = problem or kind.problem(parameters, description)
    references = kind.reference_interfaces(parameters, description)
    exported = kind.exported_interfaces(parameters)
    plan = replace(plan, parameters=parameters, claims=claims, references=references, exported=exported)
    return replace(plan, problem=problem), ignored


def check_references(plans: dict[str, ControllerPlan], by_name: Mapping[str, ControllerParameters]) -> None:
    """Add an error for each claim of a reference that another controller does not have.

    Raises:
        InputError: If controllers claim each other's references in a circle.
    """
    for name, plan in plans.items():
        for claim in plan.claims:
            if not is_chained(claim, plans):
                continue
            owner, _, joint = claim.joint.partition("/")
            if Interface(joint, claim.name) not in plans[owner].references:
                valid = [f"{owner}/{reference}" for reference in plans[owner].references]
                error = by_name[name].error(f"controller {owner!r} has no reference {claim}", valid=valid)
                plans[name] = replace(plan, problem=str(error), error=error)
                break
    below = {name: chained_to(plan, plans) for name, plan in plans.items()}
    try:
        TopologicalSorter(below).prepare()
    except CycleError as error:
        circle = error.args[1][:-1]
        what = f"the controllers {', '.join(circle)} claim each other's references in a circle"
        raise by_name[circle[0]].error(what) from None


@lru_cache(maxsize=256)
def _hint(unknown: str, types: tuple[str, ...]) -> str:
    close = get_close_matches(unknown, types, n=1, cutoff=0.85)
    return f"did you mean {close[0]!r}?" if close else "a module that has it is named by --plugin"


def _check_joints(
    controller: ControllerParameters, claims: Sequence[Interface], description: RobotDescription, known: Container[str]
) -> None:
    seen = set()
    names = {*description.joints_by_name, *description.gpios}
    for claim in claims:
        owner, separator, _ = claim.joint.partition("/")
        if claim.joint not in names and not (separator and owner in known):
            place = next(_places(controller.parameters, claim.joint), ())
            valid = [joint.name for joint in description.movable_joints]
            raise controller.error(f"the robot has no joint {claim.joint!r}", *place, value=claim.joint, valid=valid)
        if claim in seen:
            *_, place = _places(controller.parameters, claim.joint)
            raise controller.error(f"duplicate joint {claim.joint!r}", *place)
        seen.add(claim)


def _places(value: Any, name: str, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Yield the paths of a name in the parameters."""
    if isinstance(value, str):
        if value == name:
            yield path
    elif isinstance(value, Mapping | list):
        for key, item in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from _places(item, name, (*path, key))


def _unusable(claim: Interface, description: RobotDescription, needs_interface: bool) -> str | None:
    """Return why a command interface cannot be claimed; None when it can."""
    gpio = description.gpios.get(claim.joint)
    if gpio is not None:
        return gpio.problem("command", claim.name)
    joint = description.joints_by_name[claim.joint]
    if not joint.is_movable:
        return f"joint {joint.name} is {joint.type} and cannot be commanded"
    controlled = description.controlled_joints.get(joint.name)
    interfaces = [item.name for item in controlled.command_interfaces] if controlled else []
    if claim.name not in interfaces and (needs_interface or not interfaces):
        has = f"it has {', '.join(interfaces)}" if interfaces else "it has no command interface"
        return f"joint {joint.name} has no {claim.name} command interface in <ros2_control> ({has})"
    if joint.mimic is not None:
        return f"joint {joint.name} follows another joint (mimic) and cannot be commanded"
    if claim.name not in ("position", "velocity", "effort"):
        return f"joint {joint.name}: the command interface {claim.name} is not supported"
    lower, upper = description.limits_of_command(joint.name, claim.name)
    if lower > upper:
        return f"joint {joint.name}: the URDF and <ros2_control> limits of {claim.name} do not overlap"
    return None
