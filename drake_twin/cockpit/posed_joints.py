"""Joints that the page positions without physics, for robots that are only displayed."""

from drake_twin.errors import InputError
from drake_twin.twin.twin import Twin


class PosedJoints:
    """Sets the joint positions of a paused twin.

    Args:
        twin: The twin.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self._positions = {
            plan.name: {
                joint.name: plan.joints.start_positions[joint.name]
                for joint in plan.description.movable_joints
                if joint.mimic is None
            }
            for plan in twin.built.plans
        }

    def move(self, robot: str, joint: str, position: float) -> None:
        """Set the position of one joint (rad or m), and with it those of the joints that mimic it.

        Raises:
            InputError: If the robot or the joint is unknown, or the joint mimics another one.
        """
        if robot not in self._positions:
            raise InputError(f"unknown robot {robot!r}", value=robot, valid=self._positions)
        positions = self._positions[robot]
        if joint not in positions:
            raise InputError(f"robot {robot!r} has no movable joint {joint!r} of its own", value=joint, valid=positions)
        positions[joint] = position
        self._twin.entities.set_joint_positions(robot, positions)
