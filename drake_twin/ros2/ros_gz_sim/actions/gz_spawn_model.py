"""Puts a model into gz's world."""

from drake_twin.ros2.built_in_action import BuiltInAction
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.packages import BUILT_IN


@expose_action("gz_spawn_model")
class GzSpawnModel(BuiltInAction):
    """Puts a model into gz's world."""

    file = f"{BUILT_IN}/ros_gz_sim/launch/gz_spawn_model.launch.py"
