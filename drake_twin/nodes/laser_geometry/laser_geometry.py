"""Stand-in for ``laser_geometry.laser_geometry``."""

from typing import Any

import numpy as np

from drake_twin.nodes.sensor_msgs_py.point_cloud2 import PointField, create_cloud, dtype_from_fields


class LaserProjection:
    """Turns ``LaserScan`` messages into ``PointCloud2`` ones, in the frame of the scan."""

    LASER_SCAN_INVALID = -1.0
    LASER_SCAN_MIN_RANGE = -2.0
    LASER_SCAN_MAX_RANGE = -3.0

    class ChannelOption:
        """What a point has beside x, y and z; several are added by ``|``."""

        NONE = 0
        INTENSITY = 1
        INDEX = 2
        DISTANCE = 4
        TIMESTAMP = 8
        VIEWPOINT = 16
        DEFAULT = INTENSITY | INDEX

    def projectLaser(
        self, scan_in: Any, range_cutoff: float = -1.0, channel_options: int = ChannelOption.DEFAULT
    ) -> Any:
        """Return the points of a scan whose distances are at least its least and below its greatest range.

        Args:
            scan_in: The scan.
            range_cutoff: A distance (m) from which on points are left out, too; none below zero.
            channel_options: What the points have beside x, y and z.
        """
        ranges = np.array(scan_in.ranges, dtype=float)
        most = scan_in.range_max if range_cutoff < 0 else min(range_cutoff, scan_in.range_max)
        (seen,) = np.nonzero((ranges >= scan_in.range_min) & (ranges < most))
        angles = scan_in.angle_min + seen * scan_in.angle_increment
        columns = {"x": ranges[seen] * np.cos(angles), "y": ranges[seen] * np.sin(angles), "z": np.zeros(len(seen))}
        option = self.ChannelOption
        if channel_options & option.INTENSITY and len(scan_in.intensities):
            columns["intensity"] = np.array(scan_in.intensities)[seen]
        if channel_options & option.INDEX:
            columns["index"] = seen
        if channel_options & option.DISTANCE:
            columns["distances"] = ranges[seen]
        if channel_options & option.TIMESTAMP:
            columns["stamps"] = seen * scan_in.time_increment
        if channel_options & option.VIEWPOINT:
            columns |= {name: np.zeros(len(seen)) for name in ("vp_x", "vp_y", "vp_z")}
        fields = [
            PointField(
                name=name,
                offset=4 * place,
                datatype=PointField.INT32 if name == "index" else PointField.FLOAT32,
                count=1,
            )
            for place, name in enumerate(columns)
        ]
        points = np.zeros(len(seen), dtype=dtype_from_fields(fields))
        for name, values in columns.items():
            points[name] = values
        return create_cloud(scan_in.header, fields, points)
