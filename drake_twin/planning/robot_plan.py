"""The plan of a robot: what the twin starts of its files, ready to be built."""

from dataclasses import replace
from typing import TYPE_CHECKING

from drake_twin.dataclass import dataclass
from drake_twin.description.controllers_yaml import ControllerManagerParameters
from drake_twin.description.robot_description import Joint, Pose, RobotDescription
from drake_twin.description.robot_model import RobotModel
from drake_twin.errors import InputError
from drake_twin.findings import Findings
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.planning.idle_hardware import idle_joints, joints_in_state
from drake_twin.planning.joint_plan import JointPlan
from drake_twin.planning.sensor_plan import SensorPlan
from drake_twin.scenario import Robot, ScenarioError

if TYPE_CHECKING:
    from drake_twin.description.performers import Performer, PerformerDetector
    from drake_twin.description.touches import TouchDetector
    from drake_twin.description.triggers import Trigger


@dataclass(frozen=True)
class RobotPlan:
    """A robot, ready to be built.

    Attributes:
        robot: The scenario's entry.
        model: Its description and its text for Drake.
        manager: The parameters of its controller manager.
        controllers: The controllers of its parameters files and plugins, in order.
        joints: Where its joints start, and how they follow commands.
        sensors: The sensors that are simulated.
        frame_prefix: The prefix of its link names in tf messages.
        findings: The findings of its files: entries that were not used as they are.
        triggers: What publishes messages when it hears one, with topics of gz.
        performers: What it is a performer as.
        detectors: What notices performers, likewise.
        touches: What tells of touches, likewise.
    """

    robot: Robot
    model: RobotModel
    manager: ControllerManagerParameters
    controllers: tuple[ControllerPlan, ...]
    joints: JointPlan
    sensors: tuple[SensorPlan, ...]
    frame_prefix: str
    findings: Findings
    triggers: "tuple[Trigger, ...]" = ()
    performers: "tuple[Performer, ...]" = ()
    detectors: "tuple[PerformerDetector, ...]" = ()
    touches: "tuple[TouchDetector, ...]" = ()

    @property
    def hardware_states(self) -> dict[str, str]:
        """``<ros2_control>`` tag → ``inactive`` or ``unconfigured`` where it is not active."""
        states = self.manager.hardware_states
        return {item.name: states[item.name][0] for item in self.description.systems if item.name in states}

    @property
    def idle_joints(self) -> dict[str, str]:
        """Joint → why its hardware cannot be commanded."""
        return idle_joints(self.description, self.hardware_states, uses_inactive=self.manager.uses_inactive_hardware)

    @property
    def unconfigured_joints(self) -> frozenset[str]:
        """The joints and GPIOs whose interfaces are not available."""
        return frozenset(joints_in_state(self.description, self.hardware_states, "unconfigured"))

    @property
    def errors(self) -> tuple[InputError, ...]:
        """The errors of controllers that should be loaded, first the missing ones."""
        errors = [item.error for item in self.controllers if item.error is not None]
        return tuple(sorted(errors, key=lambda error: not isinstance(error, ScenarioError)))

    @property
    def name(self) -> str:
        """The robot's name in the twin."""
        return self.robot.name

    @property
    def description(self) -> RobotDescription:
        """The robot as its file describes it."""
        return self.model.description

    @property
    def spawn_pose(self) -> Pose:
        """The start pose of the root link in the world: the robot's pose is that of its model's frame, as in Gazebo."""
        return Pose(self.robot.xyz, self.robot.rpy).compose(self.description.root_pose)

    @property
    def friction_joints(self) -> tuple[Joint, ...]:
        """The joints whose dry friction is modeled; a follower's is part of its leader's."""
        if "joint_friction" in self.robot.without_repairs:
            return ()
        return tuple(joint for joint in self.description.movable_joints if joint.friction > 0 and joint.mimic is None)

    @property
    def follows_mujoco(self) -> bool:
        """Whether its actuators are those of an MJCF file: each has its gains, and its ``ctrlrange`` always holds."""
        return self.model.drake_format == "xml"

    @property
    def base_frame(self) -> str:
        """The frame of the root link."""
        return self.frame_prefix + self.description.root_link


def is_same_robot(plan: RobotPlan, other: RobotPlan | None) -> bool:
    """Return whether two plans are of one robot, which may be welded to another place, or have other parameters."""
    if other is None or plan is other:
        return plan is other
    if has_other_parameters(plan, other):
        return True
    robot, there = plan.robot, other.robot
    return plan.model.is_fixed and replace(robot, xyz=there.xyz, rpy=there.rpy) == there


def has_other_parameters(plan: RobotPlan, other: RobotPlan) -> bool:
    """Return whether two plans are of one robot at one place, whose controllers have other parameters."""
    robot, there = plan.robot, other.robot
    return robot != there and replace(robot, controller_parameters=there.controller_parameters) == there
