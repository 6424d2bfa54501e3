"""The plan of a robot's controllers: which are loaded, and which of these are active at the start."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerManagerParameters, ControllerParameters
from drake_twin.description.gazebo_drive import GazeboDrive
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.planning.controller_plan import ACTIVE, INACTIVE, UNCONFIGURED, UNLOADED, ControllerPlan, chained_to
from drake_twin.planning.frame_names import misspelt_frame
from drake_twin.planning.gazebo_drive_plan import drives_by_name, leave_one_transform, with_stamps
from drake_twin.planning.idle_hardware import idle_joints
from drake_twin.planning.plan_controller import check_references, plan_controller
from drake_twin.scenario import Robot, ScenarioError
from drake_twin.typed_data import ValuePath


def plan_controllers(
    robot: Robot,
    path: ValuePath,
    description: RobotDescription,
    manager: ControllerManagerParameters,
    drives: Sequence[GazeboDrive] = (),
) -> tuple[tuple[ControllerPlan, ...], list[Finding]]:
    """Plan all controllers of a robot's parameters files and Gazebo plugins.

    Args:
        robot: The scenario's entry, with the controllers that should be active.
        path: The path of the entry in the scenario, for error messages.
        description: The robot.
        manager: The content of its parameters files.
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
    by_drive = drives_by_name([with_stamps(drive, robot) for drive in drives], by_name)
    chosen |= dict.fromkeys(by_drive, ACTIVE)
    by_name |= {name: replace(drive.controller, name=name) for name, drive in by_drive.items() if drive.controller}
    plans: dict[str, ControllerPlan] = {}
    findings: list[Finding] = []
    for name, controller in by_name.items():
        try:
            plan, ignored = plan_controller(controller, description, manager.update_rate, by_name)
        except InputError as wrong:
            plan, ignored = ControllerPlan(name, controller.type, problem=str(wrong), error=wrong), ()
        if name in by_drive:
            drive = by_drive[name]
            plan = replace(plan, wiring=drive)
            if plan.error is not None and plan.error.file is None:
                plan.error.file, plan.error.line = drive.plugin.place.file, drive.plugin.place.line
        plans[name] = plan
        if name in chosen:
            findings += ignored
            base = str(getattr(plan.parameters, "base_frame_id", ""))
            if "base_frame_id" in controller.parameters and (why := misspelt_frame(base, description.links)):
                place = controller.place("base_frame_id") if controller.sources else by_drive[name].plugin.place
                findings.append(Finding.at(Kind.WARNING, f"controller {name}: base_frame_id: {why}", place))
    leave_one_transform(plans, chosen, robot)
    check_references(plans, by_name)
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
