"""Plans of motions that MoveIt's messages ask for: a start, goals, constraints on the way, limits."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.dataclass import dataclass
from drake_twin.nodes.motion.arm_model import ArmModel
from drake_twin.nodes.motion.constraints import (
    ConstraintError,
    Error,
    Place,
    constraint_error,
    joint_goals,
    pose_error,
    to_pose,
)
from drake_twin.nodes.motion.error_codes import ErrorCode, PlanningError
from drake_twin.nodes.motion.joint_paths import plan_path
from drake_twin.nodes.motion.semantic_description import JointGroup

_TRIES = 40  # random starts of a search for positions
_GOALS = 4  # positions of a goal of which the nearest is tried first
_LINE_STEP = 0.005  # m, between two positions of Pilz's planner LIN
_LOOKS = 4000  # at positions of a path, for each attempt
_BOUNDS = 0.05  # rad or m, that a start may be outside of the limits (MoveIt's start_state_max_bounds_error)
IK_TOLERANCES = (1e-5, 1e-4)  # m, rad
_OUTSIDE = 1e-6  # rad or m


@dataclass(frozen=True)
class Planner:
    """Plans with a model of the robot in its present surroundings.

    Attributes:
        model: The robot and what is around it.
        group: The joints that move.
        place: Returns a frame's pose in the root link.
        turns: Whether the orientation of a pose counts, which the group's joints may not be able to reach.
    """

    model: ArmModel
    group: JointGroup
    place: Place
    turns: bool = True

    @property
    def indices(self) -> list[int]:
        """The places of the group's joints among the model's."""
        return self.model.indices(self.group.joints)

    def path(self, start: np.ndarray, request: Any) -> list[np.ndarray]:
        """Return positions of all joints on the way to a ``MotionPlanRequest``'s goal, each shape (n,).

        Raises:
            PlanningError: If no path is found.
        """
        model, columns = self.model, self.indices
        start = self._checked(start)
        limits = self._error(request.path_constraints)
        goals = self._goals(start, request, limits)
        if request.planner_id == "LIN":
            return self._line(start, goals)

        def whole(values: np.ndarray) -> np.ndarray:
            positions = start.copy()
            positions[columns] = values
            return positions

        def is_valid(values: np.ndarray) -> bool:
            return self._meets(limits, whole(values)) and model.touching(whole(values)) is None

        def project(values: np.ndarray) -> np.ndarray | None:
            found = model.solve(limits, whole(values), columns) if limits is not None else whole(values)
            return None if found is None else found[columns]

        found = plan_path(
            start[columns],
            [goal[columns] for goal in goals],
            is_valid,
            lambda sampler: model.random(sampler, columns, start)[columns],
            _LOOKS * max(1, request.num_planning_attempts),
            None if limits is None else project,
        )
        if found is None:
            raise PlanningError(ErrorCode.PLANNING_FAILED, "no path without contact was found")
        return [whole(values) for values in found]

    def inverse(self, start: np.ndarray, request: Any) -> np.ndarray:
        """Return positions of all joints for a ``PositionIKRequest``.

        Raises:
            PlanningError: If no positions are found.
        """
        link = request.ik_link_name or self.group.tip
        if not self.model.has_link(link):
            raise PlanningError(ErrorCode.INVALID_LINK_NAME, f"link '{link}' does not exist")
        target = self._place(request.pose_stamped.header.frame_id) @ to_pose(request.pose_stamped.pose)
        error = pose_error(link, target, IK_TOLERANCES, turns=self.turns)
        limits = self._error(request.constraints)
        touched = False
        for positions in self._solutions(start, {}, error):
            contact = self.model.touching(positions) if request.avoid_collisions else None
            if contact is None and self._meets(limits, positions):
                return positions
            touched = touched or contact is not None
        reason = ": those that are found touch something" if touched else ""
        raise PlanningError(ErrorCode.NO_IK_SOLUTION, f"no positions place '{link}' there{reason}")

    def straight(
        self,
        start: np.ndarray,
        link: str,
        poses: Sequence[RigidTransform],
        step: float,
        jump: float = 0.0,
        constraints: Any = None,
        *,
        avoid: bool = True,
    ) -> tuple[list[np.ndarray], float]:
        """Return positions on a straight way of a link over some poses, and how much of the way they are (0 to 1).

        Args:
            start: Positions of all joints.
            link: The link.
            poses: In the root link.
            step: The distance between two positions (m); a turn counts by 0.5 m/rad.
            jump: How many times farther than on average a joint may move in a step; 0 if that does not matter.
            constraints: A ``Constraints`` that hold on the way; None without any.
            avoid: Whether contact ends the way.
        """
        limits = self._error(constraints)
        stops = _between([self.model.pose(start, link), *poses], step)
        found = [start]
        for stop in stops:
            error = pose_error(link, stop, IK_TOLERANCES, turns=self.turns)
            positions = self.model.solve(error, found[-1], self.indices)
            if positions is None or not self._meets(limits, positions):
                break
            if avoid and self.model.touching(positions) is not None:
                break
            if np.abs(positions - found[-1]).max() > max(0.5, 50 * step):
                break  # another branch of the solutions
            found.append(positions)
        if jump > 0 and len(found) > 2:
            moved = [np.abs(b - a).sum() for a, b in pairwise(found)]
            far = [place for place, size in enumerate(moved) if size > jump * np.mean(moved)]
            found = found[: far[0] + 1] if far else found
        return found, (len(found) - 1) / max(1, len(stops))

    def _line(self, start: np.ndarray, goals: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return the way of Pilz's planner LIN: the tip moves in a straight line."""

        poses = [self.model.pose(goals[0], self.group.tip)]
        found, fraction = self.straight(start, self.group.tip, poses, _LINE_STEP)
        if fraction < 1.0:
            raise PlanningError(ErrorCode.PLANNING_FAILED, f"only {fraction:.0%} of the straight line can be followed")
        return found

    def _checked(self, start: np.ndarray) -> np.ndarray:
        inside: np.ndarray = np.clip(start, self.model.lower, self.model.upper)
        off = np.abs(inside - start)
        if off.max(initial=0.0) > _BOUNDS:
            name = self.model.joints[int(off.argmax())]
            code = ErrorCode.START_STATE_INVALID
            raise PlanningError(code, f"joint '{name}' of the start state is {off.max():.3g} outside of its limits")
        contact = self.model.touching(inside)
        if contact is not None:
            raise PlanningError(
                ErrorCode.START_STATE_IN_COLLISION, f"in the start state, '{contact[0]}' touches '{contact[1]}'"
            )
        return inside

    def _goals(self, start: np.ndarray, request: Any, limits: Error | None) -> list[np.ndarray]:
        if not request.goal_constraints:
            raise PlanningError(ErrorCode.INVALID_GOAL_CONSTRAINTS, "no goal is given")
        found: list[np.ndarray] = []
        contact = None
        for goal in request.goal_constraints:
            error = self._error(goal)
            if error is None:
                raise PlanningError(ErrorCode.INVALID_GOAL_CONSTRAINTS, "a goal without constraints")
            asked = joint_goals(goal.joint_constraints)
            for name, value in asked.items():
                index = self.model.joints.index(name)
                if not self.model.lower[index] - _OUTSIDE <= value <= self.model.upper[index] + _OUTSIDE:
                    text = f"joint '{name}' cannot be at {value:.3g}: its limits are {self.model.lower[index]:.3g} and "
                    code = ErrorCode.INVALID_GOAL_CONSTRAINTS
                    raise PlanningError(code, f"{text}{self.model.upper[index]:.3g}")
            for positions in self._solutions(start, asked, error):
                touch = self.model.touching(positions)
                if touch is None and self._meets(limits, positions):
                    found.append(positions)
                    if len(found) >= _GOALS:
                        break
                contact = contact or touch
        if not found and contact is not None:
            text = f"at the goal, '{contact[0]}' touches '{contact[1]}'"
            raise PlanningError(ErrorCode.GOAL_IN_COLLISION, text)
        if not found:
            raise PlanningError(ErrorCode.PLANNING_FAILED, "no positions of the joints meet the goal")
        return sorted(found, key=lambda positions: float(np.abs(positions - start).max()))

    def _solutions(self, start: np.ndarray, asked: Mapping[str, float], error: Error) -> Iterator[np.ndarray]:
        sampler = np.random.default_rng(0)
        begin = self.model.from_names(asked, start)
        free = [index for index in self.indices if self.model.joints[index] not in asked]
        for number in range(_TRIES if free else 1):
            seed = begin if number == 0 else self.model.random(sampler, free, begin)
            positions = self.model.solve(error, seed, self.indices)
            if positions is not None:
                yield positions

    def _error(self, constraints: Any) -> Error | None:
        if constraints is None:
            return None
        parts = (constraints.joint_constraints, constraints.position_constraints, constraints.orientation_constraints)
        if not any(parts) and not constraints.visibility_constraints:
            return None
        try:
            return constraint_error(constraints, self._place, self.model)
        except ConstraintError as error:
            raise PlanningError(ErrorCode.INVALID_GOAL_CONSTRAINTS, str(error)) from None

    def _place(self, frame: str) -> RigidTransform:
        try:
            return self.place(frame)
        except LookupError as error:
            raise PlanningError(ErrorCode.FRAME_TRANSFORM_FAILURE, str(error)) from None

    def _meets(self, limits: Error | None, positions: np.ndarray) -> bool:
        return limits is None or bool(np.abs(limits(self.model, positions)).max(initial=0.0) <= 1.0)


def _between(poses: Sequence[RigidTransform], step: float) -> list[RigidTransform]:
    """Return poses on straight lines with even turns, without the first."""
    found = []
    for one, other in pairwise(poses):
        turn = (one.rotation().inverse() @ other.rotation()).ToAngleAxis()
        angle, axis = turn.angle(), turn.axis()
        if angle > np.pi:
            angle -= 2 * np.pi
        gap = np.asarray(other.translation() - one.translation())
        count = max(1, int(np.ceil(max(np.linalg.norm(gap), 0.5 * abs(angle)) / step)))
        for number in range(1, count + 1):
            part = number / count
            rotation = one.rotation() @ RotationMatrix(AngleAxis(angle * part, axis))
            found.append(RigidTransform(rotation, one.translation() + gap * part))
    return found
