"""The actions of ``ros_gz_sim`` and ``ros_gz_bridge``: their launch files as actions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from drake_twin.ros2.entity import Action
from drake_twin.ros2.packages import BUILT_IN
from drake_twin.ros2.stand_ins import include_stand_in
from drake_twin.ros2.substitution import perform

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext


class _StandInAction(Action):
    _file = ""

    def __init__(self, *, condition: Any = None, **arguments: Any):
        super().__init__(condition=condition)
        self._arguments: Mapping[str, Any] = {name: value for name, value in arguments.items() if value is not None}

    def execute(self, context: LaunchContext) -> None:
        """Does what including the launch file with these arguments does."""
        with context.scope():
            for name, value in self._arguments.items():
                text = str(value) if isinstance(value, bool | int | float) else value
                context.launch_configurations[name] = perform(context, text)
            include_stand_in(self._file, context, self.place)


class GzServer(_StandInAction):
    """Starts gz's server."""

    _file = f"{BUILT_IN}/ros_gz_sim/launch/gz_server.launch.py"


class GzSpawnModel(_StandInAction):
    """Puts a model into gz's world."""

    _file = f"{BUILT_IN}/ros_gz_sim/launch/gz_spawn_model.launch.py"


class RosGzBridge(_StandInAction):
    """Starts a bridge between ROS's and gz's topics."""

    _file = f"{BUILT_IN}/ros_gz_bridge/launch/ros_gz_bridge.launch.py"
