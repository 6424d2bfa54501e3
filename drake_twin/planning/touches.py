"""The topics in ROS of what tells that a model has touched another one."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from drake_twin.description.gazebo_drive import TOUCH_PLUGIN
from drake_twin.findings import Finding, Kind
from drake_twin.planning.owned_detectors import OwnedDetector, owned_detectors
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.topics import with_bridges_of
from drake_twin.planning.world_sensors import ModelPlan

if TYPE_CHECKING:
    from drake_twin.description.touches import TouchDetector
    from drake_twin.description.world_file import WorldFile


def plan_touches(
    plans: Iterable[RobotPlan],
    models: Iterable[ModelPlan],
    world_file: "WorldFile | None",
    bridged: Mapping[str, str],
) -> "tuple[tuple[OwnedDetector[TouchDetector], ...], tuple[Finding, ...]]":
    """Return what tells of touches, and why others do not.

    Args:
        plans: The robots.
        models: The models of the world that have sensors.
        world_file: The content of the world file.
        bridged: Topic in gz → topic in ROS; others have the same name in both.
    """
    plans = tuple(plans)
    plugins = () if world_file is None else world_file.plugins
    found = [(plan.name, item) for plan in plans for item in plan.touches]
    found += [(plugin.model, plugin.parameters) for plugin in plugins if plugin.type == TOUCH_PLUGIN]
    if not found:
        return (), ()
    from drake_twin.sensors.contact import ContactSensor

    sensing: list[RobotPlan | ModelPlan] = [*plans, *models]
    feeling = {plan.name for plan in sensing if any(item.kind is ContactSensor for item in plan.sensors)}
    owned = owned_detectors(found, with_bridges_of(plans, bridged), "/touched")
    names = {plan.name for plan in plans}
    return tuple(item for item in owned if item.model in feeling), tuple(_about(found, feeling, names))


def _about(found: "Iterable[tuple[str, TouchDetector]]", feeling: set[str], robots: set[str]) -> Iterator[Finding]:
    for model, detector in found:
        if model not in feeling:
            what = f"Gazebo plugin {detector.name}: {model} has no contact sensor to touch with"
            finding = Finding.at(Kind.NOT_STARTED, what, detector.place)
            yield replace(finding, robot=model) if model in robots else finding
