"""Mesh files for the tests of meshes."""

import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Mesh

from drake_twin.errors import InputError

OFFSET = (1.0, 2.0, 3.0)
ONE = (1.0, 1.0, 1.0)


def box(extents=(1.0, 2.0, 3.0), offset=(0.0, 0.0, 0.0)) -> trimesh.Trimesh:
    mesh = trimesh.creation.box(extents)
    mesh.apply_translation(offset)
    return mesh


def write(mesh: trimesh.Trimesh, file: Path, **options) -> Path:
    with warnings.catch_warnings():  # what NumPy 2.5 says to pycollada
        warnings.filterwarnings("ignore", "Setting the shape on a NumPy array", DeprecationWarning)
        content = mesh.export(file_type=file.suffix[1:].lower(), **options)
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


def bounds_in_drake(file: Path) -> list[list[float]]:
    hull = Mesh(str(file)).GetConvexHull()
    vertices = np.array([hull.vertex(index) for index in range(hull.num_vertices())])
    return [vertices.min(axis=0).tolist(), vertices.max(axis=0).tolist()]


def near(bounds) -> list:
    return [pytest.approx(list(corner), abs=1e-6) for corner in bounds]


def refusal(call, *arguments) -> str:
    with pytest.raises(InputError) as raised:
        call(*arguments)
    return str(raised.value)


def must_not_be_called(file: Path) -> bytes:
    raise AssertionError(f"{file} was converted again")
