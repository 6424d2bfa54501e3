"""What forces of the air on links have in common: the flow at a point of a link, and the port of their controller."""

from typing import Any

import numpy as np
from pydrake.systems.framework import BasicVector, Context

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.body_forces import ForceController, Motion
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.systems.weak_callback import weakly


class Wing(ForceController, StatefulController):
    """The base of controllers that let the air act on one link while they are active.

    - ``signals``: 1 while it is active, else 0.
    """

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup, initial=Sample())
        self.DeclareVectorOutputPort("signals", 1, weakly(self._calc_signals), {self.sample_ticket()})

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return which link or joint the robot does not have; None if it has all."""
        movable = {joint.name for joint in description.movable_joints}
        missing = next((joint for joint in parameters.joints if joint not in movable), None)
        no_joint = None if missing is None else f"the robot has no movable joint {missing!r}"
        return super().problem(parameters, description) or no_joint

    def activate(self, context: Context) -> None:
        """Let the air act."""
        self.set_sample(context, Sample(active=True, time=context.get_time()))

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector([float(self.sample(context).active)])


class Flow:
    """The velocities of points of links relative to the air, and wrenches of forces at these points.

    Args:
        axes: Three unit vectors in each link's frame, shape (n, 3, 3): row by row.
        points: A point of each link in its frame (n×3, m).
    """

    def __init__(self, axes: np.ndarray, points: np.ndarray):
        moments = np.cross(points[:, None, :], axes)  # of a unit force along each axis; a · (ω × p) = ω · (p × a)
        self._axes = axes
        self._velocities = np.concatenate([moments, axes], axis=2)
        of_moments = np.concatenate([axes, np.zeros_like(axes)], axis=2)
        self._wrenches = np.concatenate([self._velocities, of_moments], axis=1).transpose(0, 2, 1).copy()

    def velocities(self, motion: Motion) -> np.ndarray:
        """Return the velocity of each point relative to the air, along its axes (3×n, m/s)."""
        velocities: np.ndarray = self._velocities @ motion.V_B[:, :, None]
        if motion.wind is not None:
            velocities -= self._axes @ (motion.R_WB.transpose(0, 2, 1) @ motion.wind[:, None])
        return velocities[:, :, 0].T

    def wrenches(self, components: np.ndarray) -> np.ndarray:
        """Return the wrench of each force and moment about its link's origin, in the link's axes (n×6): N·m, then N.

        Args:
            components: Each force at its point (N), then the moment (N·m), along its axes (6×n).
        """
        wrenches: np.ndarray = (self._wrenches @ components.T[:, :, None])[:, :, 0]
        return wrenches


def check_vectors(parameters: Any, *names: str) -> None:
    """Check that some of the parameters have three numbers each.

    Raises:
        ParameterError: If one has not.
    """
    for name in names:
        if len(getattr(parameters, name)) != 3:
            raise ParameterError(f"{name} has {len(getattr(parameters, name))} numbers, where three are needed", name)
