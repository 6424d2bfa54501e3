"""What services of gz-sim's world do, where the twin itself asks for it: move, add and remove models, pause and reset.

A replay repeats what leads to such a request, so they are not recorded; but for a reset, with which time begins again.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path

from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RollPitchYaw

from drake_twin.description.breadcrumbs import Deploy, fixed_to_the_world
from drake_twin.description.gz_requests import ControlWorld, Create, GzRequest, ModelPose, Remove, SetPoses
from drake_twin.description.lasting_files import lasting_file
from drake_twin.description.robot_description import Pose
from drake_twin.description.robot_model import as_expanded
from drake_twin.description.source_file import read_xml
from drake_twin.description.touches import EnableTouch
from drake_twin.errors import InputError, TwinError
from drake_twin.scenario import Robot
from drake_twin.scenario.names import name_in_twin
from drake_twin.twin.entities import Entities
from drake_twin.twin.group import Group
from drake_twin.twin.model_frame import model_frame
from drake_twin.twin.recording import unrecorded

_NAME = re.compile(r"""<model\b[^>]*\sname\s*=\s*["']([^"']+)""")


class ModelRequests(Group):
    """Does requests between two steps, or between two advances where the diagram has to be built again."""

    def do(self, request: GzRequest, refuse: Callable[[TwinError], None]) -> None:
        """Do a request.

        Args:
            request: The request.
            refuse: Is called with what is wrong, now or at the end of the advance.
        """

        def attempt(act: Callable[[], None]) -> None:
            try:
                act()
            except TwinError as error:
                refuse(error)

        entities = Entities(self._session, self._stepper, self._recorder)
        if isinstance(request, SetPoses):
            for pose in request.poses:
                attempt(partial(self._set_pose, entities, pose))
        elif isinstance(request, EnableTouch):
            if self._session.reactions.touches is not None:
                self._session.reactions.touches.enable(request)
        elif isinstance(request, ControlWorld):
            if request.resets:
                self._session.between_advances(self._reset)
            self._stepper.paused = request.pauses
        elif isinstance(request, Create):
            self._session.between_advances(partial(attempt, partial(self._create, entities, request)))
        elif isinstance(request, Remove):
            self._session.between_advances(partial(attempt, partial(unrecorded, entities.delete, request.model)))
        elif isinstance(request, Deploy):
            self._session.between_advances(partial(attempt, partial(self._deploy, entities, request)))
        else:
            self._session.between_advances(partial(attempt, partial(self._fix, request.model)))

    def _reset(self) -> None:
        self._recorder.note("reset")
        self._session.reset()

    def _set_pose(self, entities: Entities, pose: ModelPose) -> None:
        """Move a model, whose frame need not be that of its root link; it keeps its velocity."""
        X_WM, frame = _transform(pose), model_frame(self._session.built, pose.model)
        if frame.body is None:
            raise InputError(f"Entity [{pose.model}] cannot be moved: it is static")
        X_WB = X_WM @ frame.X.inverse()
        position, orientation = X_WB.translation(), X_WB.rotation().ToQuaternion().wxyz()
        unrecorded(entities.set_state, pose.model, position, orientation)

    def _create(self, entities: Entities, request: Create) -> None:
        found = _NAME.search(request.text)
        name = request.pose.model or (found[1] if found else Path(request.file).stem)
        if not request.pose.model:
            name = name_in_twin(name)
        if request.may_be_renamed:
            name = self._free_name(name)
        file = request.file.removeprefix("file://")
        if request.text:
            text = request.text if "<sdf" in request.text else f'<sdf version="1.12">{request.text}</sdf>'
            file = str(lasting_file(f"{name}.sdf", as_expanded(text)))
        x, y, z = request.pose.position
        roll, pitch, yaw = map(float, RollPitchYaw(_transform(request.pose).rotation()).vector())
        unrecorded(entities.spawn, Robot(name, file, xyz=(x, y, z), rpy=(roll, pitch, yaw)))

    def _deploy(self, entities: Entities, request: Deploy) -> None:
        """Drop a model, and tell how many are left."""
        session, deployments = self._session, self._session.reactions.deployments
        assert deployments is not None, "one can be asked for"
        count = deployments.count(request)
        if request.most is None or count < request.most:
            name = f"{request.name}_{count}"
            if request.may_be_renamed:
                name = self._free_name(name)
            elif name in self._taken():
                raise InputError(f"Entity [{name}] already exists.")
            X_WM = model_frame(session.built, request.owner).pose(session.physics.plant_context)
            pose = Pose.of(X_WM @ request.pose.transform())
            file = str(lasting_file(f"{name}.sdf", as_expanded(request.text)))
            unrecorded(entities.spawn, Robot(name, file, xyz=pose.xyz, rpy=pose.rpy))
            deployments.note(request, name)
        deployments.tell(request)

    def _fix(self, name: str) -> None:
        """Fix a model to the world."""
        session, scenario = self._session, self._session.scenario
        robot = next((robot for robot in scenario.robots if robot.name == name), None)
        if robot is None:
            return
        pose = Pose.of(model_frame(session.built, name).pose(session.physics.plant_context))
        try:
            text = fixed_to_the_world(read_xml(Path(robot.model), "robot file"))
        except ValueError as error:
            raise InputError(f"Entity [{name}] cannot be fixed: {error}") from None
        file = str(lasting_file(f"{name}.sdf", as_expanded(text)))
        fixed = replace(robot, model=file, xyz=pose.xyz, rpy=pose.rpy)
        session.rebuild(replace(scenario, robots=tuple(fixed if item is robot else item for item in scenario.robots)))

    def _taken(self) -> set[str]:
        built = self._session.built
        models = () if built.world_file is None else built.world_file.models
        return {*self._session.robots, *(model.name for model in models)}

    def _free_name(self, name: str) -> str:
        taken = self._taken()
        return name if name not in taken else next(f"{name}_{i}" for i in count(1) if f"{name}_{i}" not in taken)


def _transform(pose: ModelPose) -> RigidTransform:
    return RigidTransform(Quaternion(pose.orientation), pose.position)
