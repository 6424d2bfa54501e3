"""The lift, the drag and the moment of a wing, as gz-sim's LiftDrag computes them."""

from collections.abc import Sequence
from dataclasses import field
from math import pi
from typing import ClassVar

import numpy as np

from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.registry import controller
from drake_twin.controllers.wing import Flow, Wing, check_vectors
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import LIFT_DRAG
from drake_twin.description.parameters import ParameterError

_STILL = 0.01**2  # (m/s)²: slower air does nothing, as in gz-sim
_TINY = 1e-300
_NOT_NEGATIVE = {"lower": 0.0}


@dataclass(frozen=True, kw_only=True)
class LiftDragParameters:
    """Parameters of ``gz_sim/LiftDrag``, named after the elements of ``gz-sim-lift-drag-system``.

    Attributes:
        link_name: The link on which the air acts.
        a0: The angle of attack of a flow along ``forward`` (rad).
        cla: The slope of the lift's coefficient before stall (1/rad).
        cda: That of the drag.
        cma: That of the moment, which is not multiplied by a chord (m/rad).
        alpha_stall: The angle of attack at which it stalls (rad).
        cla_stall: The slope of the lift's coefficient from there (1/rad).
        cda_stall: That of the drag.
        cma_stall: That of the moment (m/rad).
        cm_delta: The moment's coefficient for the control joint's position (m/rad).
        cp: The point where lift and drag act, in the link's frame (m).
        area: The area (m²).
        air_density: The density of the air (kg/m³).
        radial_symmetry: Whether the shape is symmetric about ``forward``: ``upward`` is then where the air comes from.
        reversible: Whether it works in a flow against ``forward``, too.
        forward: The direction of a flight without drag, in the link's frame.
        upward: The direction of lift, in the link's frame.
        control_joint_name: The joint of its control surface; empty without one.
        control_joint_rad_to_cl: The lift's coefficient for that joint's position (1/rad).
    """

    link_name: str
    a0: float = 0.0
    cla: float = 1.0
    cda: float = 0.01
    cma: float = 0.0
    alpha_stall: float = field(default=pi / 2, metadata=_NOT_NEGATIVE)
    cla_stall: float = 0.0
    cda_stall: float = 1.0
    cma_stall: float = 0.0
    cm_delta: float = 0.0
    cp: tuple[float, ...] = (0.0, 0.0, 0.0)
    area: float = field(default=1.0, metadata=_NOT_NEGATIVE)
    air_density: float = field(default=1.2041, metadata=_NOT_NEGATIVE)
    radial_symmetry: bool = False
    reversible: bool = False
    forward: tuple[float, ...] = (1.0, 0.0, 0.0)
    upward: tuple[float, ...] = (0.0, 0.0, 1.0)
    control_joint_name: str = ""
    control_joint_rad_to_cl: float = 4.0

    def __post_init__(self) -> None:
        check_vectors(self, "cp", "forward", "upward")
        if not any(self.forward):
            raise ParameterError("forward is zero", "forward")
        if not self.radial_symmetry and not np.cross(self.forward, self.upward).any():
            raise ParameterError("upward is along forward", "upward")

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints of its control surfaces."""
        return (self.control_joint_name,) if self.control_joint_name else ()


class WingForces(BodyForces):
    """Lift, drag and moment of all wings.

    Each is computed along three axes of the link: forward, to the left, and upward across forward.
    """

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        wings: list[tuple[LiftDragParameters, RobotBody]] = [(item.setup.parameters, body) for item, body in sources]
        self.bodies = [body.link(wing.link_name) for wing, body in wings]

        def column(*names: str) -> np.ndarray:
            return np.array([[getattr(wing, name) for wing, _ in wings] for name in names])

        axes = np.array([_axes(wing) for wing, _ in wings])
        self._flow = Flow(axes, column("cp")[0])
        self._along, self._across = np.array(
            [
                (0.0, 1.0) if wing.radial_symmetry else axis[[0, 2]] @ _unit(wing.upward)
                for axis, (wing, _) in zip(axes, wings, strict=True)
            ]
        ).T
        self._slopes, self._stalled = column("cla", "cda", "cma"), column("cla_stall", "cda_stall", "cma_stall")
        self._a0, self._stall = column("a0", "alpha_stall")
        self._factor = 0.5 * np.prod(column("air_density", "area"), axis=0)
        self._reversible, radial = column("reversible", "radial_symmetry")
        self._radial = radial if radial.any() else None
        joints = [wing.control_joint_name and body.joint(wing.control_joint_name) for wing, body in wings]
        self._joints = np.array([joint.position_start() if joint else 0 for joint in joints])
        self._by_joint = column("control_joint_rad_to_cl", "cm_delta") * [bool(joint) for joint in joints]

    @np.errstate(over="ignore", invalid="ignore")  # of what flies apart, which the twin reports
    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench of each wing on its link."""
        forward, left, up = self._flow.velocities(motion)
        up_left: np.ndarray | float = 0.0  # what is upward in the flow
        up_up: np.ndarray | float = 1.0
        if self._radial is not None:
            up_left, up_up = self._against(left, up)
            left, up = left * up_up - up * up_left, left * up_left + up * up_up
        in_plane = forward * forward + up * up
        total = in_plane + left * left
        speed = np.sqrt(np.maximum(in_plane, _TINY))
        sweep = in_plane / np.maximum(total, _TINY)
        lift, drag, moment = self._coefficients(motion, forward / speed, up / speed, sweep)
        acts = (total > _STILL) & ((forward > 0.0) | self._reversible)
        pressure = self._factor * in_plane * signals * acts
        lift, drag, moment = pressure * lift / speed, pressure * drag / speed, pressure * moment
        upwards = lift * forward - drag * up
        components = np.zeros((6, len(forward)))
        components[0] = -lift * up - drag * forward
        components[1], components[2] = upwards * up_left, upwards * up_up
        # About forward × upward, which is to the right.
        components[4], components[5] = -moment * up_up, moment * up_left
        return self._flow.wrenches(components)

    def _against(self, left: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the direction against what of the velocity is across forward; of wings that are not round, upward."""
        across = np.hypot(left, up)
        known = self._radial & (across > 0.0)
        size = np.where(known, across, 1.0)
        return np.where(known, -left / size, 0.0), np.where(known, -up / size, 1.0)

    def _coefficients(
        self, motion: Motion, forward: np.ndarray, up: np.ndarray, cos2_sweep: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the coefficients of lift, drag and moment.

        Args:
            motion: The motion, for the joints' positions.
            forward: The cosine of the angle between the flow in the plane of lift and drag and the forward direction.
            up: That between it and the upward direction.
            cos2_sweep: The square of the cosine of the angle between the flow and that plane.
        """
        of_lift = np.clip(forward * self._across - up * self._along, -1.0, 1.0)
        angle = np.arccos(of_lift)
        alpha = self._a0 + np.where(up <= 0.0, angle, -angle)
        size = np.abs(alpha)
        alpha -= np.copysign(pi * np.maximum(np.ceil((size - pi / 2) / pi), 0.0), alpha)
        before = np.clip(alpha, -self._stall, self._stall)
        beyond = alpha - before
        lift, drag, moment = (self._slopes * before + self._stalled * beyond) * cos2_sweep
        # Behind stall, lift and moment do not change their sides.
        lift, moment = np.where(lift * beyond < 0.0, 0.0, lift), np.where(moment * beyond < 0.0, 0.0, moment)
        by_lift, by_moment = self._by_joint * motion.state[self._joints]
        return lift + by_lift, np.abs(drag), moment + by_moment


def _axes(wing: LiftDragParameters) -> np.ndarray:
    """Return a wing's axes in its link's frame, row by row: forward, left, and upward where it is across forward."""
    forward, upward = _unit(wing.forward), np.array(wing.upward)
    left = np.cross(upward, forward)
    if wing.radial_symmetry and not left.any():
        left = np.cross(np.eye(3)[np.argmin(np.abs(forward))], forward)
    left = _unit(left)
    return np.array([forward, left, np.cross(forward, left)])


def _unit(vector: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return a vector of length 1 along another."""
    unit: np.ndarray = np.asarray(vector, dtype=float) / np.linalg.norm(vector)
    return unit


@controller(LIFT_DRAG)
class LiftDrag(Wing):
    """Let the air act on a link as on a wing.

    Behaves as gz-sim's LiftDrag (from its source), in the world's wind: the air acts in the plane of ``forward`` and
    ``upward``, by the angle of attack of the flow in it, and not where the flow is slower than 0.01 m/s or from behind.
    What is round and flies along its axis has the drag of its ``a0``; in gz-sim this flow alone counts as one across.

    .. pydrake_system::

        name: LiftDrag
        output_ports:
        - signals

    - ``signals``: 1 while it is active, else 0.
    """

    Parameters: ClassVar[type] = LiftDragParameters
    Forces: ClassVar[type[BodyForces]] = WingForces
