"""How Gazebo classic's plugins name the topics and frames of sensors, as in gazebo_ros_pkgs for ROS 2."""

from drake_twin.description.gazebo_plugins import plugin_kind, plugin_node_name, ros_topic
from drake_twin.description.robot_description import GazeboPlugin, Sensor
from drake_twin.description.sensor_element import SensorElement

_CLASSIC = "gazebo_ros_"


def classic_plugin(sensor: Sensor, *kinds: str) -> GazeboPlugin | None:
    """Return the plugin of Gazebo classic in a sensor, or that a sensor is; None without one.

    Args:
        sensor: The sensor.
        *kinds: The kinds of plugins, such as ``gazebo_ros_imu_sensor``; any by default.
    """
    plugin = SensorElement(sensor).plugin
    kind = "" if plugin is None else plugin_kind(plugin)
    return plugin if kind in kinds or (not kinds and kind.startswith(_CLASSIC)) else None


def classic_topic(plugin: GazeboPlugin, topic: str) -> str:
    """Return the ROS name of a topic of a plugin, with its remappings; ``~`` stands for the plugin's name."""
    return ros_topic(plugin, topic.replace("~", plugin_node_name(plugin)))


def classic_frame(sensor: Sensor, otherwise: str) -> str:
    """Return the default frame of a sensor with a classic plugin, its link (``SensorFrameID``); else another one."""
    return otherwise if classic_plugin(sensor) is None else sensor.gazebo_link.rpartition("::")[2]
