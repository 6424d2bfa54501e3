"""Names of nodes, topics and parameters, as rcl resolves them."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.messages.parameter_value import flat
from drake_twin.nodes.rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidServiceNameException,
    InvalidTopicNameException,
)
from drake_twin.ros2.launched import absolute_name
from drake_twin.ros2.ros_arguments import RosArguments


def check_node_name(name: str) -> str:
    """Return a node's name.

    Raises:
        InvalidNodeNameException: If ROS does not accept it.
    """
    if not name:
        raise InvalidNodeNameException(name, "node name must not be empty", 0)
    for index, letter in enumerate(name):
        if not (letter.isascii() and (letter.isalnum() or letter == "_")):
            text = "node name must not contain characters other than alphanumerics or '_'"
            raise InvalidNodeNameException(name, text, index)
    if name[0].isdigit():
        raise InvalidNodeNameException(name, "node name must not start with a number", 0)
    return name


def check_namespace(namespace: str) -> str:
    """Return a namespace in full.

    Raises:
        InvalidNamespaceException: If ROS does not accept it.
    """
    full = "/" + namespace.strip("/")
    if not re.fullmatch(r"/|(/[A-Za-z_][A-Za-z0-9_]*)+", full):
        text = "namespace must not contain characters other than alphanumerics, '_', or '/'"
        raise InvalidNamespaceException(namespace, text, 0)
    return full


def full_name(name: str, namespace: str, node: str, *, is_service: bool = False) -> str:
    """Return a topic's or a service's name in full.

    Raises:
        InvalidTopicNameException: If ROS does not accept it.
        InvalidServiceNameException: If ROS does not accept it.
    """
    error = InvalidServiceNameException if is_service else InvalidTopicNameException
    expanded = name.replace("{node}", node.rpartition("/")[2]).replace("{ns}", namespace)
    if not expanded:
        raise error(name, "topic name must not be empty", 0)
    if not re.fullmatch(r"(~(?=/|$)|/)?/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*|~", expanded):
        text = "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"
        wrong = re.search(r"[^A-Za-z0-9_/~]|(?<=/)\d|^\d|//|/$", expanded)
        raise error(name, text, 0 if wrong is None else wrong.start())
    return absolute_name(expanded, namespace, node)


def overrides(node: str, arguments: RosArguments) -> dict[str, Any]:
    """Return the parameters that a program's command line gives a node; later ones replace earlier ones.

    Raises:
        RuntimeError: If a parameters file cannot be read.
    """
    found: dict[str, Any] = {}
    for item in arguments.parameters:
        if isinstance(item, Mapping):
            found.update(item)
            continue
        try:
            data = load_yaml(Path(item).read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
            raise RuntimeError(f"Failed to parse parameters file {item}: {error}") from None
        for pattern, values in _sections(data, ""):
            if _matches(pattern, node):
                found.update(flat(values))
    return {name: list(value) if isinstance(value, tuple) else value for name, value in found.items()}


def _sections(data: Any, path: str) -> Iterator[tuple[str, Any]]:
    if not isinstance(data, Mapping):
        return
    for key, value in data.items():
        if key == "ros__parameters":
            yield path or "/**", value or {}
        else:
            yield from _sections(value, f"{path}/{str(key).strip('/')}")


def _matches(pattern: str, node: str) -> bool:
    parts = [re.escape(part).replace(r"\*\*", ".*").replace(r"\*", "[^/]+") for part in pattern.strip("/").split("/")]
    return re.fullmatch("/".join(parts).replace(".*/", "(.*/)?"), node.strip("/")) is not None
