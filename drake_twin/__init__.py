"""Digital twins of ROS 2 robots in one Drake simulation, with no ROS installed.

The main parts, imported when they are first used::

    from drake_twin import TwinBuilder, Scenario, Twin
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drake_twin.launch.builder import TwinBuilder
    from drake_twin.scenario import Scenario
    from drake_twin.twin import Twin

__all__ = ["Scenario", "Twin", "TwinBuilder"]

_HOMES = {"Scenario": "drake_twin.scenario", "Twin": "drake_twin.twin", "TwinBuilder": "drake_twin.launch.builder"}


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'drake_twin' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
