"""Node scripts that tests write, and twins that run them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from conftest import rovers

from drake_twin.twin.twin import Twin

COMMANDS = "/robot_1/forward_velocity_controller/commands"

HEAD = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray, String
"""

# A node's script around a class that is called My.
TAIL = """
def main(args=None):
    rclpy.init(args=args)
    node = My()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
"""


def script(folder: Path, name: str, text: str) -> Path:
    """Write a script; one with a class ``My`` and without a ``main`` gets the usual head and tail."""
    if "class My" in text and "def main" not in text:
        text = HEAD + text + TAIL
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return file


@contextmanager
def running(*scripts: Path | tuple, robots: int = 1) -> Iterator[Twin]:
    """A twin of rovers with nodes, each a script or a script and the arguments of ``TwinBuilder.node``."""
    builder = rovers(robots)
    for item in scripts:
        file, options = item if isinstance(item, tuple) else (item, {})
        builder.node(file, **options)
    with builder.build() as twin:
        yield twin


def lines(capsys) -> list[str]:
    """What the nodes have printed since the last time."""
    return capsys.readouterr().out.splitlines()
