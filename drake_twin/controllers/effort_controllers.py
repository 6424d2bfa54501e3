"""The controllers of ROS 2's package effort_controllers."""

from collections.abc import Mapping
from dataclasses import field
from math import isfinite
from typing import ClassVar

from pydrake.systems.framework import Context

from drake_twin.control.gripper import GripperGoal
from drake_twin.control.pid import Pid, PidGains, PidMemory
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.gripper_action_controller import GripperActionController, GripperActionParameters
from drake_twin.controllers.joint_group_controller import JointGroupController
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass


@controller("effort_controllers/JointGroupEffortController")
class JointGroupEffortController(JointGroupController):
    """Implement ``effort_controllers/JointGroupEffortController``."""

    interface = "effort"


@dataclass(frozen=True)
class GripperGains:
    """The gains from a gripper's position error to its effort.

    Attributes:
        p: Proportional gain (N·m/rad or N/m).
        i: Integral gain (per second).
        d: Derivative gain (times second).
        i_clamp: The largest integral term in both directions (N·m or N); with 0 it stays zero.
    """

    p: float = 0.0
    i: float = 0.0
    d: float = 0.0
    i_clamp: float = field(default=0.0, metadata={"lower": 0.0})


@dataclass(frozen=True)
class EffortGripperActionParameters(GripperActionParameters):
    """Parameters of ``effort_controllers/GripperActionController``.

    Attributes:
        max_effort: The largest effort before the first goal, which has its own (N·m or N); with 0 the gripper is limp
            until then.
        gains: The gains of the joint.
    """

    gains: Mapping[str, GripperGains] = field(default_factory=dict)


@controller("effort_controllers/GripperActionController")
class EffortGripperActionController(GripperActionController):
    """Implement ``effort_controllers/GripperActionController``: a PID on the position error writes the joint's effort.

    The effort stays within the goal's ``max_effort`` in both directions.
    """

    Parameters: ClassVar[type] = EffortGripperActionParameters
    interface = "effort"

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        gains = setup.parameters.gains.get(setup.parameters.joint, GripperGains())
        self._pid = Pid(
            PidGains(p=gains.p, i=gains.i, d=gains.d, i_clamp_max=gains.i_clamp, i_clamp_min=-gains.i_clamp)
        )

    def _effort(self, context: Context, goal: GripperGoal) -> float:
        (command,) = self.sample(context).commands  # upstream also reports the effort of the previous update
        return command if isfinite(command) else 0.0

    def _commands(
        self, goal: GripperGoal, pid: PidMemory, position: float, velocity: float, dt: float
    ) -> tuple[list[float], PidMemory]:
        command, pid = self._pid.compute(goal.position - position, -velocity, dt, pid)
        return [min(max(command, -abs(goal.effort)), abs(goal.effort))], pid
