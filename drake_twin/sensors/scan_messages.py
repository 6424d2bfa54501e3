"""The messages of lidars, as functions of ranges."""

from typing import Any

import numpy as np

from drake_twin import messages
from drake_twin.dataclass import dataclass

# Of a number by NumPy's kind and size, as sensor_msgs/msg/PointField counts them.
_DATATYPES = {"u2": 4, "u4": 7, "f4": 7}  # colors are four bytes that stand for a float


@dataclass(frozen=True)
class ScanGrid:
    """The directions of a lidar's rays: rows from the lowest, each row from its first angle to its last, which count.

    Attributes:
        samples: The number of rays in a row.
        angle_min: The first one's angle about z (rad).
        angle_max: The last one's.
        rows: The number of rows.
        row_min: The lowest row's angle above the xy plane (rad).
        row_max: The highest one's.
        range_min: The least range (m).
        range_max: The largest range (m).
    """

    samples: int
    angle_min: float
    angle_max: float
    rows: int
    row_min: float
    row_max: float
    range_min: float
    range_max: float

    @property
    def angle_increment(self) -> float:
        """The angle between two rays of a row (rad)."""
        return (self.angle_max - self.angle_min) / max(1, self.samples - 1)

    def directions(self) -> np.ndarray:
        """Return unit vectors in the sensor's frame, one a row, in the order of the ranges."""
        angles = np.linspace(self.angle_min, self.angle_max, self.samples)
        heights = np.linspace(self.row_min, self.row_max, self.rows) if self.rows > 1 else np.array([self.row_min])
        height, angle = (grid.ravel() for grid in np.meshgrid(heights, angles, indexing="ij"))
        across = np.cos(height)
        return np.column_stack([across * np.cos(angle), across * np.sin(angle), np.sin(height)])


def laser_scan(header: Any, grid: ScanGrid, ranges: np.ndarray) -> Any:
    """Return the middle row as a ``LaserScan`` (ros_gz_bridge/src/convert/sensor_msgs.cpp)."""
    row = ranges.reshape(grid.rows, grid.samples)[grid.rows // 2].astype(np.float32)
    return messages.LaserScan(
        header=header,
        angle_min=grid.angle_min,
        angle_max=grid.angle_max,
        angle_increment=grid.angle_increment,
        time_increment=0.0,
        scan_time=0.0,
        range_min=grid.range_min,
        range_max=grid.range_max,
        ranges=row,
        intensities=np.zeros(grid.samples, dtype=np.float32),
    )


def point_cloud2(header: Any, grid: ScanGrid, directions: np.ndarray, ranges: np.ndarray) -> Any:
    """Return all rows as a ``PointCloud2``: x, y, z, intensity, ring (gz-sensors, src/GpuLidarSensor.cc).

    The fields are aligned to 8 bytes, as gz-msgs does it (PointCloudPackedUtils.hh).
    """
    names, kinds = ("x", "y", "z", "intensity", "ring"), (*["<f4"] * 4, "<u2")
    layout = np.dtype({"names": names, "formats": kinds, "offsets": (0, 4, 8, 16, 24), "itemsize": 32})
    data = np.zeros((grid.rows, grid.samples), dtype=layout)
    with np.errstate(invalid="ignore"):  # infinite where rays met nothing
        points = (ranges[:, np.newaxis] * directions).astype(np.float32)
    for name, values in zip("xyz", points.T, strict=True):
        data[name] = values.reshape(data.shape)
    data["ring"] = np.arange(grid.rows)[:, np.newaxis]
    return cloud_message(header, data, is_dense=bool(np.isfinite(ranges).all()))


def cloud_message(header: Any, data: np.ndarray, *, is_dense: bool) -> Any:
    """Return a ``PointCloud2`` of an array of structures (height × width)."""
    fields = [
        messages.PointField(name=name, offset=offset, datatype=_DATATYPES[kind.str[1:]], count=1)
        for name, (kind, offset, *_) in (data.dtype.fields or {}).items()
    ]
    return messages.PointCloud2(
        header=header,
        height=data.shape[0],
        width=data.shape[1],
        fields=fields,
        is_bigendian=False,
        point_step=data.itemsize,
        row_step=data.itemsize * data.shape[1],
        data=data.ravel().view(np.uint8),
        is_dense=is_dense,
    )


def classic_point_cloud2(header: Any, directions: np.ndarray, ranges: np.ndarray) -> Any:
    """Return what was met as a dense ``PointCloud2`` (gazebo_ros/conversions/sensor_msgs.hpp): x, y, z, intensity."""
    met = np.isfinite(ranges)
    data = np.zeros((1, np.count_nonzero(met)), dtype=[(name, "<f4") for name in ("x", "y", "z", "intensity")])
    for name, values in zip("xyz", (ranges[met, np.newaxis] * directions[met]).T, strict=True):
        data[name] = values
    return cloud_message(header, data, is_dense=True)


def point_cloud(header: Any, directions: np.ndarray, ranges: np.ndarray) -> Any:
    """Return what was met as a ``PointCloud`` with its intensities (gazebo_ros/conversions/sensor_msgs.hpp)."""
    met = np.isfinite(ranges)
    xyz = (ranges[met, np.newaxis] * directions[met]).astype(np.float32).tolist()
    intensity = messages.ChannelFloat32(name="intensity", values=np.zeros(len(xyz), dtype=np.float32))
    points_met = [messages.Point32(x=x, y=y, z=z) for x, y, z in xyz]
    return messages.PointCloud(header=header, points=points_met, channels=[intensity])


def nearest_range(header: Any, grid: ScanGrid, ranges: np.ndarray, radiation: int) -> Any:
    """Return the least range as a ``Range``; the largest float without a hit.

    As in gazebo_ros/conversions/sensor_msgs.hpp.
    """
    return messages.Range(
        header=header,
        radiation_type=radiation,
        field_of_view=max(abs(grid.angle_max - grid.angle_min), grid.row_max - grid.row_min),
        min_range=grid.range_min,
        max_range=grid.range_max,
        range=float(min(ranges.min(), np.finfo(np.float32).max)),
        variance=0.0,
    )
