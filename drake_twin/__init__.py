"""Digital twins of ROS 2 robots in one Drake simulation, with no ROS installed.

The public names, imported when they are first used::

    from drake_twin import TwinBuilder, Scenario, Twin
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drake_twin.builder.twin_builder import TwinBuilder
    from drake_twin.errors import CommandError, InputError, RunError, TwinError
    from drake_twin.findings import Finding, Kind
    from drake_twin.scenario import Command, Robot, Scenario, StaticTransform, World
    from drake_twin.show import TwinPage, show
    from drake_twin.twin.action import ActionGoal
    from drake_twin.twin.entities import EntityState
    from drake_twin.twin.recording import Recording, replay
    from drake_twin.twin.rewind import Rewind
    from drake_twin.twin.snapshot import Snapshot
    from drake_twin.twin.state import RobotState
    from drake_twin.twin.twin import Twin

__version__ = "0.2.0"  # the one place: pyproject.toml reads it here, .github/RELEASING.md says when it changes

_HOMES = {
    "builder.twin_builder": ("TwinBuilder",),
    "errors": ("CommandError", "InputError", "RunError", "TwinError"),
    "findings": ("Finding", "Kind"),
    "scenario": ("Command", "Robot", "Scenario", "StaticTransform", "World"),
    "show": ("TwinPage", "show"),
    "twin.action": ("ActionGoal",),
    "twin.entities": ("EntityState",),
    "twin.recording": ("Recording", "replay"),
    "twin.rewind": ("Rewind",),
    "twin.snapshot": ("Snapshot",),
    "twin.state": ("RobotState",),
    "twin.twin": ("Twin",),
}

__all__ = [
    "ActionGoal",
    "Command",
    "CommandError",
    "EntityState",
    "Finding",
    "InputError",
    "Kind",
    "Recording",
    "Rewind",
    "Robot",
    "RobotState",
    "RunError",
    "Scenario",
    "Snapshot",
    "StaticTransform",
    "Twin",
    "TwinBuilder",
    "TwinError",
    "TwinPage",
    "World",
    "__version__",
    "replay",
    "show",
]

if not TYPE_CHECKING:  # else every name that is not there would have the type Any

    def __getattr__(name: str) -> Any:
        from importlib import import_module

        for module, names in _HOMES.items():
            if name in names:
                return getattr(import_module(f"drake_twin.{module}"), name)
        raise AttributeError(f"module 'drake_twin' has no attribute {name!r}")
