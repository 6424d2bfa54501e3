"""The forces of a multicopter's rotors, as gz-sim's MulticopterMotorModel has them."""

from collections.abc import Sequence

import numpy as np
from pydrake.math import VectorToSkewSymmetric
from pydrake.multibody.tree import RigidBody

from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.multicopter_parameters import MulticopterParameters


class RotorForces(BodyForces):
    """Thrust, drag and moments of all rotors.

    A rotor of speed ω has the thrust ``k |ω| ω`` along its axis, and against the velocity v across its axis the drag
    ``c |ω| v`` and the moment ``r |ω| v``. The moment of its drag is its thrust times a length. All acts on the body
    that carries the rotor: a force through a joint's axis is the same there. The lag of its speed is that of a
    first-order filter.
    """

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        rotors = [
            (body, source.setup.parameters, number, body.joint(joint).parent_body())
            for source, body in sources
            for number, joint in enumerate(source.setup.parameters.joints)
        ]
        of_carriers: dict[int, list[int]] = {}
        for place, (*_, carrier) in enumerate(rotors):
            of_carriers.setdefault(int(carrier.index()), []).append(place)
        of_carriers = dict(sorted(of_carriers.items()))
        self.bodies = [rotors[places[0]][-1] for places in of_carriers.values()]
        # What a carrier has fewer rotors than another one has neither thrust nor drag, and the signals of any.
        shape = len(of_carriers), max(map(len, of_carriers.values()))
        places_of_rotors = np.zeros(shape, dtype=int)
        self._thrusts, self._drags = np.zeros((*shape, 6)), np.zeros((*shape, 36))
        for row, places in enumerate(of_carriers.values()):
            for column, place in enumerate(places):
                places_of_rotors[row, column] = place
                thrust, drag = _thrust_and_drag(*rotors[place])
                self._thrusts[row, column], self._drags[row, column] = thrust, drag.ravel()
        self._of_signals = 4 * places_of_rotors + np.arange(4)[:, None, None]

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench of the rotors on each of their carriers."""
        since, target, gap, rate = signals[self._of_signals]
        speeds = (target + gap * np.exp(rate * (motion.time - since)))[:, None, :]
        velocity = motion.V_B
        if motion.wind is not None:
            velocity = velocity.copy()
            velocity[:, 3:] -= motion.wind @ motion.R_WB
        sizes = np.abs(speeds)
        thrust, drag = sizes * speeds @ self._thrusts, (sizes @ self._drags).reshape(-1, 6, 6)
        wrenches: np.ndarray = thrust[:, 0] + (drag @ velocity[:, :, None])[:, :, 0]
        return wrenches


def _thrust_and_drag(
    body: RobotBody, parameters: MulticopterParameters, number: int, carrier: RigidBody
) -> tuple[np.ndarray, np.ndarray]:
    """Return a rotor's wrench on its carrier ÷ ω², and that of its drag ÷ ω and the carrier's velocity (6×6)."""
    rotor = body.link(parameters.links[number])
    pose = body.pose(rotor, carrier)
    axis, center = pose.rotation().matrix()[:, 2], pose @ rotor.default_com()
    turns = parameters.turning_directions[number]
    moment = np.cross(center, axis) - turns * parameters.moment_constants[number] * axis
    thrust = parameters.motor_constants[number] * np.concatenate([moment, axis])
    across = np.eye(3) - np.outer(axis, axis)
    velocity = across @ np.hstack([-VectorToSkewSymmetric(pose.translation()), np.eye(3)])  # across the axis
    moment_and_force = np.vstack([VectorToSkewSymmetric(center), np.eye(3)])
    drag = -parameters.rotor_drag_coefficients[number] * moment_and_force
    drag[:3] -= parameters.rolling_moment_coefficients[number] * np.eye(3)
    return thrust, drag @ velocity
