"""What notices performers and touches, with the topics in ROS."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import PERFORMER_DETECTOR, PERFORMERS
from drake_twin.findings import Finding, Kind
from drake_twin.planning.owned_detectors import OwnedDetector, owned_detectors
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.topics import with_bridges_of
from drake_twin.planning.world_sensors import ModelPlan

if TYPE_CHECKING:
    from drake_twin.description.performers import Performer, PerformerDetector
    from drake_twin.description.touches import TouchDetector
    from drake_twin.description.world_file import WorldFile


@dataclass(frozen=True)
class Detection:
    """What notices performers and touches.

    Attributes:
        performers: The performers whose models exist, in the order of the file.
        detectors: The regions that notice them.
        touches: What notices touches.
        findings: The performers whose models do not exist, and why touches are not noticed.
    """

    performers: "tuple[Performer, ...]" = ()
    detectors: "tuple[OwnedDetector[PerformerDetector], ...]" = ()
    touches: "tuple[OwnedDetector[TouchDetector], ...]" = ()
    findings: tuple[Finding, ...] = ()


def plan_detection(
    plans: Iterable[RobotPlan],
    models: Iterable[ModelPlan],
    world_file: "WorldFile | None",
    bridged: Mapping[str, str],
) -> Detection:
    """Return what notices performers and touches.

    Args:
        plans: The robots.
        models: The models of the world that have sensors.
        world_file: The content of the world file.
        bridged: Topic in gz → topic in ROS; others have the same name in both.
    """
    from drake_twin.planning.touches import plan_touches

    plans = tuple(plans)
    plugins = () if world_file is None else world_file.plugins
    performers: list[Performer] = [
        item for plugin in plugins if plugin.type == PERFORMERS for item in plugin.parameters
    ]
    performers += [replace(item, name=plan.name, model=plan.name) for plan in plans for item in plan.performers]
    regions = [(plan.name, item) for plan in plans for item in plan.detectors]
    regions += [(plugin.model, plugin.parameters) for plugin in plugins if plugin.type == PERFORMER_DETECTOR]
    touches, about_touches = plan_touches(plans, models, world_file, bridged)
    names = {plan.name for plan in plans}
    names |= set() if world_file is None else {model.name for model in world_file.models}
    detectors = tuple(owned_detectors(regions, with_bridges_of(plans, bridged)))
    return Detection(
        performers=tuple(item for item in performers if item.model in names),
        detectors=detectors,
        touches=touches,
        findings=(*_about(performers, names, len(detectors)), *about_touches),
    )


def _about(performers: "Iterable[Performer]", models: set[str], number: int) -> Iterator[Finding]:
    if not number:
        return
    for item in performers:
        if item.model not in models:
            what = f"performer {item.name}: no model is called {item.model!r}, so that no detector notices it"
            yield Finding.at(Kind.NOT_STARTED, what, item.place)
