"""Which of ROS's Python modules and names launch files find, and what stands behind each."""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from drake_twin.ros2 import (
    actions,
    ament_index,
    conditions,
    controller_launch_utils,
    entity,
    event_handlers,
    events,
    gz_actions,
    include,
    lifecycle,
    parameters,
    process_actions,
    rewritten_files,
    ros_actions,
    substitution,
    substitutions,
)
from drake_twin.ros2.context import LaunchContext
from drake_twin.ros2.frontend import FrontEnd
from drake_twin.ros2.launch_service import LaunchIntrospector, LaunchService, ReadyToTest
from drake_twin.ros2.python_module import (
    get_launch_description_from_python_launch_file,
    load_python_launch_file_as_module,
)
from drake_twin.ros2.substitution_text import parse_substitution


def _public(module: Any, kind: type) -> dict[str, Any]:
    """The public classes of a module that are of a kind."""
    return {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, kind) and not name.startswith("_")
    }


def _of(module: Any, *names: str) -> dict[str, Any]:
    return {name: getattr(module, name) for name in names}


_ROS_SUBSTITUTIONS = _of(
    substitutions, "ExecutableInPackage", "FindPackage", "FindPackagePrefix", "FindPackageShare", "Parameter"
)
_ROS_ACTIONS = {
    name: getattr(ros_actions, name)
    for name in ros_actions.__all__
    if name not in ("ComposableNode", "ComposableLifecycleNode")
}
_ROS_ACTIONS |= {"PushROSNamespace": ros_actions.PushRosNamespace, "ROSTimer": ros_actions.RosTimer}
_ROS_ACTIONS.pop("Parameter", None)
_SUBSTITUTIONS = {
    name: getattr(substitutions, name) for name in substitutions.__all__ if name not in _ROS_SUBSTITUTIONS
}
_ACTIONS = {
    name: value
    for name, value in (_public(actions, entity.Action) | _public(process_actions, entity.Action)).items()
    if name != "Action"
} | _of(include, "IncludeLaunchDescription")
_SOURCES = _public(include, include.LaunchDescriptionSource) | {
    "FrontendLaunchDescriptionSource": include.AnyLaunchDescriptionSource,
    "get_launch_description_from_python_launch_file": get_launch_description_from_python_launch_file,
    "load_python_launch_file_as_module": load_python_launch_file_as_module,
}
_SOURCES.pop("LaunchDescriptionSource")
_PYTHON_FILE_UTILITIES = {
    "get_launch_description_from_python_launch_file": get_launch_description_from_python_launch_file,
    "load_python_launch_file_as_module": load_python_launch_file_as_module,
}
_CONDITIONS = _public(conditions, conditions.Condition) | _of(
    conditions, "InvalidConditionExpressionError", "evaluate_condition_expression"
)
_CONDITIONS.pop("Condition")
_HANDLERS: dict[str, Any] = {
    name: value
    for name, value in _public(event_handlers, event_handlers.EventHandler).items()
    if name not in ("EventHandler", "OnStateTransition")
}
_HANDLERS["event_named"] = event_handlers.event_named
_PROCESS_EVENTS = _of(
    events,
    *("ProcessExited", "ProcessIO", "ProcessStarted", "ProcessStderr", "ProcessStdin", "ProcessStdout"),
    *("ProcessTargetedEvent", "ShutdownProcess", "SignalProcess", "matches_action", "matches_executable"),
    *("matches_name", "matches_pid"),
)
_EVENTS = _of(events, "ExecutionComplete", "IncludeLaunchDescription", "Shutdown", "TimerEvent", "matches_action")
_SOME_SUBSTITUTIONS = {
    "SomeSubstitutionsType": substitution.SomeSubstitutionsType,
    "SomeSubstitutionsType_types_tuple": (str, substitution.Substitution, list, tuple),
}
_SOME_ENTITIES = {"SomeEntitiesType": Any, "SomeActionsType": Any}
_UTILITIES = {
    "normalize_to_list_of_entities": entity.as_entities,
    "normalize_to_list_of_substitutions": substitution.normalize_to_list_of_substitutions,
    "perform_substitutions": substitution.perform_substitutions,
    "visit_all_entities_and_collect_futures": entity.visit_all_entities_and_collect_futures,
}
_TYPE_UTILITIES = {
    "normalize_typed_substitution": lambda value, data_type=None: value,
    "perform_typed_substitution": lambda context, value, data_type=None: parameters.ParameterValue(
        value, value_type=data_type
    ).evaluate(context),
}
_DESCRIPTIONS = _of(ros_actions, "ComposableLifecycleNode", "ComposableNode") | _of(
    parameters, "Parameter", "ParameterFile", "ParameterValue"
)
_PARAMETER_DESCRIPTIONS = _of(parameters, "Parameter", "ParameterFile", "ParameterValue")
_LOGGING = {
    "get_logger": lambda name=None: logging.getLogger(f"launch_file.{name}" if name else "launch_file"),
    "launch_config": SimpleNamespace(log_dir="", level=logging.INFO),
}
_FRONTEND = {
    "Parser": FrontEnd,
    "expose_action": lambda name: lambda cls: cls,
    "expose_substitution": lambda name: lambda cls: cls,
}
_TOP = (
    {
        "Action": entity.Action,
        "Condition": conditions.Condition,
        "Event": events.Event,
        "EventHandler": event_handlers.BaseEventHandler,
        "LaunchContext": LaunchContext,
        "LaunchDescription": entity.LaunchDescription,
        "LaunchDescriptionEntity": entity.LaunchDescriptionEntity,
        "LaunchDescriptionSource": include.LaunchDescriptionSource,
        "LaunchIntrospector": LaunchIntrospector,
        "LaunchService": LaunchService,
        "Substitution": substitution.Substitution,
    }
    | _SOME_SUBSTITUTIONS
    | _SOME_ENTITIES
)
_AMENT = _of(
    ament_index,
    *("PackageNotFoundError", "get_package_prefix", "get_package_share_directory", "get_package_share_path"),
    *("get_packages_with_prefixes", "get_resource", "get_resources", "get_search_paths", "has_resource"),
)
_ROS_UTILITIES = {
    "evaluate_parameters": parameters.evaluate_parameters,
    "evaluate_parameters_dict": parameters.evaluate_parameter_dict,
}

_MODULES: Mapping[str, Mapping[str, Any]] = {
    "launch": _TOP,
    "launch.action": _of(entity, "Action"),
    "launch.actions": _ACTIONS,
    "launch.condition": _of(conditions, "Condition"),
    "launch.conditions": _CONDITIONS,
    "launch.descriptions": _of(process_actions, "Executable"),
    "launch.event": _of(events, "Event"),
    "launch.event_handler": {
        "EventHandler": event_handlers.BaseEventHandler,
        "BaseEventHandler": event_handlers.BaseEventHandler,
    },
    "launch.event_handlers": _HANDLERS,
    "launch.events": _EVENTS,
    "launch.events.lifecycle": _of(events, "ChangeState", "StateTransition", "matches_node_name"),
    "launch.events.process": _PROCESS_EVENTS,
    "launch.events.matchers": _of(events, "matches_action"),
    "launch.frontend": _FRONTEND,
    "launch.frontend.parse_substitution": {"parse_substitution": parse_substitution},
    "launch.launch_context": {"LaunchContext": LaunchContext},
    "launch.launch_description": _of(entity, "LaunchDescription"),
    "launch.launch_description_entity": _of(entity, "LaunchDescriptionEntity"),
    "launch.launch_description_source": _of(include, "LaunchDescriptionSource"),
    "launch.launch_description_sources": _SOURCES,
    "launch.launch_description_sources.python_launch_file_utilities": _PYTHON_FILE_UTILITIES,
    "launch.launch_introspector": {"LaunchIntrospector": LaunchIntrospector},
    "launch.launch_service": {"LaunchService": LaunchService},
    "launch.logging": _LOGGING,
    "launch.some_entities_type": _SOME_ENTITIES,
    "launch.some_actions_type": _SOME_ENTITIES,
    "launch.some_substitutions_type": _SOME_SUBSTITUTIONS,
    "launch.substitution": _of(substitution, "Substitution"),
    "launch.substitutions": _SUBSTITUTIONS,
    "launch.utilities": _UTILITIES,
    "launch.utilities.type_utils": _TYPE_UTILITIES,
    "launch_ros": {},
    "launch_ros.actions": _ROS_ACTIONS,
    "launch_ros.descriptions": _DESCRIPTIONS,
    "launch_ros.event_handlers": _of(event_handlers, "OnStateTransition"),
    "launch_ros.events": _of(events, "matches_node_name"),
    "launch_ros.events.lifecycle": _of(events, "ChangeState", "StateTransition", "matches_node_name"),
    "launch_ros.parameter_descriptions": _PARAMETER_DESCRIPTIONS,
    "launch_ros.parameters_type": {"SomeParameters": Any, "SomeParametersDict": Any, "SomeParameterValue": Any},
    "launch_ros.remap_rule_type": {"SomeRemapRules": Any, "SomeRemapRule": Any},
    "launch_ros.substitutions": _ROS_SUBSTITUTIONS,
    "launch_ros.utilities": _ROS_UTILITIES,
    "controller_manager": {},
    "controller_manager.launch_utils": _of(
        controller_launch_utils,
        "generate_controllers_spawner_launch_description",
        "generate_controllers_spawner_launch_description_from_dict",
        "generate_load_controller_launch_description",
    ),
    "launch_testing": {},
    "launch_testing.actions": {"ReadyToTest": ReadyToTest},
    "launch_xml": {},
    "launch_xml.launch_description_sources": _of(include, "XMLLaunchDescriptionSource"),
    "launch_yaml": {},
    "launch_yaml.launch_description_sources": _of(include, "YAMLLaunchDescriptionSource"),
    "ament_index_python": _AMENT,
    "ament_index_python.packages": _AMENT,
    "ament_index_python.resources": _AMENT,
    "lifecycle_msgs": {},
    "lifecycle_msgs.msg": _of(lifecycle, "State", "Transition"),
    "nav2_common": {},
    "nav2_common.launch": _of(
        rewritten_files, "HasNodeParams", "LaunchConfigAsBool", "ParseMultiRobotPose", "ReplaceString", "RewrittenYaml"
    ),
    "ros_gz_bridge": {},
    "ros_gz_bridge.actions": _of(gz_actions, "RosGzBridge"),
    "ros_gz_sim": {},
    "ros_gz_sim.actions": _of(gz_actions, "GzServer", "GzSpawnModel"),
}

ROOTS = frozenset(name.partition(".")[0] for name in _MODULES)


def symbols(module: str) -> Mapping[str, Any] | None:
    """What a module of ROS holds; None if there is no such module.

    ``launch.actions.execute_process`` and the like hold what ``launch.actions`` does.
    """
    if module in _MODULES:
        return _MODULES[module]
    parent, _, last = module.rpartition(".")
    known = _MODULES.get(parent, {})
    class_name = re.sub(r"(?:^|_)([a-z0-9])", lambda match: match[1].upper(), last)
    names = {name.lower() for name in known}
    return known if class_name.lower() in names or last in known else None


def every_symbol() -> dict[str, Any]:
    """All actions, substitutions and the like by their own names, for plain Python programs."""
    merged: dict[str, Any] = {}
    for name in (
        *("launch", "launch.actions", "launch.conditions", "launch.event_handlers", "launch.substitutions"),
        *("launch.launch_description_sources", "launch_ros.actions", "launch_ros.descriptions"),
        *("launch_ros.substitutions", "nav2_common.launch"),
    ):
        for symbol, value in _MODULES[name].items():
            merged.setdefault(symbol, value)
    return merged
