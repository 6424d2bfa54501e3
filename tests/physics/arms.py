"""Arms with one controller for all of their joints: the repository's own, and two of example-robot-data."""

import re
import sysconfig
from pathlib import Path

import numpy as np
import pytest
from conftest import ARM
from scenes import ENGINES

from drake_twin import TwinBuilder

SHARE = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix" / "share"
_DATA = SHARE / "example-robot-data" / "robots"
_FILES = {
    "ur5": _DATA / "ur_description" / "urdf" / "ur5_robot.urdf",
    "xarm7": _DATA / "xarm_description" / "urdf" / "xarm7.urdf",
}
ARMS = ("arduinobot", *_FILES)

# Poses under gravity in which no joint is near its limits (rad).
_POSES = {
    "arduinobot": (0.2, 0.5, -0.4, 0.2),
    "ur5": (0.3, -0.7, 0.9, 0.4, 0.5, 0.2),
    "xarm7": (0.3, 0.7, 0.2, 0.9, 0.5, 0.2, 0.1),
}

# Controller → its type and parameters.
_CONTROLLERS = {
    "velocity": ("velocity_controllers/JointGroupVelocityController", ""),
    "position": ("position_controllers/JointGroupPositionController", ""),
    "trajectory": (
        "joint_trajectory_controller/JointTrajectoryController",
        ", command_interfaces: [position], state_interfaces: [position, velocity]",
    ),
}


class ArmScene:
    """An arm fixed to the world.

    Args:
        folder: for its files.
        name: one of `ARMS`.
        engine: one of `ENGINES`.
        controller: of ``velocity``, ``position`` and ``trajectory`` the one that drives it.
        limited: whether its joints have velocity limits; without them it is one of example-robot-data.
    """

    def __init__(self, folder: Path, name: str, engine: str, controller: str = "velocity", *, limited: bool = True):
        file, self.joints = _robot(folder, name)
        if not limited:
            file.write_text(re.sub('velocity="[^"]*"', 'velocity="0"', file.read_text()))
        kind, parameters = _CONTROLLERS[controller]
        controllers = folder / f"{controller}.yaml"
        controllers.write_text(
            "controller_manager:\n  ros__parameters:\n    update_rate: 100\n    enforce_command_limits: false\n"
            f"    driver: {{type: {kind}}}\n"
            f"driver: {{ros__parameters: {{joints: [{', '.join(self.joints)}]{parameters}}}}}\n"
        )
        builder = TwinBuilder(**ENGINES[engine]).package_path(SHARE)
        pose = dict(zip(self.joints, _POSES[name], strict=True))
        builder.robot("arm", file, controllers=controllers, active_controllers=["driver"], initial_positions=pose)
        self.twin = builder.build()
        self.limits = [self.twin.built.plans[0].description.joints_by_name[joint].limits for joint in self.joints]

    def publish(self, numbers) -> None:
        """A command to each joint."""
        self.twin.publish("/arm/driver/commands", np.asarray(numbers, dtype=float).tolist())

    def publish_one(self, joint: int, number: float) -> None:
        """A command to one joint, and zero to the rest."""
        self.publish(number * np.eye(len(self.joints))[joint])

    @property
    def positions(self) -> np.ndarray:
        """Where the driven joints are (rad)."""
        return self._of_driven(self.twin.robot_state("arm").positions)

    @property
    def velocities(self) -> np.ndarray:
        """How they move (rad/s)."""
        return self._of_driven(self.twin.robot_state("arm").velocities)

    def move_one(self, joint: int, velocity: float) -> None:
        """Lets one joint move at a velocity that is commanded (rad/s), and no other."""
        self.publish_one(joint, velocity)
        self.twin.step()
        plant, context = self.twin.plant, self._plant_context
        moving = np.zeros(plant.num_velocities())
        moving[self._velocity_index(joint)] = velocity
        plant.SetVelocities(context, moving)

    def stopping_distance(self, joint: int, velocity: float) -> float:
        """How far a joint that moves at a velocity (rad/s) goes on while its effort brakes its inertia (rad)."""
        plant, context, index = self.twin.plant, self._plant_context, self._velocity_index(joint)
        inertia = plant.CalcMassMatrix(context)[index, index]
        gravity = abs(plant.CalcGravityGeneralizedForces(context)[index])
        return velocity**2 * inertia / (2 * (self.limits[joint].effort - gravity))

    @property
    def _plant_context(self):
        return self.twin.plant.GetMyMutableContextFromRoot(self.twin.context)

    def _velocity_index(self, joint: int) -> int:
        return self.twin.plant.GetJointByName(self.joints[joint]).velocity_start()

    def _of_driven(self, values) -> np.ndarray:
        named = dict(zip(self.twin.robot_state("arm").joints, values, strict=True))
        return np.array([named[joint] for joint in self.joints])


def _robot(folder: Path, name: str) -> tuple[str | Path, list[str]]:
    """The file and its driven joints; without shapes that might touch, and dry friction that would brake."""
    if name == "arduinobot":
        return ARM, ["joint_1", "joint_2", "joint_3", "joint_4"]
    if not _FILES[name].exists():
        pytest.skip("example-robot-data is not installed: pip install '.[corpus]'")
    text = _FILES[name].read_text()
    text = re.sub(r'<transmission.*?</transmission>|<collision.*?</collision>| friction="[^"]*"', "", text, flags=re.S)
    joints = re.findall(r'<joint name="([^"]+)" type="revolute"', text)
    commands = '<command_interface name="position"/><command_interface name="velocity"/>'
    interfaces = "".join(
        f'<joint name="{joint}">{commands}<state_interface name="position"/></joint>' for joint in joints
    )
    hardware = "<hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>"
    text = text.replace(
        "</robot>", f'<ros2_control name="c" type="system">{hardware}{interfaces}</ros2_control></robot>'
    )
    file = folder / f"{name}.urdf"
    file.write_text(text)
    return file, joints
