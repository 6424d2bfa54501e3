"""Stand-in for ``sensor_msgs_py.point_cloud2``: point clouds as NumPy arrays and the other way."""

import sys
from array import array
from collections import namedtuple
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured, unstructured_to_structured

from drake_twin.nodes.message_classes import message_class

__all__ = [
    "DUMMY_FIELD_PREFIX",
    "PointCloud2",
    "PointField",
    "create_cloud",
    "create_cloud_xyz32",
    "dtype_from_fields",
    "read_points",
    "read_points_list",
    "read_points_numpy",
]

PointCloud2: Any = message_class("sensor_msgs/msg/PointCloud2")
PointField: Any = message_class("sensor_msgs/msg/PointField")
DUMMY_FIELD_PREFIX = "unnamed_field"

_IS_BIG_ENDIAN = sys.byteorder == "big"
_KINDS = ("INT8", "UINT8", "INT16", "UINT16", "INT32", "UINT32", "FLOAT32", "FLOAT64")
_TYPES = {getattr(PointField, kind): np.dtype(kind.lower()) for kind in _KINDS}


def dtype_from_fields(fields: Iterable[Any], point_step: int | None = None) -> np.dtype:
    """Return the NumPy type of a point.

    Args:
        fields: A cloud's fields; one with a count has a column ``NAME_0``, ``NAME_1``, … for each of its numbers.
        point_step: The size of a point (bytes); by default that of the fields.
    """
    columns: dict[str, tuple[np.dtype, int]] = {}
    for index, field in enumerate(fields):
        assert field.count > 0, f"the field {field.name!r} has the count 0"
        kind, name = _TYPES[field.datatype], field.name or f"{DUMMY_FIELD_PREFIX}_{index}"
        for part in range(field.count):
            own = name if field.count == 1 else f"{name}_{part}"
            assert own not in columns, f"two fields are called {own!r}"
            columns[own] = kind, field.offset + part * kind.itemsize
    kinds, offsets = zip(*columns.values(), strict=True) if columns else ((), ())
    size = {} if point_step is None else {"itemsize": point_step}
    return np.dtype({"names": [*columns], "formats": [*kinds], "offsets": [*offsets], **size})  # type: ignore[call-overload, no-any-return]


def read_points(
    cloud: Any,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> np.ndarray:
    """Return a cloud's points, a structured array of shape (n,).

    Args:
        cloud: A ``PointCloud2``.
        field_names: The fields that are wanted; all by default.
        skip_nans: Whether points with a NaN are left out, of a cloud that is not dense.
        uvs: The indices of the points that are wanted; all by default.
        reshape_organized_cloud: Whether a cloud of several rows has the shape (width, height), as ROS has it.
    """
    assert isinstance(cloud, PointCloud2), f"{type(cloud).__name__} is not a PointCloud2"
    kind = dtype_from_fields(cloud.fields, cloud.point_step)
    points: Any = np.ndarray(cloud.width * cloud.height, kind, cloud.data)
    if field_names is not None:
        missing = sorted({*field_names} - {*points.dtype.names})
        assert not missing, f"the cloud has no field {', '.join(missing)}"
        points = points[list(field_names)]
    if bool(cloud.is_bigendian) != _IS_BIG_ENDIAN:
        points = points.byteswap()
    if skip_nans and not cloud.is_dense:
        points = points[~np.any([np.isnan(points[name]) for name in points.dtype.names], axis=0)]
    if uvs is not None:
        points = points[uvs if isinstance(uvs, np.ndarray) else np.fromiter(uvs, int)]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.width, cloud.height)
    return points  # type: ignore[no-any-return]


def read_points_numpy(
    cloud: Any,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> np.ndarray:
    """Return the fields of a cloud's points, all of one type, as an array of shape (n, fields); see `read_points`."""
    kinds = {field.datatype for field in cloud.fields if field_names is None or field.name in field_names}
    assert len(kinds) < 2, "the fields have several types, which read_points can read"
    return structured_to_unstructured(read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud))


def read_points_list(
    cloud: Any,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
) -> list[Any]:
    """Return a cloud's points as named tuples; see `read_points`."""
    points = read_points(cloud, field_names, skip_nans, uvs)
    names = [field.name for field in cloud.fields] if field_names is None else [*field_names]
    point: Any = namedtuple("Point", names)  # type: ignore[misc]
    return [*map(point._make, points.tolist())]


def create_cloud(header: Any, fields: Sequence[Any], points: Any, point_step: int | None = None) -> Any:
    """Return a ``PointCloud2``.

    Args:
        header: Its header.
        fields: Its fields.
        points: Its points: an iterable of tuples; a structured array, shape (n,) or (width, height), of the type of the
            fields; or, where these have one type, an array of numbers with a last axis for them.
        point_step: The size of a point (bytes); by default that of the fields.
    """
    kind = dtype_from_fields(fields, point_step)
    if not isinstance(points, np.ndarray):
        points = np.array([*map(tuple, points)], dtype=kind)
    elif points.dtype.names is None:
        assert len({field.datatype for field in fields}) < 2, "the fields have several types: pass a structured array"
        points = unstructured_to_structured(points, dtype=kind)
    assert points.dtype == kind, f"the points are {points.dtype}, but the fields are {kind}"
    assert points.ndim <= 2, f"points of a cloud have one or two dimensions, not {points.ndim}"
    width, height = (*points.shape, 1)[:2]
    packed = np.zeros(points.shape, dtype=kind)  # gaps between fields are zero
    for name in kind.names or ():
        packed[name] = points[name]
    cloud = PointCloud2(
        header=header,
        height=height,
        width=width,
        fields=[*fields],
        is_bigendian=_IS_BIG_ENDIAN,
        point_step=kind.itemsize,
        row_step=kind.itemsize * width,
        is_dense=False,
    )
    cloud.data = array("B", packed.tobytes())
    return cloud


def create_cloud_xyz32(header: Any, points: Any) -> Any:
    """Return a ``PointCloud2`` of x, y and z as float32; see `create_cloud`."""
    fields = [
        PointField(name=name, offset=4 * index, datatype=PointField.FLOAT32, count=1)
        for index, name in enumerate("xyz")
    ]
    return create_cloud(header, fields, points)
