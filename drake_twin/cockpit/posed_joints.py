"""Joints that go where the page puts them, without physics: for robots that are only displayed."""

from drake_twin.errors import InputError
from drake_twin.twin.twin import Twin


class PosedJoints:
    """Sets joints of a twin whose time stands still.

    Args:
        twin: the twin.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self._positions = {
            plan.name: {
                joint.name: plan.start_positions[joint.name]
                for joint in plan.description.movable_joints
                if joint.mimic is None
            }
            for plan in twin.plans
        }

    def move(self, robot: str, joint: str, position: float) -> None:
        """Puts one joint somewhere (rad or m), and the joints that follow it with it.

        Raises:
            InputError: no such robot, or no such joint that follows nothing.
        """
        if robot not in self._positions:
            raise InputError(f"there is no robot {robot!r}", value=robot, valid=self._positions)
        positions = self._positions[robot]
        if joint not in positions:
            raise InputError(f"robot {robot!r} has no joint {joint!r} to be moved", value=joint, valid=positions)
        positions[joint] = position
        plan = next(plan for plan in self._twin.plans if plan.name == robot)
        self._twin.set_joint_positions(robot, plan.description.with_followers(positions))
