"""What a robot's controllers amount to: typed parameters, claimed interfaces, and which are active at the start."""

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from drake_twin.controllers.controller import Interface
from drake_twin.controllers.joint_state_publisher import JointStateBroadcasterParameters
from drake_twin.controllers.sensor_broadcaster import SensorBroadcaster
from drake_twin.controllers.types import JOINT_STATE_BROADCASTER, controller_class
from drake_twin.description.controllers_yaml import HIGHEST_RATE, ControllerManagerParameters, ControllerParameters
from drake_twin.description.gazebo_drive import GazeboDrive
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.yaml_document import ValuePath
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.scenario import Robot, ScenarioError

UNLOADED, INACTIVE, ACTIVE = "unloaded", "inactive", "active"


class ControllerError(InputError):
    """A controller that is to be loaded and cannot be configured; ``controller`` is its name."""

    def __init__(self, controller: str, error: InputError):
        super().__init__(error.message, file=error.file, line=error.line, valid=error.valid, value=error.value)
        self.controller = controller


@dataclass(frozen=True)
class ControllerPlan:
    """A controller of a parameters file.

    Attributes:
        name: its name; its topics stand below it.
        type: the plugin's name.
        parameters: an instance of its class's ``Parameters``; None where ``problem`` says why there are none.
        claims: the command interfaces that it writes while it is active, in order.
        references: the references that other controllers may write, as they name them.
        state: what it is at the start: unloaded, inactive or active.
        update_rate: how often it is updated (Hz).
        problem: why it cannot be configured or activated; None when it can.
        topics: its own topic → the one in its place, below the robot's namespace or with a leading ``/``; a topic that
            is not here does not exist. None where its topics stand below its name.
        gz_topics: its own topic → its name in gz, by which a bridge may rename it; ``{model}`` stands for the robot.
        types: its own topic → the ROS type there, where it is another one.
        true_odometry: whether its odometry is the true pose instead of what the wheels tell.
    """

    name: str
    type: str
    parameters: Any = None
    claims: tuple[Interface, ...] = ()
    references: tuple[Interface, ...] = ()
    state: str = UNLOADED
    update_rate: float = 100.0
    problem: str | None = None
    topics: Mapping[str, str] | None = None
    gz_topics: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)
    true_odometry: bool = False


def plan_controllers(
    robot: Robot,
    path: ValuePath,
    description: RobotDescription,
    manager: ControllerManagerParameters,
    prefix: str,
    drives: Sequence[GazeboDrive] = (),
) -> tuple[tuple[ControllerPlan, ...], list[Finding]]:
    """Plans all controllers of a robot's parameters files.

    Args:
        robot: the scenario's entry; it says which are to be active.
        path: where the entry stands in the scenario, for error messages.
        description: the robot.
        manager: its parameters files.
        prefix: what the robot's joints have in front of the names in the parameters files, where they differ.
        drives: Gazebo plugins that are controllers, too; active from the start.

    Returns:
        The controllers; why some that were to be active are not, and what is ignored.

    Raises:
        InputError: a controller to be loaded is not there, or its parameters are wrong.
    """
    by_name = {controller.name: controller for controller in manager.controllers}
    chosen = _chosen(robot, path, by_name)
    by_drive = _drives_by_name(drives, by_name)
    chosen |= dict.fromkeys(by_drive, ACTIVE)
    by_name |= {name: replace(drive.controller, name=name) for name, drive in by_drive.items() if drive.controller}
    plans: dict[str, ControllerPlan] = {}
    findings: list[Finding] = []
    for name, controller in by_name.items():
        try:
            plan, ignored = _plan(controller, description, manager.update_rate, prefix, by_name)
        except InputError as error:
            if name in chosen:
                raise ControllerError(name, error) from None
            plan, ignored = ControllerPlan(name, controller.type, problem=str(error)), ()
        if name in by_drive:
            drive = by_drive[name]
            plan = replace(
                plan,
                topics=drive.topics,
                gz_topics=drive.gz_topics,
                types=drive.types,
                true_odometry=drive.true_odometry,
            )
        plans[name] = plan
        if name in chosen:
            findings += ignored
    _check_references(plans, chosen, by_name)
    claimed_by: dict[Interface, str] = {}
    for name, state in chosen.items():
        plan = plans[name]
        problem = plan.problem
        taken = next((claim for claim in plan.claims if claim in claimed_by), None)
        if problem is None and state == ACTIVE and taken is not None:
            problem = f"resource conflict, {taken} is already claimed by {claimed_by[taken]}"
            state = INACTIVE
        elif problem is not None:
            state = UNLOADED
        if problem is not None:
            findings.append(Finding.at(Kind.NOT_STARTED, f"controller {name}: {problem}", by_name[name].place()))
        if state == ACTIVE:
            claimed_by.update(dict.fromkeys(plan.claims, name))
        plans[name] = replace(plan, state=state)
    ordered = [*chosen, *(name for name in plans if name not in chosen)]
    return tuple(plans[name] for name in ordered), findings


def _drives_by_name(drives: Iterable[GazeboDrive], taken: Mapping[str, Any]) -> dict[str, GazeboDrive]:
    """Plugins under names that no controller has; of two broadcasters of joint states, ros2_control's is the one."""
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


def _chosen(robot: Robot, path: ValuePath, by_name: Mapping[str, ControllerParameters]) -> dict[str, str]:
    """Controllers to be loaded, in the order in which they are activated, and their state."""
    for entry in ("active_controllers", "inactive_controllers"):
        for name in getattr(robot, entry) or ():
            if name not in by_name:
                raise ScenarioError(
                    (*path, entry), f"the parameters files have no controller {name!r}", value=name, valid=by_name
                )
    active = by_name if robot.active_controllers is None else robot.active_controllers
    inactive = [name for name in robot.inactive_controllers if robot.active_controllers is None or name not in active]
    chosen = {name: ACTIVE for name in active if name not in inactive}
    return chosen | dict.fromkeys(inactive, INACTIVE)


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
    plan = ControllerPlan(controller.name, controller.type, update_rate=float(rate) or manager_rate)
    if controller.type == JOINT_STATE_BROADCASTER:
        parameters, ignored = read_parameters(JointStateBroadcasterParameters, controller)
        return replace(plan, parameters=parameters), ignored
    kind = controller_class(controller.type)
    if kind is None:
        return replace(plan, problem=f"type {controller.type} is not supported"), ()
    if prefix:
        joints = description.joints_by_name
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
    problem = next(filter(None, (_unusable(claim, description) for claim in own_joints)), None)
    if issubclass(kind, SensorBroadcaster):
        problem = problem or _no_sensor(kind.sensor_name(parameters), kind.kind, description)
    references = kind.reference_interfaces(parameters, description)
    return replace(plan, parameters=parameters, claims=claims, references=references, problem=problem), ignored


def broadcast_sensor(plan: ControllerPlan) -> str | None:
    """The sensor that a controller publishes, if it is one that does."""
    kind = controller_class(plan.type)
    if plan.parameters is None or plan.state == UNLOADED or kind is None or not issubclass(kind, SensorBroadcaster):
        return None
    name: str = kind.sensor_name(plan.parameters)
    return name


def _no_sensor(name: str, kind: str, description: RobotDescription) -> str | None:
    """Why a sensor cannot be broadcast; None when it can."""
    if description.sensor(name, kind) is not None or name in description.hardware_sensors:
        return None
    known = ", ".join(sensor.name for sensor in description.sensors if sensor.kind == kind) or "none"
    return f"the robot has no {kind} sensor {name!r} for Gazebo (it has {known})"


def _with_prefix(value: Any, prefix: str, joints: Mapping[str, Any]) -> Any:
    """Names of joints without their prefix, wherever they stand, as the robot has them."""
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
    for claim in claims:
        owner, separator, _ = claim.joint.partition("/")
        if claim.joint not in description.joints_by_name and not (separator and owner in known):
            place = next(_places(controller.parameters, claim.joint), ())
            valid = [joint.name for joint in description.movable_joints]
            raise controller.error(f"the robot has no joint {claim.joint!r}", *place, value=claim.joint, valid=valid)
        if claim in seen:
            *_, place = _places(controller.parameters, claim.joint)
            raise controller.error(f"joint {claim.joint!r} stands twice", *place)
        seen.add(claim)


def _places(value: Any, name: str, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Where a name stands in the parameters."""
    if isinstance(value, str):
        if value == name:
            yield path
    elif isinstance(value, Mapping | list):
        for key, item in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from _places(item, name, (*path, key))


def _unusable(claim: Interface, description: RobotDescription) -> str | None:
    """Why a command interface cannot be claimed; None when it can."""
    joint = description.joints_by_name[claim.joint]
    if not joint.is_movable:
        return f"joint {joint.name} is {joint.type} and cannot be commanded"
    controlled = description.controlled_joints.get(joint.name)
    interfaces = [item.name for item in controlled.command_interfaces] if controlled else []
    if claim.name not in interfaces:
        has = f"it has {', '.join(interfaces)}" if interfaces else "it has none"
        return f"joint {joint.name} has no {claim.name} command interface in <ros2_control> ({has})"
    if joint.mimic is not None:
        return f"joint {joint.name} follows another joint (mimic) and cannot be commanded"
    if claim.name not in ("position", "velocity", "effort"):
        return f"joint {joint.name}: the command interface {claim.name} has no meaning in the twin"
    lower, upper = description.limits_of_command(joint.name, claim.name)
    if lower > upper:
        return f"joint {joint.name}: no {claim.name} is within both its URDF and its <ros2_control> limits"
    return None


def _check_references(
    plans: dict[str, ControllerPlan], chosen: Mapping[str, str], by_name: Mapping[str, ControllerParameters]
) -> None:
    """Claims of other controllers' references: those must exist."""
    for name, plan in plans.items():
        for claim in plan.claims:
            if not is_chained(claim, plans):
                continue
            owner, _, joint = claim.joint.partition("/")
            if Interface(joint, claim.name) in plans[owner].references:
                continue
            valid = [f"{owner}/{reference}" for reference in plans[owner].references]
            error = by_name[name].error(f"controller {owner!r} has no reference {claim}", valid=valid)
            if name in chosen:
                raise error
            plans[name] = replace(plan, problem=str(error))
    for name in plans:
        circle = [name]
        while (below := next(iter(chained_to(plans[circle[-1]], plans)), None)) and below not in circle:
            circle.append(below)
        if below in circle:
            raise by_name[name].error(f"the controllers {', '.join(circle)} claim each other's references in a circle")


def is_chained(claim: Interface, controllers: Container[str]) -> bool:
    """Whether what is claimed is a reference of another controller; a slash alone is a part of a joint's name."""
    owner, slash, _ = claim.joint.partition("/")
    return bool(slash) and owner in controllers


def chained_to(plan: ControllerPlan, controllers: Container[str]) -> tuple[str, ...]:
    """The controllers that a controller writes to, in a chain."""
    owners = (claim.joint.partition("/")[0] for claim in plan.claims if is_chained(claim, controllers))
    return tuple(dict.fromkeys(owners))
