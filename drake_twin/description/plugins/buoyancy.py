"""The system of gz-sim that lets things float, as forces of the world."""

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import PluginReader
from drake_twin.description.world_plugins import WorldPlugin, world_plugin

BUOYANCY = "gz_sim/Buoyancy"
_WATER = 1000.0
_GRADED = "graded_buoyancy"
_CHANGE = f"{_GRADED}/density_change"


@dataclass(frozen=True)
class BuoyancyParameters:
    """What ``gz-sim-buoyancy-system`` says of the fluid.

    Attributes:
        density: The density below all changes (kg/m³).
        changes: The heights in the world above which there is another density, from below, and that density
            (m, kg/m³).
        enable: The models and links that float, ``MODEL`` and ``MODEL::LINK``; all if it is empty.
    """

    density: float = _WATER
    changes: tuple[tuple[float, float], ...] = ()
    enable: tuple[str, ...] = ()


@world_plugin("gz-sim-buoyancy-system")
def buoyancy_system(plugin: PluginReader) -> WorldPlugin:
    """Convert ``gz-sim-buoyancy-system``: one density, or one for each layer."""
    enable = plugin.texts("enable")
    if plugin.has("uniform_fluid_density"):
        return WorldPlugin(BUOYANCY, BuoyancyParameters(_density(plugin, "uniform_fluid_density"), (), enable))
    density = _density(plugin, f"{_GRADED}/default_density")
    heights, densities = plugin.numbers(f"{_CHANGE}/above_depth"), plugin.numbers(f"{_CHANGE}/density")
    if len(heights) != len(densities):
        raise plugin.error("each <density_change> needs one <above_depth> and one <density>")
    if densities and min(densities) < 0.0:
        raise plugin.error(f"<{_CHANGE}/density> is {min(densities):g}, and has to be zero or more")
    changes = dict(zip(heights, densities, strict=True))  # of two at one height the last one counts
    return WorldPlugin(BUOYANCY, BuoyancyParameters(density, tuple(sorted(changes.items())), enable))


def _density(plugin: PluginReader, tag: str) -> float:
    density = plugin.number(tag, _WATER)
    if density < 0.0:
        raise plugin.error(f"<{tag}> is {density:g}, and has to be zero or more")
    return density
