"""The controller of ROS 2's package parallel_gripper_controller."""

from dataclasses import field
from math import nan
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.gripper import GripperGoal
from drake_twin.control.pid import PidMemory
from drake_twin.controllers.gripper_action_controller import GripperActionController, GripperActionParameters
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError


@dataclass(frozen=True, kw_only=True)
class ParallelGripperActionParameters(GripperActionParameters):
    """Parameters of ``parallel_gripper_action_controller/GripperActionController``.

    Attributes:
        state_interfaces: The joint's state interfaces.
        max_effort_interface: The full name of a command interface that takes the largest effort; empty for none.
        max_effort: The largest effort of a goal without one (N·m or N).
        max_velocity_interface: The full name of a command interface that takes the largest velocity; empty for none.
        max_velocity: The largest velocity of a goal without one (rad/s or m/s).
    """

    read_only: ClassVar[tuple[str, ...]] = ("action_monitor_rate", "joint")

    state_interfaces: tuple[str, ...] = field(
        default=("position", "velocity"), metadata={"unsupported": "position and velocity are always read"}
    )
    stall_timeout: float = field(default=1.0, metadata={"lower": 0.0})
    max_effort_interface: str = ""
    max_effort: float = field(default=10.0, metadata={"lower": 0.0})
    max_velocity_interface: str = ""
    max_velocity: float = field(default=0.1, metadata={"lower": 0.0})


@controller("parallel_gripper_action_controller/GripperActionController")
class ParallelGripperActionController(GripperActionController):
    """Implement ``parallel_gripper_action_controller/GripperActionController``: a position and the claimed limits.

    Its claims are the joint's position, then ``max_effort_interface`` and ``max_velocity_interface`` if given, which
    take the goal's limits unchanged.
    """

    Parameters: ClassVar[type] = ParallelGripperActionParameters
    action = "control_msgs/action/ParallelGripperCommand"

    @classmethod
    def claimed_interfaces(
        cls, parameters: ParallelGripperActionParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the joint's position and the interfaces of the limits."""
        names = (parameters.max_effort_interface, parameters.max_velocity_interface)
        limits = [Interface(*name.rpartition("/")[::2]) for name in names if name]
        return (Interface(parameters.joint, "position"), *limits)

    def feedback(self, context: Context) -> Any:
        """Return the present goal's feedback message."""
        return messages.ParallelGripperCommand_Feedback(state=self._joint_state(context))

    def result(self, context: Context) -> Any:
        """Return the last goal's result message; all zero for one that was canceled."""
        run = self._run(context)
        return messages.ParallelGripperCommand_Result(
            state=self._joint_state(context), stalled=run.stalled, reached_goal=run.reached_goal
        )

    def _joint_state(self, context: Context) -> Any:
        run = self._run(context)
        return messages.JointState(
            header=messages.header(self.sample(context).time),
            name=[self.setup.parameters.joint],
            position=np.array([run.position]),
            velocity=np.array([]),
            effort=np.array([run.effort]),
        )

    def _default_limits(self) -> tuple[float, float]:
        return self.setup.parameters.max_effort, self.setup.parameters.max_velocity

    def _wanted(self, message: Any) -> tuple[float, float, float]:
        command, parameters = message.command, self.setup.parameters
        if len(command.position) != 1:
            raise CommandError(f"the goal has {len(command.position)} positions, but the gripper has one joint")
        effort, velocity = parameters.max_effort, parameters.max_velocity
        if parameters.max_effort_interface and len(command.effort):
            effort = float(command.effort[0])
        if parameters.max_velocity_interface and len(command.velocity):
            velocity = float(command.velocity[0])
        return float(command.position[0]), effort, velocity

    def _commands(
        self, goal: GripperGoal, pid: PidMemory, position: float, velocity: float, dt: float
    ) -> tuple[list[float], PidMemory]:
        limits = {
            self.setup.parameters.max_effort_interface: goal.effort,
            self.setup.parameters.max_velocity_interface: goal.velocity,
        }
        return [goal.position, *(limits.get(str(claim), nan) for claim in self.claims[1:])], pid
