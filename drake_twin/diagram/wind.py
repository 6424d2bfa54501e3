"""The wind of a world: steady, or one that a plugin of the world lets change."""

import re
from typing import TYPE_CHECKING

from pydrake.systems.framework import Context, Diagram, DiagramBuilder

from drake_twin.diagram.topics import PublishedTopic, Topics
from drake_twin.diagram.world_in_plant import wind_of
from drake_twin.scenario import CENIC, Scenario

if TYPE_CHECKING:
    from drake_twin.control.wind import Swing
    from drake_twin.description.plugins.wind import SwingParameters
    from drake_twin.description.world_file import WorldFile
    from drake_twin.systems.wind import Wind

_NAME = "wind"


def add_wind(
    builder: DiagramBuilder, scenario: Scenario, world_file: "WorldFile | None", topics: Topics
) -> "tuple[float, float, float] | Wind":
    """Return the velocity of the air in the world (m/s), or the system of one that changes, which is added.

    Args:
        builder: The root diagram's builder.
        scenario: The scenario.
        world_file: The content of its world file.
        topics: Collects the topics.
    """
    wanted = wind_of(scenario.world, world_file)
    if world_file is None or (parameters := world_file.wind_effects) is None:
        return wanted
    from drake_twin.control.wind import ChangingWind
    from drake_twin.systems.wind import Wind

    parts = {"speed": parameters.speed, "direction": parameters.direction, "vertical": parameters.vertical}
    wind = ChangingWind(**{name: _swing(scenario, name, part) for name, part in parts.items()})
    step = 0.0 if scenario.engine == CENIC else scenario.time_step
    system: Wind = builder.AddNamedSystem(f"world/{_NAME}", Wind(wind, wanted, step))
    topic, port = f"{wind_topic(world_file.name)}_info", system.get_wind_info_output_port()
    topics.publish(PublishedTopic(topic, "geometry_msgs/msg/Vector3", port, 1.0 / scenario.time_step))
    return system


def wind_topic(world: str) -> str:
    """Return the topic of a world's wind, with characters that ROS does not take replaced by ``_``."""
    name = re.sub(r"[^a-zA-Z0-9_]+", "_", world) or "_"
    return f"/world/{'_' if name[0].isdigit() else ''}{name}/wind"


def changing_wind(diagram: Diagram) -> "Wind | None":
    """Return the system of a wind that changes; None for a steady one."""
    name = f"world/{_NAME}"
    if not diagram.HasSubsystemNamed(name):
        return None
    from drake_twin.systems.wind import Wind

    system = diagram.GetSubsystemByName(name)
    assert isinstance(system, Wind)
    return system


def present_wind(diagram: Diagram, root: Context, steady: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the velocity of the air at the present time (m/s).

    Args:
        diagram: The root diagram.
        root: Its context.
        steady: That of a wind that does not change.
    """
    system = changing_wind(diagram)
    return steady if system is None else system.present(system.GetMyContextFromRoot(root))


def _swing(scenario: Scenario, name: str, parameters: "SwingParameters") -> "Swing":
    from drake_twin.control.wind import Swing
    from drake_twin.sensors.noise import Noise, NoiseSource

    noise = None
    if parameters.noise:
        source = NoiseSource(scenario.seed, "", _NAME, 0.0, scenario.time_step)
        noise = source.channel(name, Noise(**parameters.noise)).apply
    return Swing(parameters.rise, parameters.amplitude, parameters.period, noise)
