"""Lidars, sonars and other sensors that cast rays from a point of a link."""

from collections.abc import Iterable
from importlib.util import find_spec
from math import pi
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import Role
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import plugin_kind
from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.requirements import missing
from drake_twin.sensors.classic import classic_frame, classic_plugin, classic_topic
from drake_twin.sensors.noise import Noise, read_noise
from drake_twin.sensors.ray_caster import RayCaster
from drake_twin.sensors.registry import sensor
from drake_twin.sensors.scan_messages import (
    ScanGrid,
    classic_point_cloud2,
    laser_scan,
    nearest_range,
    point_cloud,
    point_cloud2,
)
from drake_twin.sensors.sensor_setup import SensorSetup
from drake_twin.sensors.sensor_system import SensorSystem, SensorTopic

_MOST_RAYS = 2_000_000
# Of ROS 1, which still stand in files, with their default topics.
_ROS_1 = {
    **dict.fromkeys(("gazebo_ros_laser", "gazebo_ros_gpu_laser", "gazebo_ros_block_laser"), "/world"),
    "gazebo_ros_range": "/range",
}
_PLUGINS = ("gazebo_ros_ray_sensor", *_ROS_1)
# What Gazebo classic's plugins publish; the first is the default of gazebo_ros_ray_sensor.
_OUTPUTS = ("sensor_msgs/PointCloud2", "sensor_msgs/LaserScan", "sensor_msgs/PointCloud", "sensor_msgs/Range")
_OF_PLUGIN = {"gazebo_ros_block_laser": "sensor_msgs/PointCloud", "gazebo_ros_range": "sensor_msgs/Range"}
_SOUND = "ultrasound"
_RADIATIONS = ("infrared", _SOUND)  # 1 and 0 of sensor_msgs/msg/Range


@dataclass(frozen=True)
class LidarSettings:
    """What a lidar reads of its element.

    Attributes:
        grid: Its rays and ranges.
        noises: The noise of its ``range`` (m).
        sees_collision_shapes: Whether it sees collision shapes; visual shapes otherwise.
        output: What the plugin of Gazebo classic publishes; empty for a lidar of Gazebo, which has a scan and points.
        radiation: The ``radiation_type`` of a ``Range``.
    """

    grid: ScanGrid
    noises: dict[str, Noise]
    sees_collision_shapes: bool
    output: str
    radiation: int


@sensor("gpu_lidar", "gpu_ray", "lidar", "ray")
class Lidar(SensorSystem):
    """Measure how far away rays meet a shape (gz-sensors, src/Lidar.cc and src/GpuLidarSensor.cc).

    Rays begin at the least range: what is nearer is not seen. Ranges beyond the largest are infinite. A ``ray`` or a
    ``lidar`` sees collision shapes, as with Gazebo's physics engine; ``gpu_lidar`` and ``gpu_ray`` see visual shapes,
    as a graphics processor does.

    .. pydrake_system::

        name: Lidar
        input_ports:
        - body_poses
        output_ports:
        - scan
        - points

    - ``body_poses``: the plant's port of this name.
    - ``scan``: ``sensor_msgs/msg/LaserScan`` of the present time; with a plugin of Gazebo classic what its
      ``<output_type>`` says.
    - ``points``: ``sensor_msgs/msg/PointCloud2``; without such a plugin only.
    """

    gz_topic = "scan"

    @classmethod
    def read(cls, element: SensorElement) -> LidarSettings:
        """Read rays, ranges and noise.

        Raises:
            InputError: If a value is invalid.
        """
        part = element.part("lidar") or element.part("ray") or element
        grid = _grid(part)
        kind = element.plugin_kind
        output, radiation = "", 0
        if kind in _PLUGINS:
            plugin = element.part("plugin")
            assert plugin is not None
            if kind in _ROS_1:
                output = _OF_PLUGIN.get(kind, "sensor_msgs/LaserScan")
                radiation = int(plugin.text("radiation", default=_SOUND) != _SOUND)
                for name in ("topicName", "frameName", "robotNamespace"):
                    plugin.has(name)
            else:
                output = plugin.choice("output_type", _OUTPUTS)
                radiation = 1 - _RADIATIONS.index(plugin.choice("radiation_type", _RADIATIONS))
        noises = {"range": read_noise(part)}
        return LidarSettings(grid, noises, element.sensor.kind in ("ray", "lidar"), output, radiation)

    @classmethod
    def problem(cls, settings: LidarSettings) -> str | None:
        """Return why there are no lidars: Embree has no package for every platform."""
        return None if find_spec("embreex") is not None else str(missing("lidars need", "embreex")).rstrip(".")

    @classmethod
    def topics(cls, sensor: Sensor, settings: LidarSettings, base: str) -> Iterable[SensorTopic]:
        """Return its scan and its points; one topic of Gazebo classic's plugin, ``topicName`` of ROS 1's."""
        plugin = classic_plugin(sensor, *_PLUGINS)
        if plugin is None:
            return (
                SensorTopic("scan", "sensor_msgs/msg/LaserScan", base),
                SensorTopic("points", "sensor_msgs/msg/PointCloud2", f"{base}/points"),
            )
        kind = settings.output.replace("/", "/msg/")
        otherwise = _ROS_1.get(plugin_kind(plugin), "")
        name = SensorElement(sensor).text("plugin/topicName", default=otherwise) if otherwise else "~/out"
        return (SensorTopic("scan", kind, classic_topic(plugin, name), is_ros=True),)

    @classmethod
    def default_frame(cls, sensor: Sensor, settings: LidarSettings, scoped: str) -> str:
        """Return the link with Gazebo classic's plugin, ``frameName`` with ROS 1's; else Gazebo's scoped name."""
        if classic_plugin(sensor, *_ROS_1) is not None:
            return SensorElement(sensor).text("plugin/frameName", default="world").lstrip("/")
        return classic_frame(sensor, scoped)

    def __init__(self, setup: SensorSetup):
        super().__init__(setup)
        self._settings: LidarSettings = setup.settings
        grid = self._settings.grid
        self._directions_S = grid.directions()
        self._body, self._pose = int(setup.body.index()), setup.pose
        self._poses = self.declare_plant_input("body_poses")
        self._ranges = self.declare_cache_entry("ranges", self._calc_ranges)
        self.declare_message_output(self._calc_scan, own="scan")
        if not self._settings.output:
            self.declare_message_output(self._calc_points, own="points")

    def _caster(self) -> RayCaster:
        """Return the caster, one for all lidars that see the same shapes; the first ray makes it."""
        setup, shared = self.setup, self.host.shared
        role = Role.kProximity if self._settings.sees_collision_shapes else Role.kIllustration
        if role not in shared:
            assert setup.scene_graph is not None, "a lidar needs the scene graph"
            shared[role] = RayCaster(setup.plant, setup.scene_graph.model_inspector(), role)
        found: RayCaster = shared[role]
        return found

    def _calc_ranges(self, context: Context, output: AbstractValue) -> None:
        poses, grid = self._poses.Eval(context), self._settings.grid
        X_WS = poses[self._body] @ self._pose
        directions = self._directions_S @ X_WS.rotation().matrix().T
        ranges = self._caster().cast(poses, X_WS.translation(), directions, grid.range_min, grid.range_max)
        ranges[ranges > grid.range_max] = np.inf
        met = np.isfinite(ranges)
        noisy = self.noisy("range", ranges, context.get_time())
        output.set_value(np.where(met, np.clip(noisy, grid.range_min, grid.range_max), ranges))

    def _calc_scan(self, context: Context, output: AbstractValue) -> None:
        header, settings, ranges = self.header(context), self._settings, self._ranges.Eval(context)
        make: dict[str, Any] = {
            "": lambda: laser_scan(header, settings.grid, ranges),
            "sensor_msgs/LaserScan": lambda: laser_scan(header, settings.grid, ranges),
            "sensor_msgs/PointCloud2": lambda: classic_point_cloud2(header, self._directions_S, ranges),
            "sensor_msgs/PointCloud": lambda: point_cloud(header, self._directions_S, ranges),
            "sensor_msgs/Range": lambda: nearest_range(header, settings.grid, ranges, settings.radiation),
        }
        output.set_value(make[settings.output]())

    def _calc_points(self, context: Context, output: AbstractValue) -> None:
        ranges = self._ranges.Eval(context)
        output.set_value(point_cloud2(self.header(context), self._settings.grid, self._directions_S, ranges))


def _grid(part: SensorElement) -> ScanGrid:
    """Read rays and ranges; without ``<vertical>`` there is one row.

    Raises:
        InputError: If a value is invalid.
    """
    rows = []
    for name, samples in (("horizontal", 640), ("vertical", 1)):
        own = part.part(f"scan/{name}")
        count, resolution, least, most = float(samples), 1.0, 0.0, 0.0
        if own is not None:
            count = own.number("samples", samples, least=1)
            resolution = own.number("resolution", 1.0, least=1e-6)
            least, most = own.number("min_angle", 0.0), own.number("max_angle", 0.0)
            if most < least and name == "vertical":  # the rays of a row go backwards then, as in Gazebo classic
                raise own.error(f"max_angle {most:g} is below min_angle {least:g}", "max_angle")
            if name == "vertical" and not -pi / 2 <= least <= most <= pi / 2:
                raise own.error("the angles of rows must be from -pi/2 to pi/2", "max_angle")
        rows.append((max(1, round(min(count, 1e9) * resolution)), least, most))
    (samples, angle_min, angle_max), (number, row_min, row_max) = rows
    if samples * number > _MOST_RAYS:
        raise part.error(f"{samples * number} rays are too many: at most {_MOST_RAYS}", "scan")
    range_min = part.number("range/min", 0.0, least=0.0)
    range_max = part.number("range/max", 10.0, least=0.0)
    part.number("range/resolution", 0.0)
    if range_max <= range_min:
        raise part.error(f"the largest range {range_max:g} is not above the least one {range_min:g}", "range/max")
    return ScanGrid(samples, angle_min, angle_max, number, row_min, row_max, range_min, range_max)
