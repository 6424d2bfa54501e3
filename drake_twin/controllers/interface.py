"""Command and state interfaces, as ros2_control names them."""

from typing import NamedTuple


class Interface(NamedTuple):
    """A command or state interface, printed as ros2_control names it: ``joint/velocity``.

    Attributes:
        joint: A joint; for a reference of another controller ``controller/joint``.
        name: ``position``, ``velocity`` or ``effort``.
    """

    joint: str
    name: str

    def __str__(self) -> str:
        return f"{self.joint}/{self.name}"
