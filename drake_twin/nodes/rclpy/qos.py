"""Stand-in for ``rclpy.qos``."""

from drake_twin.nodes.rclpy.qos_compatibility import QoSCompatibility as QoSCompatibility
from drake_twin.nodes.rclpy.qos_compatibility import qos_check_compatible as qos_check_compatible
from drake_twin.nodes.rclpy.qos_profiles import *  # noqa: F403
