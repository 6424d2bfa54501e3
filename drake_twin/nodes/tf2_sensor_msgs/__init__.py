"""Stand-in for ``tf2_sensor_msgs``: point clouds in other frames."""

from drake_twin.nodes.tf2_sensor_msgs.tf2_sensor_msgs import do_transform_cloud, transform_points

__all__ = ["do_transform_cloud", "transform_points"]
