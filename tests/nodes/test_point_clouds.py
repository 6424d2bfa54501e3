"""Point clouds of nodes (``sensor_msgs_py``, ``tf2_sensor_msgs``, ``laser_geometry``) by bytes and closed forms."""

import struct
from math import cos, inf, nan, sin

import numpy as np
import pytest

from drake_twin.nodes.laser_geometry import LaserProjection
from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.sensor_msgs_py.point_cloud2 import (
    PointCloud2,
    PointField,
    create_cloud,
    create_cloud_xyz32,
    dtype_from_fields,
    read_points,
    read_points_list,
    read_points_numpy,
)
from drake_twin.nodes.tf2_ros.buffer_interface import TransformRegistration
from drake_twin.nodes.tf2_sensor_msgs import do_transform_cloud

HEADER = message_class("std_msgs/msg/Header")(frame_id="lidar")
FIELDS = [
    PointField(name="x", offset=0, datatype=PointField.FLOAT32, count=1),
    PointField(name="y", offset=4, datatype=PointField.FLOAT32, count=1),
    PointField(name="z", offset=8, datatype=PointField.FLOAT32, count=1),
    PointField(name="ring", offset=14, datatype=PointField.UINT16, count=2),
]
POINTS = [(1.0, 2.0, 3.0, 4, 5), (-1.0, 0.5, nan, 6, 65535)]


def packed(order="<"):
    """The points with two bytes of padding before the rings and six behind them."""
    return b"".join(struct.pack(f"{order}fff2xHH6x", *point) for point in POINTS)


def cloud_of(data, height=1, is_bigendian=False):
    return PointCloud2(
        header=HEADER,
        height=height,
        width=len(data) // 24 // height,
        fields=FIELDS,
        is_bigendian=is_bigendian,
        point_step=24,
        row_step=len(data) // height,
        data=data,
    )


@pytest.mark.parametrize("order", "<>")
def test_points_are_read_from_their_bytes(order):
    points = read_points(cloud_of(packed(order), is_bigendian=order == ">"))
    assert points.dtype.names == ("x", "y", "z", "ring_0", "ring_1")
    np.testing.assert_equal(points.tolist(), POINTS)


def test_points_are_written_as_bytes():
    cloud = create_cloud(HEADER, FIELDS, POINTS, 24)
    assert bytes(cloud.data) == packed()
    assert (cloud.height, cloud.width, cloud.point_step, cloud.row_step) == (1, 2, 24, 48)
    assert (cloud.is_bigendian, cloud.is_dense, cloud.header.frame_id) == (False, False, "lidar")


def test_fields_and_points_that_are_asked_for():
    cloud = cloud_of(packed())
    assert read_points(cloud, ["ring_1", "x"]).tolist() == [(5, 1.0), (65535, -1.0)]
    assert read_points(cloud, ["x", "z"], skip_nans=True).tolist() == [(1.0, 3.0)]
    assert read_points(cloud, ["y"], uvs=iter([1])).tolist() == [(0.5,)]
    assert read_points_numpy(cloud, ["y", "x"]).tolist() == [[2.0, 1.0], [0.5, -1.0]]
    first, _ = read_points_list(cloud, ["x", "ring_0"])
    assert (first.x, first.ring_0) == (1.0, 4)
    cloud.is_dense = True  # says that it has no NaN
    assert len(read_points(cloud, skip_nans=True)) == 2


def test_clouds_of_arrays():
    grid = np.arange(18, dtype=np.float32).reshape(3, 2, 3)
    cloud = create_cloud_xyz32(HEADER, grid)
    assert (cloud.width, cloud.height, bytes(cloud.data)) == (3, 2, grid.tobytes())
    np.testing.assert_array_equal(read_points_numpy(cloud, reshape_organized_cloud=True), grid)
    points = np.array(POINTS, dtype=dtype_from_fields(FIELDS))
    assert read_points(create_cloud(HEADER, FIELDS, points)).dtype == points.dtype


def test_what_is_refused():
    cloud = cloud_of(packed())
    with pytest.raises(AssertionError, match="the cloud has no field intensity"):
        read_points(cloud, ["x", "intensity"])
    with pytest.raises(AssertionError, match="several types"):
        read_points_numpy(cloud, ["x", "ring"])
    with pytest.raises(AssertionError, match="several types"):
        create_cloud(HEADER, FIELDS, np.zeros((2, 5)))
    with pytest.raises(AssertionError, match="not a PointCloud2"):
        read_points(HEADER)
    with pytest.raises(AssertionError, match="two fields are called 'x'"):
        dtype_from_fields([FIELDS[0], FIELDS[0]])


def test_a_cloud_in_another_frame():
    """A quarter turn about z takes (x, y, z) to (-y, x, z); the frame is moved by (10, 20, 30). The rings stay."""
    transform = message_class("geometry_msgs/msg/TransformStamped")()
    transform.header.frame_id = "map"
    turn, shift = transform.transform.rotation, transform.transform.translation
    turn.z = turn.w = 0.5**0.5
    shift.x, shift.y, shift.z = 10.0, 20.0, 30.0
    cloud = cloud_of(packed())
    moved = do_transform_cloud(cloud, transform)
    wanted = [(8.0, 21.0, 33.0, 4, 5), (nan, nan, nan, 6, 65535)]
    np.testing.assert_allclose([*map(list, read_points(moved))], wanted, rtol=1e-6)
    assert (moved.header.frame_id, cloud.header.frame_id, bytes(cloud.data)) == ("map", "lidar", packed())
    assert do_transform_cloud(cloud, transform.transform).header.frame_id == "lidar"
    assert TransformRegistration().get(PointCloud2) is do_transform_cloud


def scan(**more):
    values = {"angle_min": -0.5, "angle_increment": 0.25, "range_min": 0.5, "range_max": 10.0, "time_increment": 0.125}
    ranges = [0.25, 0.5, 2.0, inf, 10.0]  # too near, the nearest, any, nothing, too far
    return message_class("sensor_msgs/msg/LaserScan")(header=HEADER, ranges=ranges, **values, **more)


def test_points_of_a_scan():
    cloud = LaserProjection().projectLaser(scan(intensities=[1.0, 2.0, 3.0, 4.0, 5.0]))
    points = read_points(cloud)
    assert points.dtype.names == ("x", "y", "z", "intensity", "index")
    wanted = [(0.5 * cos(-0.25), 0.5 * sin(-0.25), 0.0, 2.0, 1), (2.0, 0.0, 0.0, 3.0, 2)]
    np.testing.assert_allclose([*map(list, points)], wanted, atol=1e-7)
    assert cloud.header.frame_id == "lidar"


def test_what_points_of_a_scan_have():
    option = LaserProjection.ChannelOption
    everything = option.INTENSITY | option.INDEX | option.DISTANCE | option.TIMESTAMP | option.VIEWPOINT
    points = read_points(LaserProjection().projectLaser(scan(), channel_options=everything))
    assert points.dtype.names == ("x", "y", "z", "index", "distances", "stamps", "vp_x", "vp_y", "vp_z")
    assert points[["index", "distances", "stamps", "vp_z"]].tolist() == [(1, 0.5, 0.125, 0.0), (2, 2.0, 0.25, 0.0)]
    near = LaserProjection().projectLaser(scan(), range_cutoff=2.0, channel_options=option.NONE)
    assert read_points_list(near, ["z"]) == [(0.0,)]
