"""From a robot's files to its plan, one decision after another: model, drives, controllers, joints, sensors, frames."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from drake_twin.description.gazebo_drives import gazebo_drives
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_models import RobotModels
from drake_twin.description.xacro_file import xacro_arguments
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Findings, Kind
from drake_twin.planning.frame_names import frame_prefix
from drake_twin.planning.gazebo_drive_plan import usable_drives, with_actuators
from drake_twin.planning.joint_plan import plan_joints, with_joint_friction
from drake_twin.planning.manager_parameters import manager_parameters
from drake_twin.planning.plan_controllers import plan_controllers
from drake_twin.planning.plugin_remappings import with_plugin_remappings
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.sensor_plan import plan_sensors
from drake_twin.scenario import Robot, ScenarioError
from drake_twin.typed_data import ValuePath


def plan_robot(
    robot: Robot, packages: PackageIndex, path: ValuePath = (), models: RobotModels | None = None
) -> RobotPlan:
    """Read a robot's files and plan what the twin starts of them.

    Args:
        robot: The scenario's entry.
        packages: Resolves the addresses of files.
        path: The path of the entry in the scenario, for error messages.
        models: The models of the robots that are planned with it.

    Raises:
        InputError: If a file or a joint is missing or wrong.
    """
    file, arguments, warnings = _arguments(robot, packages, path)
    model = (models or RobotModels(packages)).load(
        robot.model,
        name=robot.name,
        xacro_args=arguments,
        without_repairs=robot.without_repairs,
        collision=robot.collision,
    )
    own = model.description
    manager = manager_parameters(robot, path, own, packages, arguments)
    plugins = gazebo_drives(own)
    drives, of_drives = usable_drives(plugins, model.is_fixed)
    description = with_joint_friction(robot, path, with_actuators(own, drives))
    robot = with_plugin_remappings(robot, own, [item.name for item in manager.controllers])
    controllers, of_controllers = plan_controllers(robot, path, description, manager, drives)
    joints, of_joints = plan_joints(robot, path, own, description, drives, manager.update_rate)
    prefix = frame_prefix(robot, description)
    sensors, of_sensors = plan_sensors(robot, description, prefix)
    of_values = [Finding(Kind.WARNING, warning) for warning in (*warnings, *of_joints)]
    findings = (*model.findings, *of_drives, *manager.findings, *of_controllers, *of_values, *of_sensors)
    return RobotPlan(
        robot=robot,
        model=replace(model, description=description),
        manager=manager,
        controllers=controllers,
        joints=joints,
        sensors=sensors,
        frame_prefix=prefix,
        findings=Findings(replace(item, robot=robot.name, file=item.file or str(file)) for item in findings),
        triggers=tuple(trigger for item in plugins for trigger in item.triggers),
        performers=tuple(performer for item in plugins for performer in item.performers),
        detectors=tuple(detector for item in plugins for detector in item.detectors),
        touches=tuple(touch for item in plugins for touch in item.touches),
    )


def _arguments(robot: Robot, packages: PackageIndex, path: ValuePath) -> tuple[Path, Mapping[str, str], list[str]]:
    """Return a robot's file, the values of its arguments, and warnings of those that it does not have."""
    try:
        file = packages.resolve(robot.model)
    except InputError as error:
        raise ScenarioError((*path, "model"), str(error)) from None
    declared = xacro_arguments(file, packages)
    own = {"robot_name": robot.name} if "robot_name" in declared else {}
    warnings = [
        f"{file.name} has no xacro argument {name!r} (it has {', '.join(sorted(declared)) or 'none'})"
        for name in robot.xacro_args
        if name not in declared
    ]
    return file, {**own, **robot.xacro_args}, warnings
