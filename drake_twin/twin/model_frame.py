"""Where the frame of a robot or of a model of the world is: Gazebo's poses of models are those of their frames."""

from collections.abc import Iterator

from pydrake.math import RigidTransform
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import InputError


@dataclass(frozen=True)
class ModelFrame:
    """A model's frame.

    Attributes:
        X: Its pose in the body's frame, or in the world without one.
        body: The body that it is fixed to: the root link; None for a model that never moves.
    """

    X: RigidTransform
    body: RigidBody | None = None

    def pose(self, plant_context: Context) -> RigidTransform:
        """Return its pose in the world."""
        if self.body is None:
            return self.X
        pose: RigidTransform = self.body.EvalPoseInWorld(plant_context) @ self.X
        return pose


def model_frame(built: TwinDiagram, name: str) -> ModelFrame:
    """Return the frame of a robot or of a model of the world.

    Raises:
        InputError: If nothing in the twin is called so.
    """
    plan = next((plan for plan in built.plans if plan.name == name), None)
    if plan is not None:
        body = built.plant.GetBodyByName(plan.model.root_body, built.robots[name].instance)
        return ModelFrame(plan.description.root_pose.transform().inverse(), body)
    models = () if built.world_file is None else built.world_file.models
    model = next((model for model in models if model.name == name), None)
    if model is None:
        valid = [*(plan.name for plan in built.plans), *(item.name for item in models)]
        raise InputError(f"Entity [{name}] does not exist.", value=name, valid=valid)
    X_WM = model.pose.transform()
    if name not in built.world_models:
        return ModelFrame(X_WM)
    bodies: Iterator[RigidBody] = (
        built.plant.get_body(index) for item in built.world_models[name] for index in built.plant.GetBodyIndices(item)
    )
    body = next(bodies)
    X_WB = body.EvalPoseInWorld(built.plant.CreateDefaultContext())
    return ModelFrame(X_WB.inverse() @ X_WM, body)
