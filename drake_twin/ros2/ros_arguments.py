"""The arguments after ``--ros-args`` on a node's command line.

Source: ros2/rcl (jazzy), rcl/src/rcl/arguments.c.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from drake_twin.dataclass import dataclass
from drake_twin.description.source_file import file_text
from drake_twin.ros2.launched import ParameterValue
from drake_twin.ros2.rcl_yaml import Parameters, RclYamlError, read_parameters, read_value

OWN_NODE = (
    "__node"  # before a parameter's name: it is for the node that is started, as launch_ros writes it for a named one
)
_WITH_VALUE = (
    *("-r", "--remap", "-p", "--param", "--params-file", "--log-level", "-e", "--enclave"),
    "--log-config-file",
)
_SWITCHES = tuple(f"--{word}able-{log}-logs" for word in ("en", "dis") for log in ("rosout", "stdout", "external-lib"))
_SEVERITY = re.compile(r"debug|info|warn|error|fatal", re.IGNORECASE)
_NAME = r"[A-Za-z_]\w*"
_TEXTS = {
    "-p": "parameter override rule",
    "-r": "remap rule",
    "--params-file": "params file",
    "--log-level": "log level",
}
_PART = r"(?:(?:[A-Za-z]|_(?!_))\w*|/)+"  # of a parameter's name, between dots
_RULES = {
    "-p": re.compile(rf"(?:{_NAME}:)?{_PART}(?:\.{_PART})*:=.+", re.ASCII | re.DOTALL),
    "-r": re.compile(
        rf"(?:{_NAME}:)?(?:__(?:node|name):={_NAME}|__ns:=/(?:{_NAME}(?:/{_NAME})*)?"
        rf"|(?!__)(?:(?:rostopic|rosservice)://)?[\w~/{{}}*\\]+:=[\w~/{{}}*\\]+)",
        re.ASCII,
    ),
}


class RosArgumentsError(ValueError):
    """Raised for arguments that rcl refuses."""


class UnknownRosArgumentsError(ValueError):
    """Raised for arguments after ``--ros-args`` that rcl does not know."""


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

    def name_for(self, node: str) -> str | None:
        """Return the name in place of a node's own; None if it keeps it."""
        return self.name or dict(reversed(self.remappings)).get(f"{node}:__node")

    def namespace_for(self, node: str) -> str | None:
        """Return the namespace in place of a node's own; None if it keeps it."""
        return self.namespace or dict(reversed(self.remappings)).get(f"{node}:__ns")

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
    parameters: list[Path | Mapping[str, Any]] = []
    log_levels: list[tuple[str, str]] = []
    names: dict[str, str] = {}
    ros, publishes_log = False, True
    rest = iter(words)
    for word in rest:
        if word == "--ros-args" or (ros and word == "--"):
            ros = word == "--ros-args"
        elif not ros:
            own.append(word)
        elif word in _SWITCHES:
            publishes_log = (word == "--enable-rosout-logs") if "rosout" in word else publishes_log
        elif word in _WITH_VALUE:
            value = next(rest, "")
            source, _, target = value.partition(":=")
            if word in ("-r", "--remap") and source in ("__ns", "__node", "__name"):
                names.setdefault("namespace" if source == "__ns" else "name", target)  # the first one counts
            elif word in ("-r", "--remap"):
                remappings.append((source, target))
            elif word in ("-p", "--param"):
                parameters.append({source: _value(target)})
            elif word == "--params-file":
                parameters.append(Path(value))
            elif word == "--log-level":
                log_levels.append((source, target) if target else ("", value))
    name, namespace = names.get("name"), names.get("namespace")
    items = tuple(remappings), tuple(parameters), tuple(log_levels)
    return RosArguments(tuple(own), name, namespace, *items, publishes_log)


def check_ros_arguments(words: Sequence[str]) -> None:
    """Check a command line as rcl does.

    Raises:
        RosArgumentsError: If a rule after ``--ros-args`` is not one, or a parameters file is not there or wrong.
        UnknownRosArgumentsError: If a word after ``--ros-args`` is unknown.
    """
    unknown, ros = [], False
    rest = iter(words)
    for word in rest:
        if word == "--ros-args" or (ros and word == "--"):
            ros = word == "--ros-args"
        elif ros and word in _WITH_VALUE:
            short = {"--remap": "-r", "--param": "-p"}.get(word, word)
            value = next(rest, None)
            if value is None:
                raise RosArgumentsError(f"Couldn't parse trailing {word} flag. No value found.")
            if problem := _problem(short, value):
                raise RosArgumentsError(
                    f"Couldn't parse {_TEXTS.get(short, short)}: '{word} {value}'. Error: {problem}"
                )
        elif ros and word not in _SWITCHES:
            unknown.append(word)
    if unknown:
        raise UnknownRosArgumentsError(str(unknown))


def _problem(option: str, value: str) -> str:
    """Return what rcl refuses of an option's value."""
    try:
        if option in _RULES and not _RULES[option].fullmatch(value):
            return "the rule is not NAME:=VALUE"
        if option == "-p":
            read_value(value.partition(":=")[2])
        if option == "--params-file":
            read_parameters(file_text(value), {})
    except RclYamlError as error:
        return str(error)
    except (OSError, UnicodeDecodeError):
        return "Error opening YAML file"
    if option == "--log-level" and not _SEVERITY.fullmatch(value.rpartition(":=")[2]):
        return "Argument does not use a valid severity level"
    return ""


def parameters_of(node: str, items: Sequence[Path | Mapping[str, Any]]) -> dict[str, Any]:
    """Return the parameters that files and single values give a node, as rclpy takes them from rcl.

    A node's names count in the order in which they first appear, whatever gives their values: the values of a name
    that comes later replace those of an earlier one.

    Args:
        node: The node's full name.
        items: Files and single values.

    Raises:
        RosArgumentsError: If a file is not there, or wrong.
    """
    given: Parameters = {}
    for item in items:
        if isinstance(item, Mapping):
            for key, value in item.items():
                of_node, colon, name = key.rpartition(":")
                given.setdefault(of_node if colon else "/**", {})[name] = (
                    list(value) if isinstance(value, tuple) else value
                )
            continue
        try:
            read_parameters(file_text(item), given)
        except (OSError, UnicodeDecodeError, RclYamlError) as error:
            raise RosArgumentsError(f"Couldn't parse params file: '{item}'. Error: {error}") from None
    found: dict[str, Any] = {}
    for pattern, values in given.items():
        if pattern == OWN_NODE or _matches(pattern, node):
            found.update(values)
    return found


def of_node(items: Sequence[Path | Mapping[str, Any]], node: str | None) -> Iterator[Path | Mapping[str, Any]]:
    """Yield files and single values without those that are for nodes of another name."""
    for item in items:
        if not isinstance(item, Mapping):
            yield item
            continue
        parts = [(*key.rpartition(":"), value) for key, value in item.items()]
        own = {name: value for other, _, name, value in parts if not other or node is None or other == node}
        if own:
            yield own


def _matches(pattern: str, node: str) -> bool:
    parts = ("/" + pattern.lstrip("/")).replace("/**", "(/\\w+)*").replace("/*", "(/\\w+)")
    return re.fullmatch(parts, node, re.ASCII) is not None


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
    """Return a parameter's value as YAML on one line that rcl reads as the same."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, bool | int | float):
        text = yaml.safe_dump(value, default_flow_style=True, width=10**9)
        return text.removesuffix("...\n").strip()
    return json.dumps(str(value), ensure_ascii=False)


def _value(text: str) -> ParameterValue | None:
    try:
        value = read_value(text)
    except RclYamlError:
        return text
    if value is None:  # an empty sequence has no type
        return None if text.strip() else text
    return tuple(value) if isinstance(value, list) else value
