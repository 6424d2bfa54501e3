"""The scenarios of ``--robots N``: rovers that drive, arms that wave."""

from collections.abc import Callable, Iterator, Mapping

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.scenario import Scenario


def add_rovers(builder: TwinBuilder, count: int, *, drive: bool) -> None:
    """Add rovers in rows, each driving a circle of its own to its left, at different speeds."""
    model = "package://rover_description/urdf/rover.urdf.xacro"
    files = [f"package://rover_description/config/rover_{name}.yaml" for name in ("controllers", "drive")]
    for name, x, y in _in_rows(count, spacing=2.5):
        builder.robot(name, model, xyz=(x, y, 0.13), controllers=files, inactive_controllers=["drive_controller"])
        builder.static_transform("world", f"{name}_odom")
        if drive:
            topic = f"/{name}/forward_velocity_controller/commands"
            for time, left, right in ((0.0, 3.0, 8.0), (6.0, 1.5, 4.0)):
                builder.command(topic, (left, right, left, right), time=time, period=9.0)


def add_arms(builder: TwinBuilder, count: int, *, drive: bool) -> None:
    """Add arms in rows that turn, bend and open their gripper, and return."""
    model = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
    files = [
        f"package://arduinobot_description/config/arduinobot_{name}.yaml" for name in ("controllers", "trajectories")
    ]
    inactive = ["joint_trajectory_controller", "gripper_controller"]
    side = -1.0
    for name, x, y in _in_rows(count, spacing=1.5):
        builder.robot(name, model, xyz=(x, y, 0.0), controllers=files, inactive_controllers=inactive)
        side = -side  # neighbors turn in opposite directions
        if drive:
            topic = f"/{name}/forward_velocity_controller/commands"
            there = (0.5 * side, 0.25, -0.35, 0.3)
            back = tuple(-velocity for velocity in there)
            for time, velocities in enumerate((there, back, (-0.5 * side, 0, 0, 0), (0.5 * side, 0, 0, 0))):
                builder.command(topic, velocities, time=2.0 * time, period=8.0)


def _in_rows(count: int, spacing: float) -> Iterator[tuple[str, float, float]]:
    """Yield names and positions (m) of robots, eight in a row."""
    for index in range(count):
        row, column = divmod(index, 8)
        yield f"robot_{index + 1}", spacing * row, spacing * column


DEMOS: Mapping[str, Callable[..., None]] = {"rover": add_rovers, "arduinobot": add_arms}


def demo_scenario(robot: str, count: int, *, drive: bool = True, time_step: float = 0.001) -> Scenario:
    """Return a scenario of the twin's own robots.

    Args:
        robot: One of `DEMOS`.
        count: The number of robots.
        drive: Whether they get commands to move.
        time_step: The physics step (s).
    """
    builder = TwinBuilder(time_step=time_step)
    DEMOS[robot](builder, count, drive=drive)
    return builder.scenario()
