"""Controllers that move the surface of links along them: belts and tracks."""

from collections.abc import Mapping
from typing import Any

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.description.robot_description import RobotDescription, Vector3
from drake_twin.description.surface_velocity import NEEDS, has_surface_velocity


class SurfaceController:
    """What a controller has beside its base that moves surfaces.

    Its output port ``surface_speeds`` is a vector: the speed of the surface of each of the links that `surfaces`
    returns, in their order (m/s). The surface moves at speed · (axis × normal), with the normal out of the link.

    Attributes:
        setup: What the controller was built from; a controller has it.
    """

    setup: ControllerSetup

    @classmethod
    def surfaces(cls, parameters: Any) -> Mapping[str, Vector3]:
        """Return each link whose surface a controller with these parameters moves, and the axis in its frame."""
        raise NotImplementedError

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why surfaces cannot move; None if they can."""
        missing = next((link for link in cls.surfaces(parameters) if link not in description.links), None)
        if missing is not None:
            return f"the robot has no link {missing!r}"
        return None if has_surface_velocity() else NEEDS
