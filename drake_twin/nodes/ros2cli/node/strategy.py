"""``NodeStrategy``: a node for a ``with`` block."""

from typing import Any

from drake_twin.nodes import rclpy

_NAME = "_ros2cli"  # hidden, by its underscore


class NodeStrategy:
    """A node that is there within a ``with`` block; there is no daemon to ask instead.

    Args:
        args: The options of the command line, of which none matters here.
        node_name: The node's name.
    """

    def __init__(self, args: Any = None, *, node_name: str | None = None):
        del args
        if not rclpy.ok():
            rclpy.init()
        self.node = rclpy.create_node(node_name or _NAME, start_parameter_services=False, enable_rosout=False)

    def __enter__(self) -> "NodeStrategy":
        return self

    def __exit__(self, *error: object) -> None:
        self.node.destroy_node()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.node, name)
