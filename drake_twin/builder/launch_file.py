"""The scenario of a ROS 2 launch file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from os.path import commonpath
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.builder.robot_file import PlannedScenario
from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER
from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_models import RobotModels
from drake_twin.diagram.footprint import height_on_ground
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, merged
from drake_twin.from_launch.launched_entities import LaunchedEntities, LaunchedFrame, RobotHint, launched_entities
from drake_twin.planning.bridged_sensors import misspelt, unpublished
from drake_twin.planning.controller_plan import ACTIVE, UNLOADED
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.topics import own_topics, topics_with_one_owner
from drake_twin.planning.world_sensors import plan_models
from drake_twin.scenario import Command, Scenario, ScenarioError, StaticTransform

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_description import LaunchDescription


@dataclass(frozen=True, kw_only=True)
class LaunchedTwin(PlannedScenario):
    """A launch file as a scenario, with findings of what the twin does not do.

    Attributes:
        paused: Whether the simulator starts paused, like gz without ``-r``.
        end: The simulation time (s) at which a timer of the launch file ends it; None without one.
        only_displayed: Whether no robot is spawned or controlled, so that no physics is needed.
        log: The output of the launch file, and the assumptions made.
    """

    paused: bool
    only_displayed: bool
    log: tuple[str, ...]
    end: float | None = None


def launch_file_scenario(
    file: str | Path,
    arguments: Mapping[str, str] | None = None,
    package_paths: Sequence[str] = (),
    *,
    time_step: float | None = None,
    words: Sequence[str] = (),
) -> LaunchedTwin:
    """Evaluate a launch file.

    Args:
        file: A Python, XML or YAML launch file.
        arguments: Values for its arguments.
        package_paths: Folders of ROS packages to search first.
        time_step: The physics step (s); by default the world's, or 0.001.
        words: How ``ros2 launch`` would be told the file, for files that look at ``sys.argv``; its path by default.

    Raises:
        InputError: If the file cannot be used or starts no robot; the text names everything that is missing.
    """
    from drake_twin.ros2.evaluate import evaluate

    packages = PackageIndex(package_paths)
    return _settled(launched_entities(evaluate(file, arguments, packages, words), Path(file), packages), time_step)


def launch_description_scenario(
    description: LaunchDescription,
    arguments: Mapping[str, str] | None = None,
    package_paths: Sequence[str] = (),
    *,
    time_step: float | None = None,
) -> LaunchedTwin:
    """Evaluate a launch description made in Python; see `launch_file_scenario`."""
    from drake_twin.ros2.evaluate import evaluate_description

    packages = PackageIndex(package_paths)
    file = Path("launch description" if description.place is None else description.place.file)
    launched = evaluate_description(description, arguments, packages)
    return _settled(launched_entities(launched, file, packages), time_step)


def _settled(launched: LaunchedEntities, time_step: float | None) -> LaunchedTwin:
    """Plan each robot once, and turn the hints of a launch file into numbers and findings."""
    findings = list(launched.findings)
    plans: list[RobotPlan] = []
    taken: set[str] = set()
    models = RobotModels(launched.packages)
    for hint in launched.robots:
        plan = _with_own_topics(_planned(hint, launched, taken, findings, models), taken, findings)
        taken |= topics_with_one_owner(plan)
        plans.append(plan)
    if launched.bridges:
        findings += unpublished(launched.bridges, (*plans, *plan_models(launched.sensing, launched.world.bridged)))
        findings += misspelt(launched.bridges, plans)
    step = time_step or launched.time_step or 0.001
    scenario = Scenario(
        robots=tuple(plan.robot for plan in plans),
        time_step=step,
        world=launched.world,
        package_paths=launched.folders,
        static_transforms=tuple(_usable_frames(launched.frames, plans, findings)),
        commands=tuple(_at_most_once_a_step(command, step) for command in launched.commands),
        findings=tuple(merged(findings)),
        nodes=launched.nodes,
    )
    return LaunchedTwin(
        scenario=scenario,
        plans=tuple(plans),
        paused=launched.paused,
        only_displayed=launched.only_displayed,
        end=launched.end,
        log=launched.log,
    )


def _planned(
    hint: RobotHint, launched: LaunchedEntities, taken: set[str], findings: list[Finding], models: RobotModels
) -> RobotPlan:
    """Plan a robot, without remappings to topics that other robots have."""
    remappings = {own: topic for own, topic in hint.robot.remappings.items() if topic not in taken}
    try:
        plan = plan_robot(replace(hint.robot, remappings=remappings), launched.packages, models=models)
    except ScenarioError as error:  # of what the launch file gives the robot
        if error.file is not None:
            raise
        raise InputError(error.reason, file=hint.place.file, line=hint.place.line, **error.more) from None
    plan = _without_missing_controllers(plan, hint, findings)
    if lone := _left_alone(plan, hint, findings):
        active = tuple(name for name in plan.robot.active_controllers or () if name not in lone)
        inactive = (*plan.robot.inactive_controllers, *lone)
        robot = replace(plan.robot, active_controllers=active, inactive_controllers=inactive)
        plan = plan_robot(robot, launched.packages)
    if launched.only_displayed:
        return _displayed(plan)
    if hint.on_ground and not plan.model.is_fixed:
        return replace(plan, robot=replace(plan.robot, xyz=(0.0, 0.0, height_on_ground(plan))))
    return plan


def _with_own_topics(plan: RobotPlan, taken: set[str], findings: list[Finding]) -> RobotPlan:
    """Give a robot the topics of Gazebo where another one has its topics, so that each hears its own commands."""
    own = own_topics(plan, taken)
    if not own:
        return plan
    if not any(topic.startswith(f"/model/{plan.name}/") for topic in plan.robot.remappings):
        below = commonpath(own.values())
        what = f"another robot has its topics, and no bridge names its own, which are those of Gazebo: {below}"
        findings.append(Finding(Kind.WARNING, what, robot=plan.robot.name))
    return replace(plan, robot=replace(plan.robot, remappings={**plan.robot.remappings, **own}))


def _without_missing_controllers(plan: RobotPlan, hint: RobotHint, findings: list[Finding]) -> RobotPlan:
    """Drop the controllers that are missing or wrong, each with a finding: their spawners would wait in vain.

    Raises:
        InputError: If a controller of a Gazebo plugin is wrong.
    """
    failed = {item.name: item.error for item in plan.controllers if item.error is not None}
    if not failed:
        return plan
    robot = plan.robot
    active, inactive, loaded = (
        robot.active_controllers or (),
        robot.inactive_controllers,
        robot.unconfigured_controllers,
    )
    for name, error in failed.items():
        if name not in (*active, *inactive, *loaded):
            raise error
        reason = error.reason if isinstance(error, ScenarioError) else str(error)
        what = f"controller {name} of {robot.name}: {reason}"
        findings.append(Finding.at(Kind.NOT_STARTED, what, hint.requests[name].place))
    known = [item for item in plan.controllers if item.error is None]
    known += [replace(item, error=None, state=UNLOADED) for item in plan.controllers if item.error and item.type]
    robot = replace(
        robot,
        active_controllers=tuple(name for name in active if name not in failed),
        inactive_controllers=tuple(name for name in inactive if name not in failed),
        unconfigured_controllers=tuple(name for name in loaded if name not in failed),
    )
    return replace(plan, robot=robot, controllers=tuple(known))


def _left_alone(plan: RobotPlan, hint: RobotHint, findings: list[Finding]) -> list[str]:
    """Return the controllers that are not activated because another one of their group is not, each with a finding."""
    active = {item.name for item in plan.controllers if item.state == ACTIVE}
    lone = []
    for name in plan.robot.active_controllers or ():
        process = hint.requests[name]
        if name in active and "--activate-as-group" in process.arguments:
            group = [other for other, own in hint.requests.items() if own is process]
            failed = next((other for other in group if other not in active), None)
            if failed is not None:
                lone.append(name)
                what = f"controller {name} of {plan.robot.name}: {failed!r} of its --activate-as-group is not active"
                findings.append(Finding.at(Kind.NOT_STARTED, what, process.place))
    return lone


def _displayed(plan: RobotPlan) -> RobotPlan:
    """Activate only the joint state broadcaster, which replaces a joint_state_publisher."""
    first = next((item for item in plan.controllers if item.type == JOINT_STATE_BROADCASTER), None)
    names = () if first is None else (first.name,)
    controllers = [
        replace(item, state=ACTIVE if item is first and item.problem is None else UNLOADED) for item in plan.controllers
    ]
    return replace(
        plan,
        robot=replace(plan.robot, active_controllers=names, inactive_controllers=()),
        controllers=tuple(controllers),
    )


def _usable_frames(
    frames: Sequence[LaunchedFrame], plans: Sequence[RobotPlan], findings: list[Finding]
) -> Iterator[StaticTransform]:
    """Yield the static transforms with which each frame, including the robots', has one parent."""
    parents = {
        plan.frame_prefix + joint.child: plan.frame_prefix + joint.parent
        for plan in plans
        for joint in plan.description.joints
    }
    for frame in frames:
        parent, child = frame.transform.parent, frame.transform.child
        if child in parents:
            reason = f"its parent is {parents[child]!r} already"
        elif child in _ancestors(parent, parents):
            reason = "it would be its own ancestor"
        else:
            parents[child] = parent
            yield frame.transform
            continue
        what = f"{frame.process.what} (frame {child!r}: {reason})"
        findings.append(Finding.at(Kind.NOT_STARTED, what, frame.process.place))


def _at_most_once_a_step(command: Command, step: float) -> Command:
    return command if command.period is None else replace(command, period=max(command.period, step))


def _ancestors(frame: str, parents: Mapping[str, str]) -> set[str]:
    found = {frame}
    while frame in parents and parents[frame] not in found:
        frame = parents[frame]
        found.add(frame)
    return found
