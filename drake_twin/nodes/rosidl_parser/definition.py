"""Stand-in for ``rosidl_parser.definition``: the name of an interface as an object."""

from collections.abc import Sequence


class NamespacedType:
    """A type by its name.

    Args:
        namespaces: Its package and kind, such as ``["std_msgs", "msg"]``.
        name: Its own name, such as ``String``.
    """

    __slots__ = ("name", "namespaces")
    __hash__ = None  # type: ignore[assignment]  # as in ROS

    def __init__(self, namespaces: Sequence[str], name: str):
        self.namespaces, self.name = namespaces, name

    def namespaced_name(self) -> tuple[str, ...]:
        """Return its namespaces and its name."""
        return (*self.namespaces, self.name)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, NamespacedType) and (self.namespaces, self.name) == (other.namespaces, other.name)
