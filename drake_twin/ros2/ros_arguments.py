"""The arguments after ``--ros-args`` on a node's command line."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.ros2.launched import ParameterValue


@dataclass(frozen=True)
class RosArguments:
    """A node's command line, split.

    Attributes:
        arguments: The executable's own arguments.
        name: The node's name from ``-r __node:=``.
        namespace: Its namespace from ``-r __ns:=``.
        remappings: (from, to) pairs.
        parameters: Files and single values, in order.
        log_levels: (logger, level) pairs; the logger is empty for all.
        publishes_log: Whether the nodes' logs are published on ``/rosout``.
    """

    arguments: tuple[str, ...]
    name: str | None = None
    namespace: str | None = None
    remappings: tuple[tuple[str, str], ...] = ()
    parameters: tuple[Path | Mapping[str, ParameterValue], ...] = ()
    log_levels: tuple[tuple[str, str], ...] = ()
    publishes_log: bool = True

    def before(self, others: "RosArguments") -> "RosArguments":
        """Return these arguments with others that count where these say nothing."""
        return RosArguments(
            self.arguments,
            self.name or others.name,
            self.namespace or others.namespace,
            self.remappings + others.remappings,  # the first rule that matches wins
            others.parameters + self.parameters,  # the last value counts
            self.log_levels + others.log_levels,
            self.publishes_log and others.publishes_log,
        )


def split_ros_arguments(words: Sequence[str]) -> RosArguments:
    """Split a command line's arguments: ``--ros-args`` … ``--`` are rcl's, the others the executable's."""
    own: list[str] = []
    remappings: list[tuple[str, str]] = []
    parameters: list[Path | Mapping[str, ParameterValue]] = []
    log_levels: list[tuple[str, str]] = []
    names: dict[str, str] = {}
    ros, publishes_log = False, True
    rest = iter(words)
    for word in rest:
        if word == "--ros-args" or (ros and word == "--"):
            ros = word == "--ros-args"
        elif not ros:
            own.append(word)
        elif word in ("--enable-rosout-logs", "--disable-rosout-logs"):
            publishes_log = word == "--enable-rosout-logs"
        elif word in ("-r", "--remap", "-p", "--param", "--params-file", "--log-level", "-e", "--enclave"):
            value = next(rest, "")
            source, _, target = value.partition(":=")
            if word in ("-r", "--remap") and source in ("__ns", "__node", "__name"):
                names["namespace" if source == "__ns" else "name"] = target
            elif word in ("-r", "--remap"):
                remappings.append((source, target))
            elif word in ("-p", "--param"):
                parameters.append({source.rpartition(":")[2]: _value(target)})
            elif word == "--params-file":
                parameters.append(Path(value))
            elif word == "--log-level":
                log_levels.append((source, target) if target else ("", value))
    name, namespace = names.get("name"), names.get("namespace")
    items = tuple(remappings), tuple(parameters), tuple(log_levels)
    return RosArguments(tuple(own), name, namespace, *items, publishes_log)


def without_ros_arguments(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return a command line without ``--ros-args`` … ``--``, and those with ``--ros-args`` before them."""
    own: list[str] = []
    of_ros: list[str] = []
    ros = False
    for word in words:
        if word == "--ros-args" or (ros and word == "--"):
            ros = word == "--ros-args"
        else:
            (of_ros if ros else own).append(word)
    return own, ["--ros-args", *of_ros] if of_ros else []


def ros_arguments(
    name: str,
    namespace: str,
    remappings: Sequence[tuple[str, str]],
    parameters: Sequence[Path | Mapping[str, Any]],
) -> tuple[str, ...]:
    """Return the command line that `split_ros_arguments` reads as these values.

    Args:
        name: The node's name; empty for its own.
        namespace: The node's namespace; empty for its own.
        remappings: (from, to) pairs.
        parameters: Files and mappings, in order.
    """
    words = []
    for key, value in (("__node", name), ("__ns", namespace), *remappings):
        if value:
            words += ["-r", f"{key}:={value}"]
    for item in parameters:
        if isinstance(item, Mapping):
            for key, value in item.items():
                words += ["-p", f"{key}:={_text(value)}"]
        else:
            words += ["--params-file", str(item)]
    return ("--ros-args", *words) if words else ()


def _text(value: Any) -> str:
    """Return a parameter's value as YAML on one line."""
    plain = list(value) if isinstance(value, tuple) else value
    text = yaml.safe_dump(plain, default_flow_style=True, width=10**9, allow_unicode=True)
    return text.removesuffix("...\n").strip()


def _value(text: str) -> ParameterValue:
    try:
        value = load_yaml(text)
    except yaml.YAMLError:
        return text
    if isinstance(value, bool | int | float | str):
        return value
    return tuple(value) if isinstance(value, list) else text
