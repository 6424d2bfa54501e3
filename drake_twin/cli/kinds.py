"""The option ``--show-kinds``: the kinds that there are, the twin's own and those of other packages."""

from collections.abc import Iterator
from typing import Any

from drake_twin.extensions import Registry


def kinds_text() -> str:
    """Return what there is of each kind: names, what each is, and the modules of other packages."""
    from drake_twin.ros2.evaluation import active
    from drake_twin.ros2.launch.launch_context import LaunchContext
    from drake_twin.ros2.launch_extensions import extension_problems
    from drake_twin.ros2.ros_modules import ros_in_place

    lines: list[str] = []
    with ros_in_place("", {}), active(LaunchContext()):  # where launch extensions can be imported
        for registry in _registries():
            lines += [f"{registry.noun} ({registry.group}):", *(f"  {line}" for line in registry.described())]
        lines += extension_problems().split("; ")[1:]
    return "\n".join(lines)


def _registries() -> Iterator[Registry[Any]]:
    from drake_twin.cockpit.overlay import OVERLAY_KINDS
    from drake_twin.cockpit.panel import PANEL_KINDS
    from drake_twin.controllers.registry import CONTROLLERS
    from drake_twin.description.gazebo_drive import GAZEBO_PLUGINS
    from drake_twin.description.repairs import REPAIRS
    from drake_twin.description.world_plugins import WORLD_PLUGINS
    from drake_twin.ros2.launch.frontend.expose import ACTIONS, SUBSTITUTIONS
    from drake_twin.sensors.registry import SENSORS
    from drake_twin.services.registry import OF_ROBOT, OF_TWIN
    from drake_twin.wires.registry import WIRES

    yield from (CONTROLLERS, SENSORS, GAZEBO_PLUGINS, WORLD_PLUGINS, REPAIRS, ACTIONS, SUBSTITUTIONS)
    yield from (OF_TWIN, OF_ROBOT, WIRES, PANEL_KINDS, OVERLAY_KINDS)
