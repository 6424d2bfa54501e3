"""The topics in ROS of the regions that notice performers."""

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import PERFORMER_DETECTOR, PERFORMERS, of_model
from drake_twin.findings import Finding, Kind
from drake_twin.planning.robot_plan import RobotPlan

if TYPE_CHECKING:
    from drake_twin.description.performers import Performer, PerformerDetector
    from drake_twin.description.world_file import WorldFile


@dataclass(frozen=True)
class OwnedDetector:
    """A region of a model.

    Attributes:
        model: The robot or the model of the world.
        number: Its number among those of its model, from 0.
        detector: The region.
        topic: Its topic in ROS.
    """

    model: str
    number: int
    detector: "PerformerDetector"
    topic: str


@dataclass(frozen=True)
class Detection:
    """What notices performers, and which there are; empty unless there are both.

    Attributes:
        performers: The performers whose models exist, in the order of the file.
        detectors: The regions.
        findings: The performers whose models do not exist.
    """

    performers: "tuple[Performer, ...]" = ()
    detectors: tuple[OwnedDetector, ...] = ()
    findings: tuple[Finding, ...] = ()


def plan_detection(plans: Iterable[RobotPlan], world_file: "WorldFile | None", bridged: Mapping[str, str]) -> Detection:
    """Return what notices performers.

    Args:
        plans: The robots.
        world_file: The content of the world file.
        bridged: Topic in gz → topic in ROS; others have the same name in both.
    """
    plans = tuple(plans)
    plugins = () if world_file is None else world_file.plugins
    performers: list[Performer] = [
        item for plugin in plugins if plugin.type == PERFORMERS for item in plugin.parameters
    ]
    regions = [(plan.name, item) for plan in plans for item in plan.detectors]
    regions += [(plugin.model, plugin.parameters) for plugin in plugins if plugin.type == PERFORMER_DETECTOR]
    models = {plan.name for plan in plans}
    models |= set() if world_file is None else {model.name for model in world_file.models}
    bridged = {**bridged, **{gz: ros for plan in plans for gz, ros in plan.robot.remappings.items()}}
    numbers: dict[str, int] = {}
    detectors = []
    for model, detector in regions:
        number = numbers[model] = numbers.get(model, -1) + 1
        topic = of_model(detector.topic, model)
        detectors.append(OwnedDetector(model, number, detector, bridged.get(topic, topic)))
    return Detection(
        performers=tuple(item for item in performers if item.model in models),
        detectors=tuple(detectors),
        findings=tuple(_about(performers, models, len(detectors))),
    )


def _about(performers: "Iterable[Performer]", models: set[str], number: int) -> Iterator[Finding]:
    if not number:
        return
    for item in performers:
        if item.model not in models:
            what = f"performer {item.name}: there is no model {item.model!r} for detectors to notice"
            yield Finding.at(Kind.NOT_STARTED, what, item.place)
