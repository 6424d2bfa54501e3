"""The plan of a robot's controllers: those of its parameters files and those of its Gazebo plugins."""

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache
from graphlib import CycleError, TopologicalSorter
from typing import Any

from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER, controller_class, controller_types
from drake_twin.description.controllers_yaml import HIGHEST_RATE, ControllerManagerParameters, ControllerParameters
from drake_twin.description.gazebo_drive import ODOMETRY_PUBLISHER, GazeboDrive, of_model
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.yaml_document import ValuePath
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.planning.controller_plan import (
    ACTIVE,
    INACTIVE,
    UNCONFIGURED,
    UNLOADED,
    ControllerPlan,
    Wiring,
    chained_to,
    is_chained,
)
from drake_twin.planning.frame_names import misspelt_frame
from drake_twin.planning.idle_hardware import idle_joints
from drake_twin.scenario import Robot, ScenarioError


def plan_controllers(
    robot: Robot,
    path: ValuePath,
    description: RobotDescription,
    manager: ControllerManagerParameters,
    prefix: str,
    drives: Sequence[GazeboDrive] = (),
) -> tuple[tuple[ControllerPlan, ...], list[Finding]]:
    """Plan all controllers of a robot's parameters files and Gazebo plugins.

    Args:
        robot: The scenario's entry, with the controllers that should be active.
        path: The path of the entry in the scenario, for error messages.
        description: The robot.
        manager: The content of its parameters files.
        prefix: The prefix of the robot's joints that the names in the parameters files lack.
        drives: The Gazebo plugins that become controllers; they are active at the start.

    Returns:
        The controllers, first those to be loaded. A controller that should be loaded and is missing or has wrong
        parameters has an ``error``. And the findings: controllers that are not active for another reason, and ignored
        entries.

    Raises:
        InputError: If controllers claim each other's references in a circle.
    """
    by_name = {controller.name: controller for controller in manager.controllers}
    chosen = _chosen(robot, by_name)
    by_drive = _drives_by_name([_with_stamps(drive, robot) for drive in drives], by_name)
    chosen |= dict.fromkeys(by_drive, ACTIVE)
    by_name |= {name: replace(drive.controller, name=name) for name, drive in by_drive.items() if drive.controller}
    plans: dict[str, ControllerPlan] = {}
    findings: list[Finding] = []
    for name, controller in by_name.items():
        plan, ignored = _plan_or_error(controller, description, manager.update_rate, prefix, by_name)
        if name in by_drive:
            drive = by_drive[name]
            plan = replace(plan, wiring=_wiring(drive))
            if plan.error is not None and plan.error.file is None:
                plan.error.file, plan.error.line = drive.plugin.place.file, drive.plugin.place.line
        plans[name] = plan
        if name in chosen:
            findings += ignored
            base = str(getattr(plan.parameters, "base_frame_id", ""))
            if "base_frame_id" in controller.parameters and (why := misspelt_frame(base, description.links)):
                place = controller.place("base_frame_id") if controller.sources else by_drive[name].plugin.place
                findings.append(Finding.at(Kind.WARNING, f"controller {name}: base_frame_id: {why}", place))
    _leave_one_transform(plans, chosen, robot)
    _check_references(plans, by_name)
    for name in plans.keys() - chosen.keys():
        plans[name] = replace(plans[name], error=None)  # irrelevant until it is loaded
    for error in _missing(robot, path, by_name):
        name = str(error.value)
        plans[name] = ControllerPlan(name, "", problem=error.reason, error=error)
    states = {name: state for name, (state, _) in manager.hardware_states.items()}
    unusable = idle_joints(description, states, uses_inactive=manager.uses_inactive_hardware)
    for name, plan, taken_by in _settled(chosen, plans, unusable):
        plans[name] = plan
        problem = taken_by or plan.problem
        if problem is not None and plan.error is None:
            place = by_name[name].place(*(("type",) if controller_class(plan.type) is None else ()))
            common = f": {problem}"
            findings.append(Finding.at(Kind.NOT_STARTED, f"controller {name}{common}", place, common=common))
    ordered = [*chosen, *(name for name in plans if name not in chosen)]
    return tuple(plans[name] for name in ordered), findings


def _wiring(drive: GazeboDrive) -> Wiring:
    return Wiring(drive.topics, drive.gz_topics, drive.types, drive.elements, drive.true_odometry)


def _leave_one_transform(plans: dict[str, ControllerPlan], chosen: Iterable[str], robot: Robot) -> None:
    """Leave the base's transform to the plugins of Gazebo whose own a bridge takes to ``/tf``.

    Without a bridge for it, gz-sim's OdometryPublisher leaves it to a drive.
    """
    names = [name for name in chosen if name in plans]
    left = [name for name in names if getattr(plans[name].parameters, "enable_odom_tf", False)]
    topics = {name: _transform_topic(plans[name], robot) for name in left}
    bridged = [name for name, topic in topics.items() if topic and robot.remappings.get(topic) == "/tf"]
    for name in [name for name in reversed(left) if name not in bridged]:
        if len(left) > 1 and (plans[name].type == ODOMETRY_PUBLISHER or (bridged and topics[name])):
            plans[name] = replace(plans[name], parameters=replace(plans[name].parameters, enable_odom_tf=False))
            left.remove(name)


def _transform_topic(plan: ControllerPlan, robot: Robot) -> str:
    """Return the topic of Gazebo on which a plugin publishes the base's transform; empty for other controllers."""
    topic = "" if plan.wiring is None else of_model(plan.wiring.gz_topics.get("tf_odometry", ""), robot.name)
    return f"/{topic.lstrip('/')}" if topic else ""


_UNSTAMPED = "_unstamped"


def _with_stamps(drive: GazeboDrive, robot: Robot) -> GazeboDrive:
    """Return a drive that listens to messages with a header, where a bridge has them on its topic."""
    stamped = [
        own
        for own, topic in drive.gz_topics.items()
        if own.endswith(_UNSTAMPED) and f"/{of_model(topic, robot.name).lstrip('/')}" in robot.stamped_topics
    ]
    if not stamped or drive.controller is None:
        return drive
    names = {own: own.removesuffix(_UNSTAMPED) if own in stamped else own for own in (*drive.topics, *drive.gz_topics)}
    parameters = {**drive.controller.parameters, "use_stamped_vel": True}
    return replace(
        drive,
        controller=replace(drive.controller, parameters=parameters),
        topics={names[own]: topic for own, topic in drive.topics.items()},
        gz_topics={names[own]: topic for own, topic in drive.gz_topics.items()},
    )


_Settled = tuple[str, ControllerPlan, str | None]


def _settled(
    chosen: Mapping[str, str], plans: Mapping[str, ControllerPlan], unusable_joints: Mapping[str, str]
) -> list[_Settled]:
    """Return each chosen controller with its state at the start, and the conflict that prevents its activation."""
    idle: dict[str, str] = {}
    while True:
        settled = list(_settled_without(idle, chosen, plans, unusable_joints))
        active = {name for name, plan, _ in settled if plan.state == ACTIVE}
        loose = ((name, below) for name in chosen if name in active for below in chained_to(plans[name], plans))
        found = next(((name, below) for name, below in loose if below not in active), None)
        if found is None:
            return settled
        idle[found[0]] = found[1]  # which frees its claims


def _settled_without(
    idle: Mapping[str, str],
    chosen: Mapping[str, str],
    plans: Mapping[str, ControllerPlan],
    unusable_joints: Mapping[str, str],
) -> Iterator[_Settled]:
    """Yield the same if some controllers write to one that is not active."""
    claimed_by: dict[Interface, str] = {}
    for name, wanted in chosen.items():
        plan, state, conflict = plans[name], wanted, None
        lacking = next((other for other in plan.fallbacks if other not in chosen), None)
        unusable = next((unusable_joints[claim.joint] for claim in plan.claims if claim.joint in unusable_joints), None)
        taken = next((claim for claim in plan.claims if claim in claimed_by), None)
        if plan.problem is not None:
            state = UNLOADED
        elif wanted == ACTIVE and lacking is not None:
            conflict = f"its fallback controller {lacking!r} is not loaded"
            state = INACTIVE
        elif wanted == ACTIVE and unusable is not None:
            conflict = unusable
            state = INACTIVE
        elif name in idle:
            conflict = f"it writes to {idle[name]}, which is not active"
            state = INACTIVE
        elif wanted == ACTIVE and taken is not None:
            conflict = f"resource conflict, {taken} is already claimed by {claimed_by[taken]}"
            state = INACTIVE
        if state == ACTIVE:
            claimed_by.update(dict.fromkeys(plan.claims, name))
        yield name, replace(plan, state=state), conflict


def _drives_by_name(drives: Iterable[GazeboDrive], taken: Mapping[str, Any]) -> dict[str, GazeboDrive]:
    """Return plugins under unused names; of two joint state broadcasters ros2_control's is kept."""
    has_broadcaster = any(item.type == JOINT_STATE_BROADCASTER for item in taken.values())
    found: dict[str, GazeboDrive] = {}
    for drive in drives:
        if drive.controller is None or (has_broadcaster and drive.controller.type == JOINT_STATE_BROADCASTER):
            continue
        name = drive.controller.name
        while name in taken or name in found:
            name += "_plugin"
        found[name] = drive
    return found


def _chosen(robot: Robot, known: Mapping[str, ControllerParameters]) -> dict[str, str]:
    """Return the controllers to load, in the order of their activation, each with its wanted state."""
    active = known if robot.active_controllers is None else robot.active_controllers
    inactive = [name for name in robot.inactive_controllers if robot.active_controllers is None or name not in active]
    if robot.active_controllers is None:  # what replaces another one waits for its failure
        inactive += [name for controller in known.values() for name in _fallbacks(controller) if name not in inactive]
    chosen = {name: ACTIVE for name in active if name not in inactive}
    chosen |= dict.fromkeys(inactive, INACTIVE)
    chosen |= dict.fromkeys(robot.unconfigured_controllers, UNCONFIGURED)
    return {name: state for name, state in chosen.items() if name in known}


def _fallbacks(controller: ControllerParameters) -> tuple[str, ...]:
    try:
        return controller.names("fallback_controllers")
    except InputError:  # reported with the controller
        return ()


def _missing(robot: Robot, path: ValuePath, known: Mapping[str, ControllerParameters]) -> Iterator[ScenarioError]:
    """Yield an error for each controller that should be loaded and is missing in the parameters files."""
    for entry in ("active_controllers", "inactive_controllers", "unconfigured_controllers"):
        for name in getattr(robot, entry) or ():
            if name not in known:
                text = f"the parameters files have no controller {name!r}"
                yield ScenarioError((*path, entry), text, value=name, valid=known)


def _plan_or_error(
    controller: ControllerParameters,
    description: RobotDescription,
    manager_rate: float,
    prefix: str,
    known: Container[str],
) -> tuple[ControllerPlan, tuple[Finding, ...]]:
    try:
        return _plan(controller, description, manager_rate, prefix, known)
    except InputError as error:
        return ControllerPlan(controller.name, controller.type, problem=str(error), error=error), ()


def _plan(
    controller: ControllerParameters,
    description: RobotDescription,
    manager_rate: float,
    prefix: str,
    known: Container[str],
) -> tuple[ControllerPlan, tuple[Finding, ...]]:
    rate = controller.parameters.get("update_rate", manager_rate)
    if isinstance(rate, bool) or not isinstance(rate, int | float) or not 0 <= rate < HIGHEST_RATE:
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
    if prefix:
        joints = {*description.joints_by_name, *description.gpios}
        own = replace(controller, parameters=_with_prefix(controller.parameters, prefix, joints))
    else:
        own = controller
    parameters, ignored = read_parameters(kind.Parameters, own)
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


@lru_cache(maxsize=256)
def _hint(unknown: str, types: tuple[str, ...]) -> str:
    close = get_close_matches(unknown, types, n=1, cutoff=0.85)
    return f"did you mean {close[0]!r}?" if close else "a module that has it is named by --plugin"


def _with_prefix(value: Any, prefix: str, joints: Container[str]) -> Any:
    """Return a parameter with the prefix added to the names of joints and GPIOs, at any depth."""
    if isinstance(value, str):
        return prefix + value if value not in joints and prefix + value in joints else value
    if isinstance(value, Mapping):
        return {_with_prefix(key, prefix, joints): _with_prefix(item, prefix, joints) for key, item in value.items()}
    if isinstance(value, list):
        return [_with_prefix(item, prefix, joints) for item in value]
    return value


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


def _check_references(plans: dict[str, ControllerPlan], by_name: Mapping[str, ControllerParameters]) -> None:
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
