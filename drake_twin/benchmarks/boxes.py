"""Boxes near robots and boxes alone, and the world file from which the twin reads them."""

from collections.abc import Sequence

from pydrake.math import RollPitchYaw

from drake_twin.dataclass import dataclass

FRICTION = 0.9  # of tires on the ground: the smaller of both, as in Gazebo


@dataclass(frozen=True)
class Box:
    """A box.

    Attributes:
        size: The lengths of its edges (m).
        xyz: Its center (m), relative to its robot's initial position on the ground, or in the world frame.
        rpy: Its roll, pitch and yaw (rad).
        mass: Its mass (kg); None for a fixed box.
    """

    size: tuple[float, float, float]
    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mass: float | None = None

    @property
    def quaternion(self) -> list[float]:
        """Its orientation: w, x, y, z."""
        return [float(value) for value in RollPitchYaw(self.rpy).ToQuaternion().wxyz()]

    @property
    def inertia(self) -> tuple[float, float, float]:
        """Its moments of inertia about its edges' directions (kg·m²), if it has a mass."""
        x, y, z = (edge * edge * (self.mass or 0.0) / 12 for edge in self.size)
        return y + z, x + z, x + y


def world_text(boxes: Sequence[Box], friction: float) -> str:
    """Return the SDF world with the ground and the boxes.

    Args:
        boxes: The boxes, in the world frame; their models are named ``box_0``, ``box_1``, ….
        friction: The coefficient of friction of the ground and the boxes.
    """
    surface = f"<surface><friction><ode><mu>{friction}</mu><mu2>{friction}</mu2></ode></friction></surface>"
    models = []
    for index, box in enumerate(boxes):
        inertial = ""
        if box.mass is not None:
            moments = "".join(f"<i{2 * axis}>{i}</i{2 * axis}>" for axis, i in zip("xyz", box.inertia, strict=True))
            inertial = (
                f"<inertial><mass>{box.mass}</mass><inertia>{moments}"
                "<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
            )
        geometry = f"<geometry><box><size>{' '.join(map(str, box.size))}</size></box></geometry>"
        models.append(
            f'<model name="box_{index}"><static>{str(box.mass is None).lower()}</static>'
            f"<pose>{' '.join(map(str, (*box.xyz, *box.rpy)))}</pose>"
            f'<link name="link">{inertial}<collision name="c">{geometry}{surface}</collision>'
            f'<visual name="v">{geometry}</visual></link></model>'
        )
    ground = (
        '<model name="ground"><static>true</static><link name="link"><collision name="c"><geometry><plane>'
        f"<normal>0 0 1</normal><size>100 100</size></plane></geometry>{surface}</collision></link></model>"
    )
    return f'<sdf version="1.9"><world name="benchmark">{ground}{"".join(models)}</world></sdf>\n'
