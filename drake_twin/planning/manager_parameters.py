"""The parameters of a robot's controllers: those of its files, with what the scenario adds and replaces."""

import os
from collections.abc import Container, Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER
from drake_twin.description.controllers_yaml import ControllerManagerParameters, ControllerParameters, read_controllers
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.scenario import Robot, ScenarioError
from drake_twin.typed_data import ValuePath


def manager_parameters(
    robot: Robot, path: ValuePath, description: RobotDescription, packages: PackageIndex, arguments: Mapping[str, str]
) -> ControllerManagerParameters:
    """Return the parameters of a robot's controller manager and its controllers.

    Args:
        robot: The scenario's entry.
        path: The path of the entry in the scenario, for error messages.
        description: The robot as its file describes it.
        packages: Resolves the addresses of files.
        arguments: The values of the file's arguments, which stand for placeholders; ``prefix`` is that of the robot's
            joints, which the names in the parameters files lack.

    Raises:
        InputError: If a file is missing or wrong, or the scenario names an unknown controller.
    """
    files = robot.controllers or description.controller_files
    if files:
        manager = _read(files, robot, path, description, packages, arguments)
    else:
        manager = ControllerManagerParameters() if robot.added_controllers else _default_controllers(description)
    manager = _with_parameters(robot, path, _with_added(robot, path, manager))
    prefix = arguments.get("prefix", "")
    if not prefix:
        return manager
    names = {*description.joints_by_name, *description.gpios}
    controllers = (
        replace(item, parameters=_with_prefix(item.parameters, prefix, names)) for item in manager.controllers
    )
    return replace(manager, controllers=tuple(controllers))


def _read(
    files: Sequence[str],
    robot: Robot,
    path: ValuePath,
    description: RobotDescription,
    packages: PackageIndex,
    arguments: Mapping[str, str],
) -> ControllerManagerParameters:
    placeholders = {"robot_name": robot.name, **arguments}
    resolved = []
    for file in files:
        try:
            resolved.append(packages.resolve_as_started(file, description.file))
        except InputError as error:
            name = Path(file).name  # a launch file gives the plugin's own as an absolute path
            named = [
                item.place for item in description.plugins if name in {Path(each).name for each in item.parameters}
            ]
            if named:
                what = f"the ros2_control plugin's parameters file: {error}"
                raise InputError(what, file=named[0].file, line=named[0].line) from None
            raise ScenarioError((*path, "controllers"), str(error)) from None
    parameters = read_controllers(resolved, robot.topic_namespace, placeholders)
    for plugin in description.plugins:
        if not parameters.controllers and plugin.namespace:  # for the namespace in the robot's file
            parameters = read_controllers(resolved, f"/{plugin.namespace.strip('/')}", placeholders)
    findings = [
        Finding(Kind.WARNING, f"the controllers' file {given} is not on this machine: {file} is used")
        for given, file in zip(files, resolved, strict=True)
        if Path(given).is_absolute() and Path(os.path.abspath(given)) != file
    ]
    if not parameters.controllers and not robot.added_controllers:
        what = (
            f"{', '.join(map(str, files))}: no controllers found for the namespace {robot.topic_namespace or '/'!r};"
            " they must be below 'controller_manager:' and 'ros__parameters:', each with its 'type:'"
        )
        findings.append(Finding(Kind.WARNING, what))
    systems = {system.name for system in description.systems}
    findings += [
        Finding.at(Kind.WARNING, f"hardware component {name!r} is unknown, so it is not set to {state}", place)
        for name, (state, place) in parameters.hardware_states.items()
        if name not in systems
    ]
    return replace(parameters, findings=(*parameters.findings, *findings))


def _with_added(robot: Robot, path: ValuePath, manager: ControllerManagerParameters) -> ControllerManagerParameters:
    """Return the parameters files' controllers and those that the scenario adds."""
    added = []
    for name, entry in robot.added_controllers.items():
        parameters = dict(entry)
        kind = parameters.pop("type", None)
        if not isinstance(kind, str):
            raise ScenarioError((*path, "added_controllers", name), "the controller has no type")
        if any(controller.name == name for controller in manager.controllers):
            raise ScenarioError(
                (*path, "added_controllers", name), "the parameters files have a controller of this name"
            )
        added.append(ControllerParameters(name, kind, parameters))
    return replace(manager, controllers=(*added, *manager.controllers)) if added else manager


def _with_parameters(
    robot: Robot, path: ValuePath, manager: ControllerManagerParameters
) -> ControllerManagerParameters:
    """Return the controllers with the parameters that the scenario replaces."""
    if not robot.controller_parameters:
        return manager
    known = {controller.name: controller for controller in manager.controllers}
    for name, given in robot.controller_parameters.items():
        if name not in known:
            at = (*path, "controller_parameters", name)
            raise ScenarioError(at, f"the robot has no controller {name!r}", value=name, valid=known)
        parameters = deepcopy(dict(known[name].parameters))
        for parameter, value in given.items():
            *folders, last = parameter.split(".")
            place = parameters
            for folder in folders:
                below = place.get(folder)
                place[folder] = below = below if isinstance(below, dict) else {}
                place = below
            place[last] = value
        known[name] = replace(known[name], parameters=parameters)
    return replace(manager, controllers=tuple(known.values()))


def _default_controllers(description: RobotDescription) -> ControllerManagerParameters:
    """Return the controllers of a robot without parameters files: every joint can be commanded in one way."""
    joints: dict[str, list[str]] = {}
    for joint in description.actuated_joints:
        interfaces = [item.name for item in description.controlled_joints[joint.name].command_interfaces]
        preferred = next((name for name in ("velocity", "position", "effort") if name in interfaces), "")
        if preferred:
            joints.setdefault(preferred, []).append(joint.name)
    if not joints:
        return ControllerManagerParameters()
    kind = "forward_command_controller/ForwardCommandController"
    return ControllerManagerParameters(
        controllers=(
            ControllerParameters("joint_state_broadcaster", JOINT_STATE_BROADCASTER, {}),
            *(
                ControllerParameters(f"forward_{name}_controller", kind, {"joints": names, "interface_name": name})
                for name, names in joints.items()
            ),
        )
    )


def _with_prefix(value: Any, prefix: str, joints: Container[str]) -> Any:
    """Return a parameter with the prefix added to the names of joints and GPIOs, at any depth."""
    if isinstance(value, str):
        return prefix + value if value not in joints and prefix + value in joints else value
    if isinstance(value, Mapping):
        return {_with_prefix(key, prefix, joints): _with_prefix(item, prefix, joints) for key, item in value.items()}
    if isinstance(value, list):
        return [_with_prefix(item, prefix, joints) for item in value]
    return value
