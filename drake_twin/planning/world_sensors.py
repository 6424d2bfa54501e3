"""The plans of the sensors of a world's own models."""

import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.findings import Finding
from drake_twin.planning.sensor_plan import SensorOwner, SensorPlan, sensor_plans

if TYPE_CHECKING:
    from drake_twin.description.world_file import WorldModel


@dataclass(frozen=True)
class ModelPlan:
    """The sensors of a model of the world, named as those of a `RobotPlan` are.

    Attributes:
        name: The model's name; ``OUTER::INNER`` of a model inside another.
        description: The model.
        sensors: The sensors that are simulated.
        findings: What became of the others, and of what nobody reads.
    """

    name: str
    description: RobotDescription
    sensors: tuple[SensorPlan, ...]
    findings: tuple[Finding, ...]
    frame_prefix: str = ""


def plan_models(models: "Iterable[WorldModel]", bridged: Mapping[str, str] | None) -> tuple[ModelPlan, ...]:
    """Plan the sensors of models of a world.

    Args:
        models: The models.
        bridged: Topic in Gazebo → topic in ROS; None where no bridge runs, so that each one is published below its
            model's name. Plugins of Gazebo classic publish in ROS's root namespace.

    Raises:
        InputError: If a value in a sensor's element is invalid.
    """
    owners = [
        SensorOwner(each.name, each, _namespace(each.name), bridged=bridged, kind="model", is_static=model.is_static)
        for model in models
        for each in model.sensing
    ]
    return tuple(ModelPlan(owner.name, owner.description, *sensor_plans(owner)) for owner in owners)


def _namespace(model: str) -> str:
    """Return a model's name as ROS takes it."""
    words = (re.sub(r"[^a-zA-Z0-9_]+", "_", word) or "_" for word in model.split("::"))
    return "".join(f"/_{word}" if word[0].isdigit() else f"/{word}" for word in words)
