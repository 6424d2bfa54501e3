"""Starts gz's server."""

from drake_twin.ros2.built_in_action import BuiltInAction
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.packages import BUILT_IN


@expose_action("gz_server")
class GzServer(BuiltInAction):
    """Starts gz's server."""

    file = f"{BUILT_IN}/ros_gz_sim/launch/gz_server.launch.py"
