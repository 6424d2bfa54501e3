"""Stand-in for ``rclpy.expand_topic_name``."""

import re

from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError
from drake_twin.nodes.rclpy.name_rules import namespace_problem, node_problem, topic_problem


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Return a topic's full name.

    Args:
        topic_name: Its name, with ``~`` for the node's full name, ``{node}`` and ``{ns}``.
        node_name: The node's name.
        node_namespace: The node's namespace, in full.

    Raises:
        ValueError: If a name is invalid, or a substitution is unknown.
        RCLError: If the name is None.
    """
    if topic_name is None:
        raise RCLError("failed to do name expansion: input_topic_name argument is null")
    for what, name, problem in (
        ("topic name", topic_name, topic_problem(topic_name)),
        ("node name", node_name, node_problem(node_name)),
        ("node namespace", node_namespace, namespace_problem(node_namespace)),
    ):
        if problem is not None:
            raise ValueError(f"{what} {name!r} is invalid: {problem[0]}")
    known = {"node": node_name, "ns": node_namespace, "namespace": node_namespace}
    for word in re.findall(r"{(\w*)}", topic_name):
        if word not in known:
            raise ValueError(f"topic name {topic_name!r} is invalid: unknown substitution: {{{word}}}")
    start = node_namespace.rstrip("/") + "/"
    full = re.sub(r"{(\w*)}", lambda match: known[match[1]], re.sub(r"^~", f"{start}{node_name}", topic_name))
    return full if full.startswith("/") else start + full
