"""A robot of two hinges about the vertical, each with 0.5 kg·m², and the controllers that a test asks for."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from drake_twin import TwinBuilder
from drake_twin.scenario import World

INERTIA = 0.5  # kg·m², of each hinge
EFFORT_LIMIT = 50.0  # N·m

_LINK = (
    '<link name="{}"><inertial><mass value="1"/>'
    f'<inertia ixx="1" iyy="1" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
_JOINT = (
    '<joint name="{0}" type="continuous"><parent link="base"/><child link="{0}_link"/><origin xyz="{1} 0 0"/>'
    f'<axis xyz="0 0 1"/><limit effort="{EFFORT_LIMIT}" velocity="20"/></joint>'
)
_CONTROLLED = '<joint name="{}">' + "".join(
    f'<command_interface name="{name}"/><state_interface name="{name}"/>' for name in ("position", "velocity", "effort")
)
ROBOT = f"""<robot name="hinges"><link name="world"/>{"".join(map(_LINK.format, ("base", "left_link", "right_link")))}
<joint name="mount" type="fixed"><parent link="world"/><child link="base"/></joint>
{_JOINT.format("left", -1)}{_JOINT.format("right", 1)}
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
{"".join(f"{_CONTROLLED.format(name)}</joint>" for name in ("left", "right"))}</ros2_control></robot>"""

Controller = tuple[str, Mapping[str, Any]]


def velocities(*joints: str, **more: Any) -> Controller:
    """Return a velocity controller of some joints."""
    return "velocity_controllers/JointGroupVelocityController", {"joints": joints, **more}


def efforts(*joints: str, **more: Any) -> Controller:
    """Return an effort controller of some joints."""
    return "effort_controllers/JointGroupEffortController", {"joints": joints, **more}


def trajectories(*joints: str, **more: Any) -> Controller:
    """Return a trajectory controller of the positions of some joints."""
    interfaces = {"command_interfaces": ["position"], "state_interfaces": ["position", "velocity"]}
    return "joint_trajectory_controller/JointTrajectoryController", {"joints": joints, **interfaces, **more}


def write_hinges(folder: Path, controllers: Mapping[str, Controller], rate: float = 100) -> tuple[Path, Path]:
    """Write the robot's file and its controllers' file; return their paths."""
    robot, file = folder / "hinges.urdf", folder / "controllers.yaml"
    robot.write_text(ROBOT)
    types = {name: {"type": kind} for name, (kind, _) in controllers.items()}
    manager = {"controller_manager": {"ros__parameters": {"update_rate": rate, **types}}}
    file.write_text(json.dumps(manager | {name: {"ros__parameters": own} for name, (_, own) in controllers.items()}))
    return robot, file


def hinges(
    folder: Path,
    controllers: Mapping[str, Controller],
    names: tuple[str, ...] = ("r",),
    rate: float = 100,
    active: tuple[str, ...] | None = None,
    inactive: tuple[str, ...] = (),
    **options: Any,
) -> TwinBuilder:
    """Return a builder of robots in a world without ground; all their controllers are active by default."""
    robot, file = write_hinges(folder, controllers, rate)
    builder = TwinBuilder(world=World(ground=False), **options)
    for index, name in enumerate(names):
        builder.robot(
            name,
            robot,
            xyz=(0.0, 5.0 * index, 0.0),
            controllers=file,
            active_controllers=active,
            inactive_controllers=inactive,
        )
    return builder
