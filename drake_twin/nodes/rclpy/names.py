"""Names of nodes, topics and services, as rcl resolves them."""

from typing import Any

from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError
from drake_twin.nodes.rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidServiceNameException,
    InvalidTopicNameException,
)
from drake_twin.nodes.rclpy.expand_topic_name import expand_topic_name
from drake_twin.nodes.rclpy.name_rules import full_topic_problem, namespace_problem, node_problem, topic_problem


def check_node_name(name: Any) -> str:
    """Return a node's name.

    Raises:
        InvalidNodeNameException: If ROS does not accept it.
        RCLError: If it is None.
        TypeError: If it is something else than text.
    """
    if name is None:
        raise RCLError("error creating node: name argument is null")
    if not isinstance(name, str):
        raise TypeError(f"__init__(): incompatible constructor arguments: a node's name is {name!r}")
    if problem := node_problem(name):
        raise InvalidNodeNameException(name, *problem)
    return name


def check_namespace(namespace: Any) -> str:
    """Return a namespace in full.

    Raises:
        InvalidNamespaceException: If ROS does not accept it.
        TypeError: If it is something else than text.
    """
    if not isinstance(namespace, str):
        raise TypeError(f"__init__(): incompatible constructor arguments: a namespace is {namespace!r}")
    full = namespace if namespace.startswith("/") else f"/{namespace}"
    if problem := namespace_problem(full):
        raise InvalidNamespaceException(full, *problem)
    return full


def expanded_name(name: Any, namespace: str, node: str) -> str:
    """Return a topic's or a service's name in full.

    Raises:
        RCLError: If ROS does not accept it.
    """
    if name is None:
        raise RCLError("failed to resolve name: input_topic_name argument is null")
    if not isinstance(name, str):
        raise TypeError(f"rclpy_resolve_name(): incompatible function arguments: {name!r}")
    if problem := topic_problem(name):
        raise RCLError(f"failed to resolve name: {problem[0]}")
    try:
        full = expand_topic_name(name, node, namespace)
    except ValueError as error:
        raise RCLError(f"failed to resolve name: {error}") from None
    if problem := full_topic_problem(full):
        raise RCLError(f"failed to resolve name: {problem[0]}")
    return full


def check_name(name: Any, namespace: str, node: str, *, is_service: bool = False) -> None:
    """Raise the error that says where a topic's or a service's name is wrong.

    Raises:
        InvalidTopicNameException: If ROS does not accept it.
        InvalidServiceNameException: If ROS does not accept it.
        ValueError: If a substitution is unknown.
    """
    if not isinstance(name, str):
        raise RCLError("failed to validate name: topic_name argument is null")
    error = InvalidServiceNameException if is_service else InvalidTopicNameException
    if problem := topic_problem(name):
        raise error(name, *problem)
    full = expand_topic_name(name, node, namespace)
    if problem := full_topic_problem(full):
        raise error(full, *problem)
