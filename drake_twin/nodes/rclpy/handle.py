"""What objects of rclpy are in the middleware, until they are destroyed."""

from collections.abc import Callable
from typing import Any

from drake_twin.nodes.rclpy._rclpy_pybind11 import InvalidHandle


class Handle:
    """Something that cannot be used any more once it is destroyed.

    Args:
        end: Takes it back from the graph.

    Attributes:
        name: Its full name on the graph; empty without one.
        logger_name: The name of the logger of its node.
    """

    def __init__(self, end: Callable[[], Any] = lambda: None, name: str = "", logger_name: str = ""):
        self.name, self.logger_name = name, logger_name
        self.is_destroyed = False
        self._end = end

    @property
    def pointer(self) -> int:
        return id(self)

    def get_logger_name(self) -> str:
        return self.logger_name

    def check(self) -> None:
        """Raise an error for what has been destroyed.

        Raises:
            InvalidHandle: If it has been.
        """
        if self.is_destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")

    def destroy_when_not_in_use(self) -> None:
        self.check()
        self.is_destroyed = True
        self._end()

    def __enter__(self) -> "Handle":
        self.check()
        return self

    def __exit__(self, *_: object) -> None:
        pass
