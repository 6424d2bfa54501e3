"""Forces that move a link from waypoint to waypoint, as gz-sim's TrajectoryFollower exerts them."""

from collections.abc import Sequence
from dataclasses import field, replace
from math import cos, pi, sin
from typing import Any, ClassVar

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import BasicVector, Context

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import TRAJECTORY_FOLLOWER
from drake_twin.description.parameters import ParameterError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly

_CORNERS = 8  # waypoints of a circle


@dataclass(frozen=True, kw_only=True)
class TrajectoryFollowerParameters:
    """Parameters of ``gz_sim/TrajectoryFollower``, named after the elements of ``gz-sim-trajectory-follower-system``.

    Attributes:
        link_name: The link that is moved.
        waypoints: x and y of each waypoint in the world, one after the other (m); or
        circle_radius: the radius of a circle about the first place of the link (m), zero for no circle; or
        line_direction: the angle of a line from there, in the link's axes (rad),
        line_length: and its length (m), zero for no line.
        loop: Whether the first waypoint comes after the last one.
        force: The force along the link's x axis, at its origin, while that points to the waypoint (N).
        torque: The torque about its z axis until then (N·m).
        range_tolerance: A waypoint is reached within this distance (m).
        bearing_tolerance: The axis points to it within this angle to each side (deg).
    """

    link_name: str
    waypoints: tuple[float, ...] = ()
    circle_radius: float = 0.0
    line_direction: float = 0.0
    line_length: float = 0.0
    loop: bool = False
    force: float = 60.0
    torque: float = 50.0
    range_tolerance: float = field(default=0.5, metadata={"lower": 0.0})
    bearing_tolerance: float = field(default=2.0, metadata={"lower": 0.0})

    def __post_init__(self) -> None:
        if len(self.waypoints) % 2:
            raise ParameterError("waypoints has an odd number of coordinates", "waypoints")
        if not (self.waypoints or self.circle_radius or self.line_length):
            raise ParameterError("there are no waypoints, no circle and no line", "waypoints")

    def points(self, X_WB: RigidTransform) -> tuple[tuple[float, float], ...]:
        """Return the waypoints in the world (m) of a link that starts at a pose."""
        if self.waypoints:
            return tuple(zip(self.waypoints[::2], self.waypoints[1::2], strict=True))
        x, y, _ = X_WB.translation().tolist()
        if self.circle_radius:
            angles = [2 * pi * corner / _CORNERS for corner in range(_CORNERS)]
            return tuple((x + self.circle_radius * cos(angle), y + self.circle_radius * sin(angle)) for angle in angles)
        along = self.line_length * np.array([cos(self.line_direction), sin(self.line_direction), 0.0])
        dx, dy, _ = (X_WB.rotation().matrix() @ along).tolist()
        return (x, y), (x + dx, y + dy)


@saved("TrajectoryPause")
@dataclass(frozen=True)
class TrajectoryPause(Frozen):
    """A message that pauses the follower, or lets it go on."""

    is_paused: bool


@saved("Waypoints")
@dataclass(frozen=True)
class Waypoints(Frozen):
    """The waypoints that are ahead, in their order: x and y in the world (m)."""

    ahead: tuple[tuple[float, float], ...] = ()


class TrajectoryForces(BodyForces):
    """The forces and torques of all followers, towards their waypoints."""

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        found = [source.setup.parameters for source, _ in sources]
        self.bodies: list[RigidBody] = [
            body.link(parameters.link_name) for parameters, (_, body) in zip(found, sources, strict=True)
        ]
        self._force = np.array([parameters.force for parameters in found])
        self._torque = np.array([parameters.torque for parameters in found])
        self._range = np.array([parameters.range_tolerance for parameters in found])
        self._bearing = np.radians([parameters.bearing_tolerance for parameters in found])

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the force on each link that points to its waypoint, and the torque on each other one."""
        goals = signals.reshape(-1, 3)
        ways = np.zeros((len(goals), 3))
        ways[:, :2] = goals[:, 1:] - motion.origins[:, :2]
        x, y, z = (ways[:, None, :] @ motion.R_WB)[:, 0].T  # in the link's axes, whose inverse rotates a row
        is_meant = (goals[:, 0] > 0.0) & (np.sqrt(x * x + y * y + z * z) > self._range)
        bearings = np.arctan2(y, x)
        is_ahead = np.abs(bearings) <= self._bearing
        wrenches = np.zeros((len(goals), 6))
        wrenches[:, 2] = np.where(is_meant & ~is_ahead, np.sign(bearings) * self._torque, 0.0)
        wrenches[:, 3] = np.where(is_meant & is_ahead, self._force, 0.0)
        return wrenches


@controller(TRAJECTORY_FOLLOWER)
class TrajectoryFollower(ForceController, PeriodicController):
    """Turn a link towards a waypoint by a torque, and push it there by a force; then to the next one.

    Behaves as gz-sim's TrajectoryFollower (from its sources), with forces that follow the motion in each physics step.
    Whether a waypoint is reached is looked at in an update; until then nothing pushes the link there.

    .. pydrake_system::

        name: TrajectoryFollower
        input_ports:
        - state
        - pause
        output_ports:
        - signals

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``pause``: ``std_msgs/msg/Bool``, whether it pauses, as `TrajectoryPause`.
    - ``signals``: whether it moves the link (1 or 0), and x and y of the waypoint (m).
    """

    Parameters: ClassVar[type] = TrajectoryFollowerParameters
    Forces: ClassVar[type[BodyForces]] = TrajectoryForces

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._pause = self.declare_topic_input("pause", "std_msgs/msg/Bool")
        tickets = {self.sample_ticket(), self.input_port_ticket(self._pause.get_index())}
        self.DeclareVectorOutputPort("signals", 3, weakly(self._calc_signals), tickets)
        self._plant_context: Context | None = None

    def attach(self, body: RobotBody) -> None:
        """Note the robot in the plant."""
        super().attach(body)
        self._plant_context = body.plant.CreateDefaultContext()

    def read(self, topic: str, message: Any, context: Context) -> TrajectoryPause:
        """Return a message as a pause."""
        return TrajectoryPause(bool(message.data))

    def start(self, context: Context) -> Waypoints:
        """Return the waypoints, which may follow from where the link is now."""
        return Waypoints(self.setup.parameters.points(self._pose(context)))

    def update(self, context: Context, time: float, memory: Waypoints) -> Update:
        """Go on to the next waypoint where one is reached; the last one stays without a loop."""
        if not self._is_paused(context) and len(memory.ahead) > 1:
            way = self._pose(context).translation()[:2] - memory.ahead[0]
            if np.hypot(*way) <= self.setup.parameters.range_tolerance:
                passed, *ahead = memory.ahead
                memory = replace(memory, ahead=(*ahead, *([passed] if self.setup.parameters.loop else [])))
        return Update(memory, ())

    def _pose(self, context: Context) -> RigidTransform:
        """Return the link's pose in the world."""
        assert self.body is not None
        plant, state = self.body.plant, self.get_state_input_port().Eval(context)
        plant.SetPositionsAndVelocities(self._plant_context, self.body.instance, state)
        pose: RigidTransform = self.body.link(self.setup.parameters.link_name).EvalPoseInWorld(self._plant_context)
        return pose

    def _is_paused(self, context: Context) -> bool:
        pause = self.received(self._pause, context)
        return pause is not None and pause.is_paused

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        sample = self.sample(context)
        is_meant = sample.active and sample.memory is not None and not self._is_paused(context)
        output.SetFromVector([1.0, *sample.memory.ahead[0]] if is_meant else [0.0, 0.0, 0.0])
